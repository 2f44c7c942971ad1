"""The inner loop of noticing movers: which points lie where earlier scans saw nothing."""

import math

import numpy as np
from numba import njit
from numpy.typing import NDArray

SMALLEST = 1e-9
"""Keeps a point at the sensor itself from dividing by zero [m]."""


@njit(cache=True)
def seen_through(
    points: NDArray[np.float64],
    origins: NDArray[np.float64],
    bearings: NDArray[np.float64],
    increments: NDArray[np.float64],
    ranges: NDArray[np.float64],
    aside: float,
    margin: float,
    share: float,
) -> NDArray[np.int64]:
    """How many of the earlier scans saw through each point ``(n,)``.

    A scan saw through a point if all its beams that pass within ``aside`` [m] of it went farther,
    by ``margin`` [m] and ``share`` of the distance. A beam that failed (NaN) tells that it did not,
    and so does one that the scan does not have.

    Args:
        points: Where something is now ``(n, 2)`` [m].
        origins: Where each scan was taken ``(m, 2)`` [m].
        bearings: Direction of each scan's first beam ``(m,)`` [rad].
        increments: Angle from beam to beam of each scan ``(m,)`` [rad], not 0.
        ranges: How far its beams went ``(m, k)`` [m]; inf for those that met nothing.
        aside: How thick a thing is looked for, to either side [m].
        margin: What the ranges and the pose may err by [m].
        share: What they may err by besides, for each metre.
    """
    beams = ranges.shape[1]
    circle = 2.0 * math.pi
    counts = np.zeros(len(points), dtype=np.int64)
    for j in range(len(origins)):
        step = abs(increments[j])
        around = max(1, math.floor(circle / step + 0.5))
        for i in range(len(points)):
            dx, dy = points[i, 0] - origins[j, 0], points[i, 1] - origins[j, 1]
            distance = math.sqrt(dx * dx + dy * dy)
            turn = math.atan2(dy, dx) - bearings[j]
            if increments[j] < 0.0:
                turn = -turn
            turn -= circle * math.floor(turn / circle)
            beam = math.floor(turn / step + 0.5)
            span = max(1, math.ceil(min(aside / (distance * step + SMALLEST), beams / 4.0)))
            least = distance + margin + share * distance
            counts[i] += _all_farther(ranges[j], around, beam - span, beam + span, least)
    return counts


@njit(cache=True)
def _all_farther(
    ranges: NDArray[np.float64], around: int, first: int, last: int, least: float
) -> bool:
    """Whether the beams from ``first`` to ``last`` went farther.

    They are counted ``around`` the circle: more than there are if the sensor turned back while it
    looked, when there is a gap between the last and the first, and fewer if it turned on.
    """
    goes_round = first < 0 or last >= around  # seldom, and remainders are slow
    for k in range(first, last + 1):
        beam = k % around if goes_round else k
        if not (beam < len(ranges) and ranges[beam] > least):
            return False
    return True
