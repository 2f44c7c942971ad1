"""Turns what the lidar sees of legs into the middles of those who walk on them."""

import numpy as np
from numpy.typing import NDArray

LEG_BEHIND = 0.05
"""A leg's middle lies so far behind where beams meet it [m]: pi / 4 of a radius of 0.06 m."""

ONE_LEG = 0.15
"""Points up to this far apart are of one leg [m]: it is 0.12 m thick."""

LEGS = 2
"""Legs of a person."""

NO_LEGS: NDArray[np.float64] = np.zeros((0, 2))
"""Nobody."""


def legs_of(points: NDArray[np.float64], origin: NDArray[np.float64]) -> NDArray[np.float64]:
    """Middles of legs ``(m, 2)`` [m] from where beams met them.

    Args:
        points: Where they did ``(n, 2)`` [m].
        origin: Where the sensor was ``(2,)`` [m].
    """
    if len(points) == 0:
        return NO_LEGS
    offsets = points - origin
    aways = np.maximum(np.hypot(offsets[:, 0], offsets[:, 1]), LEG_BEHIND)
    seen = hanging_together(points + LEG_BEHIND * offsets / aways[:, None], ONE_LEG)
    return np.array([leg.mean(axis=0) for leg in seen])


def parted(
    legs: NDArray[np.float64], expected: NDArray[np.float64], gate: float
) -> list[NDArray[np.float64]]:
    """The legs ``(k, 2)`` [m] of each of those who stand together; one lot if they are of one.

    Args:
        legs: Legs that hang together ``(n, 2)`` [m].
        expected: Where somebody is expected ``(m, 2)`` [m].
        gate: Nobody is expected among legs of which none is within this of him [m].
    """
    gaps = np.linalg.norm(legs[:, None] - expected, axis=2)
    there = np.flatnonzero((gaps < gate).any(axis=0))
    if len(there) < 2:
        return [legs]
    owners = _owners(gaps[:, there])
    return [legs[owners == k] for k in range(len(there)) if np.any(owners == k)]


def _owners(gaps: NDArray[np.float64]) -> NDArray[np.int64]:
    """Whose each leg is ``(n,)``, by how far it is from where each is expected ``(n, m)`` [m].

    The nearest go together first, and nobody has more than two while others have none left to take.
    """
    owners = np.full(len(gaps), -1, dtype=np.int64)
    taken = np.zeros(gaps.shape[1], dtype=np.int64)
    for index in np.argsort(gaps, axis=None).tolist():
        leg, person = divmod(index, gaps.shape[1])
        if owners[leg] < 0 and taken[person] < LEGS:
            owners[leg] = person
            taken[person] += 1
    return np.where(owners < 0, gaps.argmin(axis=1), owners)


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


def hanging_together(points: NDArray[np.float64], apart: float) -> list[NDArray[np.float64]]:
    """The points ``(k, 2)`` of each group that hangs together within ``apart`` [m]."""
    left = np.ones(len(points), dtype=np.bool_)
    groups = []
    while left.any():
        group = np.flatnonzero(left)[:1]
        left[group] = False
        grown = 0
        while grown < len(group):
            gaps = np.hypot(*(points - points[group[grown]]).T)
            joined = np.flatnonzero(left & (gaps < apart))
            left[joined] = False
            group = np.concatenate((group, joined))
            grown += 1
        groups.append(points[group])
    return groups
