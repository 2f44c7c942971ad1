"""Kernel that scores many poses against one scan."""

import math

import numpy as np
from numba import njit
from numpy.typing import NDArray


@njit(cache=True)
def score_poses(
    field: NDArray[np.float32],
    nothing: np.float32,
    origin: tuple[float, float],
    resolution: float,
    poses: NDArray[np.float64],
    points: NDArray[np.float64],
) -> NDArray[np.float64]:
    """Sum of the field over the readings, from every pose ``(n,)``.

    Args:
        field: A reading's log likelihood ``[row = y, col = x]``.
        nothing: The same off the map.
        origin: Lower-left corner of cell (0, 0) [m].
        resolution: Edge of a cell [m].
        poses: Poses ``(n, 3)``.
        points: Readings in the frame of the pose ``(m, 2)`` [m].
    """
    rows, columns = field.shape
    scores = np.empty(len(poses))
    for i in range(len(poses)):
        cos, sin = math.cos(poses[i, 2]) / resolution, math.sin(poses[i, 2]) / resolution
        x = (poses[i, 0] - origin[0]) / resolution
        y = (poses[i, 1] - origin[1]) / resolution
        total = 0.0
        for j in range(len(points)):
            column = math.floor(x + cos * points[j, 0] - sin * points[j, 1])
            row = math.floor(y + sin * points[j, 0] + cos * points[j, 1])
            if 0 <= row < rows and 0 <= column < columns:
                total += float(field[row, column])
            else:
                total += float(nothing)
        scores[i] = total
    return scores
