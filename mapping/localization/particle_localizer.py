"""Localises by particles: Monte Carlo localisation that finds itself again when carried off.

Probabilistic Robotics, tables 8.2 to 8.4, with the motion model of table 5.6 and the sensor model
of table 6.3. When the particles explain the scans worse than they used to (w_fast, w_slow of table
8.3), random ones are tried. They do not mix with the others at once: a second set, spread over the
whole map, localises beside the first, and the evidence of the scans decides between the two
(Bayesian model comparison). Thus any number of random particles can be tried without losing a robot
that was not carried off.
"""

import math
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from mapping.errors import TestbedError
from mapping.geometry import Pose, compose
from mapping.localization.hypothesis_clusters import cluster
from mapping.localization.hypothesis_localizer import HypothesisLocalizer
from mapping.localization.hypothesis_tracker import HypothesisTracker
from mapping.localization.known_map import KnownMap
from mapping.localization.likelihood_field import LikelihoodField, LikelihoodFieldConfig
from mapping.localization.localizer import Hypothesis
from mapping.localization.particle_belief import BeliefConfig, ParticleBelief
from mapping.localization.pose_refiner import PoseRefiner
from mapping.localization.scan_reader import ReaderConfig, Reading

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


class ParticleLocalizer(HypothesisLocalizer):
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
        reader = self.config.reader
        refiner = PoseRefiner(known, reach=reader.max_range)
        super().__init__(reader, HypothesisTracker(refiner))
        self._known = known
        self._rng = np.random.default_rng(seed)
        self._field = LikelihoodField(known, self.config.sensor)
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

    @property
    def size(self) -> int:
        """How many particles the newest scan was weighed with."""
        rival = 0 if self._rival is None else self._rival.weighed
        return self._belief.weighed + rival

    @property
    def sample(self) -> Pose:
        """The particles ``(n, 3)``."""
        return self._belief.poses

    def _believe(self, reading: Reading) -> None:
        if not reading.is_first:
            self._predict(reading.motion)
        if reading.is_first or self._has_moved():
            self._moved = np.zeros(3)
            self._correct(self._field.thinned(reading.cloud.points))
            self.updates += 1
        self._hypotheses = self._believed()

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

    def _likeliest_pose(self) -> Pose:
        heaviest = int(np.argmax(self._belief.particles.weights))
        return np.asarray(self._belief.poses[heaviest])
