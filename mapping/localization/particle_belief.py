"""One set of particles on a map: a reading and a motion in, the next set and its evidence out."""

import math
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray
from scipy.special import logsumexp

from mapping.filters.particle import ParticleConfig, ParticleFilter
from mapping.filters.resampling import effective_number
from mapping.geometry import Pose
from mapping.localization.likelihood_field import LikelihoodField
from mapping.localization.motion_model import MotionNoise, sample_motion

BINS = (0.25, 0.25, math.radians(10.0))
"""Bins of KLD sampling [m, m, rad]: half of what AMCL takes, as rooms here are small."""

PEAK = (0.03, 0.03, 0.015)
"""Width of the peak of a scan's likelihood [m, m, rad], one standard deviation: ``sigma_hit`` and
that over a typical range, over the root of the readings that count."""

LEAST_SHARE = 0.02
"""A peak is taken to be no wider than tempering by this share makes it."""

BISECTIONS = 12
"""Steps to find a share to within a four-thousandth."""


@dataclass(frozen=True, slots=True, kw_only=True)
class BeliefConfig:
    """How the particles are drawn and moved."""

    particles: ParticleConfig = field(
        default_factory=lambda: ParticleConfig(
            bins=BINS,
            least=1000,
            most=50_000,
            resample_below=0.5,
            slow_rate=0.02,
            fast_rate=0.2,
        )
    )
    motion: MotionNoise = field(default_factory=MotionNoise)
    least_effective: float = 300.0
    """A scan must leave so many particles with weight; of a sharper one only a share is used."""


class ParticleBelief:
    """Particles that share a likelihood field."""

    def __init__(
        self, poses: Pose, field: LikelihoodField, config: BeliefConfig, rng: np.random.Generator
    ) -> None:
        """Begin with poses ``(n, 3)``, equally likely.

        Until it has seen how well the map explains scans it expects the best: hits only.
        """
        self.particles = ParticleFilter(config.particles, poses, rng)
        self.particles.expect(field.best)
        self.weighed = len(poses)
        """How many particles the newest scan was weighed with."""
        self._field = field
        self._motion = config.motion
        self._rng = rng
        self._least_effective = config.least_effective

    @property
    def poses(self) -> Pose:
        """The particles ``(n, 3)``."""
        return self.particles.states

    @property
    def doubt(self) -> float:
        """How much worse scans are explained than they used to be, 0..1."""
        return self.particles.random_share

    def remember(self, other: "ParticleBelief") -> None:
        """Expect scans to be explained as well as another set's right poses explained them."""
        self.particles.expect(other.particles.usual_evidence)

    def predict(self, motion: Pose) -> None:
        """Move every particle by its own guess of a motion ``(3,)``."""
        noise = self._motion
        self.particles.predict(lambda poses, rng: sample_motion(poses, motion, noise, rng))

    def correct(self, points: NDArray[np.float64]) -> float:
        """Weigh the particles by a scan and draw the next ones; returns log p(z_t).

        The averages that tell when the robot is lost are those of the mean likelihood of one
        reading: the whole scan's varies by orders of magnitude from room to room.

        Args:
            points: What is looked at of a scan ``(m, 2)`` in base_footprint [m].
        """
        self.weighed = len(self.poses)
        logs = self._field.log_likelihoods(self.poses, points)
        per_reading = np.exp(logs * (self._field.config.togetherness / max(len(points), 1)))
        expected = float(logsumexp(logs, b=self.particles.weights))
        share = bearable_share(logs, self.particles.weights, self._least_effective)
        self.particles.correct(share * logs, float(self.particles.weights @ per_reading))
        if self.particles.resample() and share < 1.0:
            self._roughen(share)
        return expected

    def _roughen(self, share: float) -> None:
        """Scatter the particles over the part of the peaks that they have not resolved yet.

        Copies of one particle do not look for the peak beside it (Gordon et al. 1993: roughening).
        """
        particles = self.particles
        sigmas = np.array(PEAK) / math.sqrt(max(share, LEAST_SHARE))
        particles.states = particles.states + sigmas * self._rng.standard_normal(self.poses.shape)


def bearable_share(
    logs: NDArray[np.float64], weights: NDArray[np.float64], least_effective: float
) -> float:
    """How much of a measurement particles can bear: the share of its log likelihood, 0..1.

    Where particles lie farther apart than the likelihood's peaks are wide, the one that happens to
    lie nearest to a peak would get all the weight, on whichever peak that is. So much of the
    likelihood is used that enough particles keep weight (tempering, as in annealed importance
    sampling); the next scans tell the rest, when the particles have gathered.

    Args:
        logs: Log likelihood of each particle ``(n,)``.
        weights: Their weights ``(n,)``.
        least_effective: Effective number that must be left; half of the one before if that is less.
    """
    enough = min(least_effective, 0.5 * effective_number(weights))

    def left(share: float) -> float:
        return effective_number(weights * np.exp(share * (logs - logs.max())))

    if left(1.0) >= enough:
        return 1.0
    low, high = 0.0, 1.0
    for _ in range(BISECTIONS):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if left(middle) >= enough else (low, middle)
    return low
