"""What a lidar's readings mean and are worth: how often they err, and by how much."""

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from mapping.burger import LIDAR_RANGE_MAX
from mapping.errors import TestbedError
from mapping.messages import LaserScan

OCCUPIED_READINGS, FREE_READINGS, READINGS = 991, 994, 1000
"""Right readings in front of a wall, and of an open hallway (thesis 4.3.2 and appendix A)."""

SIGMAS_IN_PRECISION = 3.0
"""A datasheet's +- bound is taken as three standard deviations."""

NO_RETURN_CLEARS = LIDAR_RANGE_MAX
"""A beam without a return saw free space no farther than this [m], however far the lidar reaches:
the farther, the likelier it met something dark, slanting or of glass. On the Intel Research Lab log
64 % of a SICK's beams without a return crossed a wall of other scans within 10 m, as 22 % of beams
picked for comparison did."""

LONG_RANGE = 4.0
"""A lidar that reports farther than this [m] is no LDS-01, whose limit is 3.5 m."""


@dataclass(frozen=True, slots=True, kw_only=True)
class RangeNoise:
    """How far a lidar's readings scatter: an absolute figure near by, a share of the range far off.

    Both are the +- bounds of a datasheet, SIGMAS_IN_PRECISION standard deviations. What a unit errs
    by always is apart from them.
    """

    near_range: float
    """Below this range the precision is the absolute figure [m]."""
    near_precision: float
    """Precision there [m]."""
    far_precision: float
    """Precision from there on, as a share of the range."""
    scale_sigma: float = 0.0
    """Standard deviation of a unit's scale error: all its ranges are too long, or too short."""

    def __post_init__(self) -> None:
        """Refuse figures that make no noise."""
        if not (np.isfinite(self.scale_sigma) and self.scale_sigma >= 0.0):
            raise TestbedError(f"scale_sigma: {self.scale_sigma}; must be finite, 0 or more")
        for name in ("near_range", "near_precision", "far_precision"):
            value = getattr(self, name)
            if not (np.isfinite(value) and value > 0.0):
                raise TestbedError(f"{name}: {value}; must be a finite number above 0")


LDS_01 = RangeNoise(near_range=0.5, near_precision=0.010, far_precision=0.035, scale_sigma=0.005)
"""+-10 mm below 0.5 m, +-3.5 % from there on (LDS-01 datasheet); a scale of 0.5 %: tape tests of
maps from lidars of this class came out -0.2 to +0.8 %."""

SICK_LMS = RangeNoise(near_range=8.0, near_precision=0.015, far_precision=0.002)
"""5 mm, one standard deviation, up to 8 m; from there on 0.2 % of the range, +-4 cm at 20 m
[assumption: what is commonly said of the SICK LMS 200; no datasheet was at hand]."""

LidarName = Literal["lds01", "sick"]

RANGE_NOISES: dict[LidarName, RangeNoise] = {"lds01": LDS_01, "sick": SICK_LMS}
"""The lidars by name."""


def log_odds(probability: float) -> float:
    """The log odds of a probability strictly between 0 and 1 (thesis 4.1)."""
    return float(np.log(probability / (1.0 - probability)))


LOG_ODDS_OCCUPIED = log_odds(OCCUPIED_READINGS / READINGS)
"""lo1 = 4.7015: what one hit tells (thesis 4.3.2)."""

LOG_ODDS_FREE = log_odds(FREE_READINGS / READINGS)
"""lo0 = 5.1100: what one beam passing through tells (thesis 4.3.2)."""


def range_sigma(ranges: ArrayLike, noise: RangeNoise = LDS_01) -> NDArray[np.float64]:
    """Standard deviation [m] of readings at ``ranges`` ``(n,)`` [m]."""
    ranges = np.asarray(ranges, dtype=np.float64)
    far = noise.far_precision * ranges
    precision = np.where(ranges < noise.near_range, noise.near_precision, far)
    return np.asarray(precision / SIGMAS_IN_PRECISION)


def noise_of_reach(range_max: float) -> RangeNoise:
    """The noise to expect of a lidar that reports ranges up to ``range_max`` [m]."""
    return SICK_LMS if range_max > LONG_RANGE else LDS_01


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Beams:
    """The beams of a scan that tell something."""

    indices: NDArray[np.int64]
    """Their places in the scan ``(n,)``, ascending."""
    lengths: NDArray[np.float64]
    """How far each one is known to have gone ``(n,)`` [m]."""
    hits: NDArray[np.bool_]
    """Whether it met something there ``(n,)``; else it went on."""


def read_beams(scan: LaserScan, max_range: float) -> Beams:
    """Tell what the ranges of a scan mean.

    ``+inf`` went as far as the scan's ``range_max`` and ``max_range`` allow, but NO_RETURN_CLEARS
    at most, and met nothing. Finite readings beyond ``max_range`` went that far and met nothing.
    ``0.0``, NaN, negative readings and those below the scan's ``range_min`` are failures and are
    left out (REP-117, sensor_msgs/LaserScan).

    Args:
        scan: The scan; may have no beams.
        max_range: How far the sensor is trusted [m].
    """
    ranges = np.asarray(scan.ranges, dtype=np.float64)
    indices = np.flatnonzero((ranges > 0.0) & (ranges >= scan.range_min))
    lengths = ranges[indices]
    hits = lengths <= max_range
    seen = min(max_range, NO_RETURN_CLEARS)
    if 0.0 < scan.range_max < seen:
        seen = scan.range_max
    lengths = np.where(np.isinf(lengths), seen, np.minimum(lengths, max_range))
    return Beams(indices=indices, lengths=lengths, hits=hits)
