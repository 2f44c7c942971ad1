"""Tells which of the two stamps in the lines of a CARMEN log to go by."""

from collections.abc import Sequence

import numpy as np

Stamps = tuple[float, float]
"""When the sensor measured and when the logger wrote [s]."""


def clock_of(stamps: Sequence[Stamps]) -> int:
    """0 for the sensors' clock, 1 for the logger's.

    The sensors' it is, unless it has no stamps above 0, or stood still or was set back so that the
    logger's tells more messages apart.
    """
    late = [_late([pair[clock] for pair in stamps]) for clock in (0, 1)]
    return 0 if late[0] <= late[1] and any(sensor > 0.0 for sensor, _ in stamps) else 1


def _late(stamps: Sequence[float]) -> int:
    """How many stamps are no newer than one before them."""
    newest = np.maximum.accumulate(np.asarray(stamps, dtype=np.float64))
    return int(np.count_nonzero(np.asarray(stamps[1:]) <= newest[:-1]))
