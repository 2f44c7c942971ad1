"""The inner loop of remembering returns: the cells that they lie in, and those between them."""

import math

import numpy as np
from numba import njit
from numpy.typing import NDArray


@njit(cache=True)
def cells_between(
    points: NDArray[np.float64],
    beams: NDArray[np.int64],
    count: int,
    gap: float,
    lattice: tuple[float, float, float],
) -> NDArray[np.int64]:
    """The cells ``(m, 2)`` as (row, column) of points, and of the lines between neighbours.

    Neighbours are points of beams next to each other, the last and the first among them, that lie
    within ``gap`` [m]. The lines are sampled every half cell; a cell may come more than once.

    Args:
        points: Where beams met something ``(n, 2)`` [m].
        beams: Which beams these are ``(n,)``, ascending.
        count: How many beams a scan has.
        gap: How far apart neighbours may lie [m].
        lattice: The cells' origin x, y and their edge [m].
    """
    left, bottom, edge = lattice
    most = 1 + math.ceil(2.0 * gap / edge)
    cells = np.empty((len(points) * most, 2), dtype=np.int64)
    filled = 0
    for i in range(len(points)):
        j = (i + 1) % len(points)
        dx, dy = points[j, 0] - points[i, 0], points[j, 1] - points[i, 1]
        length = math.hypot(dx, dy)
        steps = 1
        if (beams[j] - beams[i]) % count == 1 and length <= gap:
            steps = max(1, math.ceil(2.0 * length / edge))
        for k in range(steps):
            cells[filled, 0] = math.floor((points[i, 1] + k / steps * dy - bottom) / edge)
            cells[filled, 1] = math.floor((points[i, 0] + k / steps * dx - left) / edge)
            filled += 1
    return cells[:filled]
