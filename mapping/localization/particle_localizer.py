"""Localises by particles: Monte Carlo localisation that finds itself again when carried off.

Probabilistic Robotics, tables 8.2 to 8.4, with the motion model of table 5.6 and the sensor model
of table 6.3. When the particles explain the scans worse than they used to (w_fast, w_slow of table
8.3), random ones are tried. They do not mix with the others at once: a second set, spread over the
whole map, localises beside the first, and the evidence of the scans decides between the two
(Bayesian model comparison). Thus any number of random particles can be tried without losing a robot
that was not carried off.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from mapping.errors import TestbedError
from mapping.geometry import Pose, compose
from mapping.localization import localizer
from mapping.localization.hypothesis_clusters import cluster
from mapping.localization.hypothesis_tracker import HypothesisTracker
from mapping.localization.known_map import KnownMap
from mapping.localization.likelihood_field import LikelihoodField, LikelihoodFieldConfig
from mapping.localization.localizer import Hypothesis
from mapping.localization.particle_belief import BeliefConfig, ParticleBelief
from mapping.localization.pose_refiner import PoseRefiner
from mapping.localization.scan_reader import ReaderConfig, ScanReader
from mapping.messages import Imu, LaserScan, Odometry

MOST_LOG_ODDS = 50.0
"""Beyond these odds a set is as good as impossible; keeps an exponential from overflowing."""


@dataclass(frozen=True, slots=True, kw_only=True)
class ParticleLocalizerConfig:
    """Settings; the default is a Burger in a building."""

    belief: BeliefConfig = field(default_factory=BeliefConfig)
    sensor: LikelihoodFieldConfig = field(default_factory=LikelihoodFieldConfig)
    reader: ReaderConfig = field(default_factory=ReaderConfig)
    at_start: int = 200_000
    """Particles that are spread over the map when nothing is known."""
    doubt: float = 0.35
    """When 1 - w_fast / w_slow is above this, a second set is tried."""
    carried_off: float = 0.001
    """How likely it is then that the robot was carried off."""
    trial: int = 25
    """Updates for which a second set is tried: 5 s."""
    least_shift: float = 0.02
    """A robot that moved less [m] since the last update learns nothing new from a scan."""
    least_turn: float = 0.02
    """Nor one that turned less [rad]."""

    def __post_init__(self) -> None:
        """Refuse figures that make no localiser."""
        for name in ("at_start", "trial"):
            if getattr(self, name) < 1:
                raise TestbedError(f"{name}: {getattr(self, name)}; must be at least 1")
        for name in ("doubt", "carried_off"):
            if not 0.0 < getattr(self, name) < 1.0:
                raise TestbedError(f"{name}: {getattr(self, name)}; must be between 0 and 1")


class ParticleLocalizer:
    """Monte Carlo localisation on a known map; starts anywhere, or at a given pose."""

    def __init__(
        self,
        known: KnownMap,
        config: ParticleLocalizerConfig | None = None,
        *,
        start: ArrayLike | None = None,
        start_sigmas: tuple[float, float, float] = (0.1, 0.1, 0.1),
        seed: int = 0,
    ) -> None:
        """Spread the particles.

        Args:
            known: The map.
            config: Settings.
            start: The start pose ``(3,)`` if it is known; else all poses are equally likely.
            start_sigmas: How sure it is [m, m, rad].
            seed: Of every random number.
        """
        self.config = config or ParticleLocalizerConfig()
        self.updates = 0
        self._known = known
        self._rng = np.random.default_rng(seed)
        self._reader = ScanReader(self.config.reader)
        self._field = LikelihoodField(known, self.config.sensor)
        self._tracker = HypothesisTracker(PoseRefiner(known, reach=self.config.reader.max_range))
        if start is None:
            self._belief = self._anywhere()
        else:
            count = self.config.belief.particles.least
            spread = self._rng.standard_normal((count, 3)) * start_sigmas
            self._belief = self._new(np.asarray(start, dtype=np.float64) + spread)
        self._rival: ParticleBelief | None = None
        self._rival_log_odds = -math.inf
        self._age = 0
        self._moved = np.zeros(3)
        self._hypotheses: list[Hypothesis] = []

    @property
    def pose_map(self) -> Pose:
        """The best guess now ``(3,)``."""
        return compose(self._pose_then(), self._reader.motion_since())

    @property
    def covariance(self) -> NDArray[np.float64]:
        """Its covariance ``(3, 3)`` if the likeliest hypothesis is the right one."""
        if self._tracker.pose is not None:
            return self._tracker.covariance
        if self._hypotheses:
            return self._hypotheses[0].covariance
        return np.asarray(np.cov(self._belief.poses.T))

    @property
    def hypotheses(self) -> Sequence[Hypothesis]:
        """The places where the robot may be, likeliest first."""
        return tuple(self._hypotheses)

    @property
    def is_ambiguous(self) -> bool:
        """Whether other places than the likeliest are still believed possible."""
        return localizer.is_ambiguous(self._hypotheses)

    @property
    def is_lost(self) -> bool:
        """Whether no place is likelier than all others together."""
        return localizer.is_lost(self._hypotheses)

    @property
    def size(self) -> int:
        """How many particles the newest scan was weighed with."""
        rival = 0 if self._rival is None else self._rival.weighed
        return self._belief.weighed + rival

    @property
    def sample(self) -> Pose:
        """The particles ``(n, 3)``."""
        return self._belief.poses

    def update(
        self, scan: LaserScan | None, odometry: Sequence[Odometry], imu: Sequence[Imu] = ()
    ) -> None:
        """Take the messages of one control period."""
        self._reader.add(odometry, imu)
        reading = self._reader.read(scan)
        if reading is None:
            return
        if not reading.is_first:
            self._predict(reading.motion)
        if reading.is_first or self._has_moved():
            self._moved = np.zeros(3)
            self._correct(self._field.thinned(reading.cloud.points))
            self.updates += 1
        self._hypotheses = self._believed()
        self._tracker.follow(reading, self._hypotheses[0] if self._hypotheses else None)

    def _predict(self, motion: Pose) -> None:
        self._moved = compose(self._moved, motion)
        self._belief.predict(motion)
        if self._rival is not None:
            self._rival.predict(motion)

    def _has_moved(self) -> bool:
        x, y, yaw = self._moved
        config = self.config
        return bool(math.hypot(x, y) >= config.least_shift or abs(yaw) >= config.least_turn)

    def _correct(self, points: NDArray[np.float64]) -> None:
        """Weigh both sets; the one that expected the scans better stays."""
        config = self.config
        evidence = self._belief.correct(points)
        self._age += 1
        if self._rival is None:
            if self._age <= config.trial or self._belief.doubt <= config.doubt:
                return
            self._rival, self._age = self._anywhere(), 0
            self._rival_log_odds = math.log(config.carried_off / (1.0 - config.carried_off))
        self._rival_log_odds += self._rival.correct(points) - evidence
        if self._rival_log_odds > 0.0:
            self._rival.remember(self._belief)
            self._belief, self._rival = self._rival, None
        elif self._age >= config.trial:
            self._rival = None

    def _believed(self) -> list[Hypothesis]:
        """The hypotheses of both sets, weighed by how likely each set is."""
        here = cluster(self._belief.poses, self._belief.particles.weights)
        if self._rival is None:
            return here
        elsewhere = cluster(self._rival.poses, self._rival.particles.weights)
        share = 1.0 / (1.0 + math.exp(min(-self._rival_log_odds, MOST_LOG_ODDS)))
        both = [replace(each, weight=(1.0 - share) * each.weight) for each in here]
        both += [replace(each, weight=share * each.weight) for each in elsewhere]
        return sorted(both, key=lambda hypothesis: -hypothesis.weight)

    def _anywhere(self) -> ParticleBelief:
        """Particles spread over the whole map."""
        return self._new(self._known.draw_poses(self.config.at_start, self._rng))

    def _new(self, poses: Pose) -> ParticleBelief:
        return ParticleBelief(poses, self._field, self.config.belief, self._rng)

    def _pose_then(self) -> Pose:
        """The best guess at the newest reading."""
        if self._tracker.pose is not None:
            return self._tracker.pose
        if self._hypotheses:
            return self._hypotheses[0].pose
        heaviest = int(np.argmax(self._belief.particles.weights))
        return np.asarray(self._belief.poses[heaviest])
