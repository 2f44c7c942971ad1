"""Turns what the lidar sees of legs into the middles of those who walk on them."""

import numpy as np
from numpy.typing import NDArray

LEG_BEHIND = 0.05
"""A leg's middle lies so far behind where beams meet it [m]: pi / 4 of a radius of 0.06 m."""

ONE_LEG = 0.15
"""Points up to this far apart are of one leg [m]: it is 0.12 m thick."""


def bodies(
    points: NDArray[np.float64], origin: NDArray[np.float64], same: float
) -> list[NDArray[np.float64]]:
    """Middles ``(2,)`` [m] of those whose legs were met.

    Each leg counts alike, however many beams met it: what half hides one leg behind the other does
    not draw the middle to the other.

    Args:
        points: Where beams met legs ``(n, 2)`` [m].
        origin: Where the sensor was ``(2,)`` [m].
        same: Legs up to this far apart are of one body [m].
    """
    if len(points) == 0:
        return []
    offsets = points - origin
    aways = np.maximum(np.hypot(offsets[:, 0], offsets[:, 1]), LEG_BEHIND)
    legs = _middles(points + LEG_BEHIND * offsets / aways[:, None], ONE_LEG)
    return _middles(np.array(legs), same)


def has_neighbour(
    points: NDArray[np.float64], beams: NDArray[np.int64], count: int, apart: float
) -> NDArray[np.bool_]:
    """Which points ``(n, 2)`` have one of the next or the last beam within ``apart`` [m].

    A leg is met by two beams side by side even 3 m away; a chair's by one or none, and one that the
    earlier scans missed has not come since.

    Args:
        points: Where beams met something [m].
        beams: Which beams these are ``(n,)``, ascending.
        count: How many beams there are all round.
        apart: How far apart the returns of one thing are [m].
    """
    gaps = np.hypot(*(np.roll(points, -1, axis=0) - points).T)
    is_next = (np.roll(beams, -1) - beams) % count == 1
    beside = is_next & (gaps < apart)
    return np.asarray(beside | np.roll(beside, 1))


def _middles(points: NDArray[np.float64], same: float) -> list[NDArray[np.float64]]:
    """Means of the groups of points that hang together within ``same`` [m]."""
    left = np.ones(len(points), dtype=np.bool_)
    middles = []
    while left.any():
        group = np.flatnonzero(left)[:1]
        left[group] = False
        grown = 0
        while grown < len(group):
            gaps = np.hypot(*(points - points[group[grown]]).T)
            joined = np.flatnonzero(left & (gaps < same))
            left[joined] = False
            group = np.concatenate((group, joined))
            grown += 1
        middles.append(points[group].mean(axis=0))
    return middles
