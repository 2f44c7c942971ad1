"""The inner loops of remembering returns: the cells of them and between them, and what is wall."""

import math

import numpy as np
from numba import njit
from numpy.typing import NDArray

from mapping.grid import UNKNOWN

SUPPORT = 0.5
"""How long a straight piece of wall must be to be drawn on across a gap, as a share of the gap."""
STRAIGHT = 0.05
"""How far its points may lie off the line across the gap, as a share of the gap."""
SUPPORT_BEAMS = 8
"""At most so many beams make up that piece: farther back spacing hardly grows any more."""


@njit(cache=True)
def cells_between(
    points: NDArray[np.float64],
    beams: NDArray[np.int64],
    count: int,
    gap: float,
    straight_gap: float,
    lattice: tuple[float, float, float],
    shape: tuple[int, int],
) -> NDArray[np.int64]:
    """The cells ``(m, 2)`` as (row, column) of points, and of the lines between neighbours.

    Neighbours are points of beams next to each other, the last and the first among them, that lie
    within ``gap`` [m], or within ``straight_gap`` [m] where a straight wall leads up to one of them
    and on to the other: a wall seen at a grazing angle. The lines are sampled every half cell; a
    cell may come more than once.

    Args:
        points: Where beams met something ``(n, 2)`` [m].
        beams: Which beams these are ``(n,)``, ascending.
        count: How many beams a scan has.
        gap: How far apart neighbours may lie [m].
        straight_gap: The same where the wall is straight [m], ``gap`` or more.
        lattice: The cells' origin x, y and their edge [m].
        shape: Rows and columns; cells outside are left out.
    """
    left, bottom, edge = lattice
    most = 1 + math.ceil(2.0 * straight_gap / edge)
    cells = np.empty((len(points) * most, 2), dtype=np.int64)
    filled = 0
    for i in range(len(points)):
        j = (i + 1) % len(points)
        dx, dy = points[j, 0] - points[i, 0], points[j, 1] - points[i, 1]
        length = math.hypot(dx, dy)
        steps = 1
        if (beams[j] - beams[i]) % count == 1 and (
            length <= gap
            or (
                length <= straight_gap
                and (
                    _leads_on(points, beams, count, i, j, -1)
                    or _leads_on(points, beams, count, j, i, 1)
                )
            )
        ):
            steps = max(1, math.ceil(2.0 * length / edge))
        for k in range(steps):
            row = math.floor((points[i, 1] + k / steps * dy - bottom) / edge)
            column = math.floor((points[i, 0] + k / steps * dx - left) / edge)
            if 0 <= row < shape[0] and 0 <= column < shape[1]:
                cells[filled, 0], cells[filled, 1] = row, column
                filled += 1
    return cells[:filled]


@njit(cache=True)
def _leads_on(
    points: NDArray[np.float64],
    beams: NDArray[np.int64],
    count: int,
    near: int,
    far: int,
    step: int,
) -> bool:
    """Whether a straight wall ends at point ``near`` and points at ``far``; goes back by ``step``.

    Its points must be of beams next to each other.
    """
    dx, dy = points[near, 0] - points[far, 0], points[near, 1] - points[far, 1]
    gap = math.hypot(dx, dy)
    last = near
    for _ in range(SUPPORT_BEAMS):
        point = (last + step) % len(points)
        if (step * (beams[point] - beams[last])) % count != 1:
            return False
        x, y = points[point, 0] - points[near, 0], points[point, 1] - points[near, 1]
        if abs(dx * y - dy * x) > STRAIGHT * gap * gap:
            return False
        if dx * x + dy * y >= SUPPORT * gap * gap:
            return True
        last = point
    return False


@njit(cache=True)
def wall_in_unknown(states: NDArray[np.int8], returned: NDArray[np.bool_]) -> NDArray[np.int64]:
    """The cells ``(n, 2)`` with returns that are unknown or have an unknown neighbour of four."""
    rows, columns = states.shape
    cells = np.empty((np.count_nonzero(returned), 2), dtype=np.int64)
    count = 0
    for i in range(rows):
        for j in range(columns):
            if returned[i, j] and (
                states[i, j] == UNKNOWN
                or (i > 0 and states[i - 1, j] == UNKNOWN)
                or (i < rows - 1 and states[i + 1, j] == UNKNOWN)
                or (j > 0 and states[i, j - 1] == UNKNOWN)
                or (j < columns - 1 and states[i, j + 1] == UNKNOWN)
            ):
                cells[count, 0], cells[count, 1] = i, j
                count += 1
    return cells[:count]
