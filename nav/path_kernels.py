"""The path follower's inner loops: where on the path the robot is, and which point lies ahead."""

import numpy as np
from numba import njit
from numpy.typing import NDArray

SEARCHED_POINTS = 20
"""How many path points ahead may be the nearest, 1 m at 5 cm: a path that comes back past the robot
must not be joined at its far end."""


@njit(cache=True)
def advance(
    path: NDArray[np.float64],
    along: NDArray[np.float64],
    progress: int,
    pose: NDArray[np.float64],
) -> tuple[int, float]:
    """The nearest path point not before ``progress``, and the way left from the pose [m]."""
    best, nearest = progress, np.inf
    for k in range(progress, min(progress + SEARCHED_POINTS, len(path))):
        gap = np.hypot(path[k, 0] - pose[0], path[k, 1] - pose[1])
        if gap < nearest:
            best, nearest = k, gap
    return best, nearest + along[-1] - along[best]


@njit(cache=True)
def point_ahead(
    path: NDArray[np.float64], along: NDArray[np.float64], progress: int, distance: float
) -> tuple[float, float]:
    """The point of the path ``distance`` [m] beyond point ``progress``, or its end."""
    wanted = along[progress] + distance
    for k in range(progress, len(path) - 1):
        if along[k + 1] >= wanted:
            share = (wanted - along[k]) / (along[k + 1] - along[k])
            x = path[k, 0] + share * (path[k + 1, 0] - path[k, 0])
            y = path[k, 1] + share * (path[k + 1, 1] - path[k, 1])
            return x, y
    return path[-1, 0], path[-1, 1]


@njit(cache=True)
def is_near(points: NDArray[np.float64], path: NDArray[np.float64], distance: float) -> bool:
    """Whether any of the points ``(n, 2)`` lies nearer than ``distance`` [m] to a path point."""
    for i in range(len(points)):
        for k in range(len(path)):
            dx, dy = points[i, 0] - path[k, 0], points[i, 1] - path[k, 1]
            if dx * dx + dy * dy < distance * distance:
                return True
    return False
