"""Localises by a histogram over cells of x, y and yaw: grid localisation.

Probabilistic Robotics, table 8.1, with the sensor model of table 6.3, made wider by what a pose in
a coarse cell can be off (8.2.2). Cells without belief are left out of the sums until the scans are
explained worse than they used to be (selective updating, 8.2.3).
"""

import math
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import ArrayLike, NDArray

from mapping.errors import TestbedError
from mapping.filters import bayes
from mapping.geometry import Pose, compose, wrap_to_pi
from mapping.localization.hypothesis_clusters import cluster
from mapping.localization.hypothesis_localizer import HypothesisLocalizer
from mapping.localization.hypothesis_tracker import HypothesisTracker
from mapping.localization.known_map import KnownMap
from mapping.localization.likelihood_field import LikelihoodField, LikelihoodFieldConfig
from mapping.localization.localizer import Hypothesis
from mapping.localization.pose_lattice_kernels import shift_belief
from mapping.localization.pose_refiner import PoseRefiner
from mapping.localization.scan_reader import ReaderConfig, Reading


@dataclass(frozen=True, slots=True, kw_only=True)
class HistogramLocalizerConfig:
    """Settings; the default is a Burger in a building."""

    resolution: float = 0.15
    """Edge of a cell [m] (Probabilistic Robotics 8.2.2: 15 cm is typical)."""
    layers: int = 72
    """Headings: 5 degrees apart (the same)."""
    sensor: LikelihoodFieldConfig = field(
        default_factory=lambda: LikelihoodFieldConfig(sigma_hit=0.15)
    )
    """The sensor model, wider than that of particles by half a cell."""
    reader: ReaderConfig = field(default_factory=ReaderConfig)
    carried_off: float = 1e-4
    """Share of the belief that is spread over all cells at each update: the robot may have been
    carried off."""
    least: float = 1e-8
    """A cell with less belief than this is not looked at."""
    doubt: float = 0.7
    """When the newest scans' readings are this much less likely than usual, all cells are."""
    slow_rate: float = 0.02
    """Rate of the long-term average of that likelihood."""
    least_shift: float = 0.1
    """A robot must have moved this far [m] for an update, so that few cells' parts are lost."""
    least_turn: float = 0.1
    """Or turned so far [rad]."""

    def __post_init__(self) -> None:
        """Refuse figures that make no histogram."""
        if not 0.01 <= self.resolution <= 1.0:
            raise TestbedError(f"histogram resolution: {self.resolution} m; must be 0.01 to 1")
        if self.layers < 4:
            raise TestbedError(f"histogram layers: {self.layers}; must be at least 4")


