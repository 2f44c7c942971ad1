"""What the LDS-01's readings mean and are worth: how often it errs, and by how much."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from mapping.messages import LaserScan

OCCUPIED_READINGS, FREE_READINGS, READINGS = 991, 994, 1000
"""Right readings in front of a wall, and of an open hallway (thesis 4.3.2 and appendix A)."""

NEAR_RANGE = 0.5
"""Below this range [m] the precision is an absolute figure (LDS-01 datasheet)."""

NEAR_PRECISION, FAR_PRECISION = 0.010, 0.035
"""Precision: +-10 mm below NEAR_RANGE, +-3.5 % of the range from there on (LDS-01 datasheet)."""

SIGMAS_IN_PRECISION = 3.0
"""A datasheet's +- bound is taken as three standard deviations."""


def log_odds(probability: float) -> float:
    """The log odds of a probability strictly between 0 and 1 (thesis 4.1)."""
    return float(np.log(probability / (1.0 - probability)))


LOG_ODDS_OCCUPIED = log_odds(OCCUPIED_READINGS / READINGS)
"""lo1 = 4.7015: what one hit tells (thesis 4.3.2)."""

LOG_ODDS_FREE = log_odds(FREE_READINGS / READINGS)
"""lo0 = 5.1100: what one beam passing through tells (thesis 4.3.2)."""


def range_sigma(ranges: ArrayLike) -> NDArray[np.float64]:
    """Standard deviation [m] of readings at ``ranges`` ``(n,)`` [m] of an LDS-01."""
    ranges = np.asarray(ranges, dtype=np.float64)
    precision = np.where(ranges < NEAR_RANGE, NEAR_PRECISION, FAR_PRECISION * ranges)
    return np.asarray(precision / SIGMAS_IN_PRECISION)


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

    ``+inf`` and finite readings beyond ``max_range`` went ``max_range`` far and met nothing.
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
    return Beams(indices=indices, lengths=np.minimum(lengths, max_range), hits=hits)
