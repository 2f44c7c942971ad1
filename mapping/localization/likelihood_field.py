"""Turns a map into the log likelihood of every reading, wherever it ends.

The likelihood field range finder model (Probabilistic Robotics, table 6.3) of an LDS-01: a reading
is a hit of the nearest wall, with a normal error, or anything at all. Readings without return are
left out, as the table has it.
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mapping.burger import LIDAR_RANGE_MAX
from mapping.errors import TestbedError
from mapping.geometry import Pose
from mapping.localization.known_map import KnownMap
from mapping.localization.likelihood_kernels import score_poses


@dataclass(frozen=True, slots=True, kw_only=True)
class LikelihoodFieldConfig:
    """The mixture, and how much of a scan is looked at."""

    z_hit: float = 0.9
    """Share of readings that are hits."""
    z_rand: float = 0.1
    """Share of readings that are anything: people, things moved, wrong readings."""
    z_max: float = LIDAR_RANGE_MAX
    """Range over which a random reading is spread [m]."""
    sigma_hit: float = 0.1
    """Standard deviation of a hit about the nearest wall [m]: the LDS-01's 0.04 m at 3.5 m, the
    error of the map, and half the distance between hypotheses."""
    beams: int = 60
    """Readings of a scan that are looked at, evenly spread over those that hit something."""
    togetherness: float = 6.0
    """So many readings count as one: those of one wall err together, with the map and with the
    pose's own distance from the truth."""
    resolution: float = 0.05
    """Edge of a cell of the field [m]; a map finer than this is looked at in its cells' middles."""

    def __post_init__(self) -> None:
        """Refuse figures that make no mixture."""
        for name in ("z_hit", "z_rand", "z_max", "sigma_hit", "togetherness", "resolution"):
            value = getattr(self, name)
            if not (math.isfinite(value) and value > 0.0):
                raise TestbedError(f"likelihood {name}: {value}; must be finite and above 0")
        if abs(self.z_hit + self.z_rand - 1.0) > 1e-9:
            raise TestbedError(
                f"likelihood z_hit, z_rand: {self.z_hit}, {self.z_rand}; must sum to 1"
            )
        if self.beams < 1:
            raise TestbedError(f"likelihood beams: {self.beams}; must be at least 1")


class LikelihoodField:
    """The log likelihood of a reading that ends in each cell."""

    def __init__(self, known: KnownMap, config: LikelihoodFieldConfig | None = None) -> None:
        self.config = config or LikelihoodFieldConfig()
        step = max(1, round(self.config.resolution / known.resolution))
        self.resolution = step * known.resolution
        self.origin = known.origin
        distances = known.distances[step // 2 :: step, step // 2 :: step].astype(np.float64)
        self.log_likelihood = log_likelihood(distances, self.config).astype(np.float32)
        self.nothing = np.float32(log_likelihood(np.array(np.inf), self.config))
        """Log likelihood of a reading that ends off the map."""
        self.best = math.exp(float(log_likelihood(np.zeros(()), self.config)))
        """Likelihood of a reading that ends on a wall."""

    def thinned(self, points: NDArray[np.float64]) -> NDArray[np.float64]:
        """The readings that are looked at, of those of a scan ``(n, 2)``."""
        count = min(self.config.beams, len(points))
        if count == 0:
            return points
        return points[np.arange(count) * len(points) // count]

    def log_likelihoods(self, poses: Pose, points: NDArray[np.float64]) -> NDArray[np.float64]:
        """log p(z | x) of a scan from every pose ``(n,)``, readings that err together as one.

        A scan that was seen in full weighs as much however many of its readings hit something.

        Args:
            poses: Where base_footprint may have been ``(n, 3)``.
            points: Where beams ended, in base_footprint ``(m, 2)`` [m]; see ``thinned``.
        """
        if len(points) == 0:
            return np.zeros(len(poses))
        scores: NDArray[np.float64] = score_poses(
            self.log_likelihood,
            self.nothing,
            (float(self.origin[0]), float(self.origin[1])),
            self.resolution,
            poses,
            points,
        )
        return scores / self.config.togetherness


def log_likelihood(
    distances: NDArray[np.float64], config: LikelihoodFieldConfig
) -> NDArray[np.float64]:
    """log p(z | x, m) of readings that end at distances from the nearest wall [m], as a density."""
    bell = np.exp(-0.5 * (distances / config.sigma_hit) ** 2)
    height = config.z_hit / (config.sigma_hit * math.sqrt(2.0 * math.pi))
    return np.asarray(np.log(height * bell + config.z_rand / config.z_max))
