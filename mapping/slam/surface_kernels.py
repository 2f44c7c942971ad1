"""Kernel that lays evenly spaced points along the walls that a scan saw.

A field smeared from the readings alone is higher where beams lie closer together, near the robot,
and bumpy where they are far apart. Both pull the next scan back to where the last one was taken.
"""

import math

import numpy as np
from numba import njit
from numpy.typing import NDArray

STEEPEST = 6.0
"""Neighbours farther apart than this many times the distance between their beams lie on different
things: a wall is believed up to about 80 degrees from the beam's normal."""

WIDEST_GAP = 0.4
"""Nor are they joined farther apart than this [m]."""

ASLANT = 0.4
"""A piece between neighbours lies along their wall if no more than this share of it goes across."""

NEIGHBOURS = 2
"""Beams are neighbours up to this many increments apart: one between them may have failed."""

FELLOWS, LEAST_FELLOWS = 4, 4
"""A wall's direction is taken from up to so many beams on both sides, and at least so many points
altogether."""

CLOSE = 0.05
"""Points this near [m] may lie on the same wall, however noisy they are."""

FLATNESS = 0.15
"""Points spread across, squared, less than this share of along lie on a wall; else on a corner or
on nothing that has a direction."""


@njit(cache=True)
def surface_of(
    points: NDArray[np.float64],
    lengths: NDArray[np.float64],
    indices: NDArray[np.int64],
    weights: NDArray[np.float64],
    normals: NDArray[np.float64],
    increment: float,
    spacing: float,
) -> NDArray[np.float32]:
    """Points spread along the walls that readings lie on ``(m, 5)``.

    Their columns are x, y [m], weight, and the direction that the wall faces, zeros if unknown.

    Each reading stands for half of the way to each neighbour on the same wall, at least for the
    width of its beam. Weights are such that each point stands for ``spacing`` of wall.

    Args:
        points: Readings ``(n, 2)`` [m], in the order of their beams.
        lengths: How far they were from the lidar ``(n,)`` [m].
        indices: Their beams ``(n,)``, ascending.
        weights: How much each tells ``(n,)``.
        normals: Directions that their walls face ``(n, 2)``.
        increment: Angle between beams [rad].
        spacing: Distance between points along a wall [m].
    """
    count = len(lengths)
    surface = np.empty((count * (3 + int(WIDEST_GAP / spacing)), 5), dtype=np.float32)
    made = 0
    for i in range(count):
        width = min(lengths[i] * increment, spacing)
        joined = 0.0
        for side in (-1, 1):
            j = i + side
            if j < 0 or j >= count or abs(indices[j] - indices[i]) > NEIGHBOURS:
                continue
            dx, dy = points[j, 0] - points[i, 0], points[j, 1] - points[i, 1]
            gap = math.hypot(dx, dy)
            apart = min(lengths[i], lengths[j]) * increment * abs(indices[j] - indices[i])
            if gap > min(STEEPEST * apart + spacing, WIDEST_GAP):
                continue
            across = abs(normals[i, 0] * dx + normals[i, 1] * dy)
            is_wall = normals[i, 0] != 0.0 or normals[i, 1] != 0.0
            if gap > spacing and not (is_wall and across <= ASLANT * gap):
                continue
            joined += 0.5 * gap
            steps = math.ceil(0.5 * gap / spacing)
            for k in range(steps):
                share = 0.5 * (k + 0.5) / steps
                surface[made, 0] = points[i, 0] + share * dx
                surface[made, 1] = points[i, 1] + share * dy
                surface[made, 2] = weights[i] * (0.5 * gap / steps) / spacing
                surface[made, 3], surface[made, 4] = normals[i, 0], normals[i, 1]
                made += 1
        if joined < width:
            surface[made, 0], surface[made, 1] = points[i, 0], points[i, 1]
            surface[made, 2] = weights[i] * (width - joined) / spacing
            surface[made, 3], surface[made, 4] = normals[i, 0], normals[i, 1]
            made += 1
    return surface[:made].copy()


@njit(cache=True)
def normals_of(
    points: NDArray[np.float64],
    lengths: NDArray[np.float64],
    indices: NDArray[np.int64],
    increment: float,
) -> NDArray[np.float64]:
    """Directions that the walls of readings face ``(n, 2)``; zeros where there is no wall.

    They face the robot, at the origin. A direction is the axis of least spread of a reading and its
    neighbours on the same wall, if the spread along the wall is much larger.

    Args:
        points: Readings ``(n, 2)`` [m], in the order of their beams.
        lengths: How far they were from the lidar ``(n,)`` [m].
        indices: Their beams ``(n,)``, ascending.
        increment: Angle between beams [rad].
    """
    count = len(lengths)
    normals = np.zeros((count, 2))
    for i in range(count):
        sum_x = sum_y = sum_xx = sum_xy = sum_yy = 0.0
        used = 0
        for j in range(max(i - FELLOWS, 0), min(i + FELLOWS + 1, count)):
            dx, dy = points[j, 0] - points[i, 0], points[j, 1] - points[i, 1]
            beams = abs(indices[j] - indices[i])
            apart = min(lengths[i], lengths[j]) * increment * beams
            widest = STEEPEST * apart + CLOSE
            if beams > FELLOWS or dx * dx + dy * dy > widest * widest:
                continue
            sum_x, sum_y, used = sum_x + dx, sum_y + dy, used + 1
            sum_xx, sum_xy, sum_yy = sum_xx + dx * dx, sum_xy + dx * dy, sum_yy + dy * dy
        if used < LEAST_FELLOWS:
            continue
        a = sum_xx / used - (sum_x / used) ** 2
        b = sum_xy / used - (sum_x / used) * (sum_y / used)
        c = sum_yy / used - (sum_y / used) ** 2
        middle, spread = 0.5 * (a + c), math.hypot(0.5 * (a - c), b)
        if middle - spread > FLATNESS * (middle + spread):
            continue
        angle = 0.5 * math.atan2(2.0 * b, a - c) + 0.5 * math.pi
        nx, ny = math.cos(angle), math.sin(angle)
        sign = -1.0 if nx * points[i, 0] + ny * points[i, 1] > 0.0 else 1.0
        normals[i, 0], normals[i, 1] = sign * nx, sign * ny
    return normals