class HistogramLocalizer(HypothesisLocalizer):
    """Grid localisation on a known map; starts anywhere, or at a given pose."""

    def __init__(
        self,
        known: KnownMap,
        config: HistogramLocalizerConfig | None = None,
        *,
        start: ArrayLike | None = None,
        start_sigmas: tuple[float, float, float] = (0.1, 0.1, 0.1),
    ) -> None:
        """Spread the belief.

        Args:
            known: The map.
            config: Settings.
            start: The start pose ``(3,)`` if it is known; else all poses are equally likely.
            start_sigmas: How sure it is [m, m, rad].

        Raises:
            TestbedError: The robot fits nowhere near the start.
        """
        self.config = config or HistogramLocalizerConfig()
        reader = self.config.reader
        refiner = PoseRefiner(known, reach=reader.max_range)
        super().__init__(reader, HypothesisTracker(refiner))
        self._field = LikelihoodField(known, self.config.sensor)
        self._possible = _possible(known, self.config)
        self._poses = _middles(known, self.config)
        self._belief = self._possible / self._possible.sum()
        if start is not None:
            self._belief = self._belief * _bell(self._poses, np.asarray(start), start_sigmas)
            if not self._belief.sum() > 0.0:
                x, y, _ = np.asarray(start).tolist()
                raise TestbedError(f"start: ({x:g}, {y:g}); the robot must fit there on the map")
            self._belief /= self._belief.sum()
        self._usual = self._field.best
        self._pending = np.zeros(3)
        self._looked_at = int(self._possible.sum())
        # on the largest maps an even belief has less in each cell
        self._least = min(self.config.least, 0.1 / max(self._looked_at, 1))

    @property
    def size(self) -> int:
        """How many cells the newest update looked at."""
        return self._looked_at

    @property
    def sample(self) -> Pose:
        """Middles of the cells that are looked at ``(n, 3)``."""
        return np.asarray(self._poses[self._belief > self._least])

    def _believe(self, reading: Reading) -> None:
        if not reading.is_first:
            self._pending = compose(self._pending, reading.motion)
        x, y, turn = self._pending
        config = self.config
        has_moved = math.hypot(x, y) >= config.least_shift or abs(turn) >= config.least_turn
        if reading.is_first or has_moved:
            self._predict()
            self._correct(self._field.thinned(reading.cloud.points))
            self._locate()
            self.updates += 1
        else:
            self._hypotheses = [_moved(each, reading.motion) for each in self._hypotheses]

    def _predict(self) -> None:
        """Move the belief by the motion since it was moved last (table 8.1, line 3)."""
        x, y, turn = self._pending.tolist()
        self._pending = np.zeros(3)
        config = self.config
        moved = shift_belief(self._belief, (x, y, turn), config.resolution, self._least)
        moved *= self._possible
        anywhere = self._possible / self._possible.sum()
        total = float(moved.sum())
        share = config.carried_off if total > 0.0 else 1.0
        self._belief = (1.0 - share) * moved / max(total, self._least) + share * anywhere

    def _correct(self, points: NDArray[np.float64]) -> None:
        """Weigh the cells by a scan (line 4); all of them if those that matter explain it badly."""
        config = self.config
        active = self._belief > self._least
        logs = self._field.log_likelihoods(self._poses[active], points)
        evidence = self._evidence(active, logs, len(points))
        if evidence < config.doubt * self._usual and active.sum() < self._possible.sum():
            active = self._possible
            logs = self._field.log_likelihoods(self._poses[active], points)
            evidence = self._evidence(active, logs, len(points))
        self._usual += config.slow_rate * (evidence - self._usual)
        self._looked_at = int(active.sum())
        prior = self._belief[active]
        posterior = np.zeros_like(self._belief)
        posterior[active] = bayes.correct(prior / prior.sum(), np.exp(logs - logs.max()))
        self._belief = posterior

    def _evidence(
        self, active: NDArray[np.bool_], logs: NDArray[np.float64], readings: int
    ) -> float:
        """Mean likelihood of one reading over the belief."""
        belief = self._belief[active]
        per_reading = np.exp(logs * (self.config.sensor.togetherness / max(readings, 1)))
        return float(belief @ per_reading / belief.sum())

    def _locate(self) -> None:
        """Gather the cells that matter into hypotheses."""
        active = self._belief > self._least
        self._hypotheses = cluster(self._poses[active], self._belief[active])

    def _likeliest_pose(self) -> Pose:
        return np.asarray(self._poses[np.unravel_index(self._belief.argmax(), self._belief.shape)])


def _possible(known: KnownMap, config: HistogramLocalizerConfig) -> NDArray[np.bool_]:
    """Cells in which the robot fits somewhere ``[yaw, row, col]``."""
    step = config.resolution / known.resolution
    rows, columns = (math.ceil(side / step) for side in known.occupied.shape)
    fits = np.zeros((rows, columns), dtype=np.bool_)
    cells = (known.places / step).astype(np.int64)
    fits[cells[:, 0], cells[:, 1]] = True
    return np.broadcast_to(fits, (config.layers, rows, columns)).copy()


def _middles(known: KnownMap, config: HistogramLocalizerConfig) -> Pose:
    """Poses of the cells' middles ``[yaw, row, col, 3]``."""
    layers, rows, columns = _possible(known, config).shape
    yaw = wrap_to_pi(np.arange(layers) * (2.0 * np.pi / layers))
    y = known.origin[1] + (np.arange(rows) + 0.5) * config.resolution
    x = known.origin[0] + (np.arange(columns) + 0.5) * config.resolution
    yaws, ys, xs = np.meshgrid(yaw, y, x, indexing="ij")
    return np.stack((xs, ys, yaws), axis=-1)


def _bell(poses: Pose, mean: Pose, sigmas: tuple[float, float, float]) -> NDArray[np.float64]:
    apart = poses - mean
    apart[..., 2] = wrap_to_pi(apart[..., 2])
    return np.asarray(np.exp(-0.5 * np.sum((apart / np.array(sigmas)) ** 2, axis=-1)))


def _moved(hypothesis: Hypothesis, motion: Pose) -> Hypothesis:
    return Hypothesis(
        pose=compose(hypothesis.pose, motion),
        covariance=hypothesis.covariance,
        weight=hypothesis.weight,
    )
