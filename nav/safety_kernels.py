"""The safety layer's inner loop: moving the robot's outline along a twist among points."""

import numpy as np
from numba import njit
from numpy.typing import NDArray

SHARES = (1.0, 0.75, 0.5, 0.25)


@njit(cache=True)
def clear_share(
    points: NDArray[np.float64],
    pose: NDArray[np.float64],
    linear: float,
    angular: float,
    outline: tuple[float, float, float],
    margin: float,
    horizon: float,
    steps: int,
    view: float,
) -> float:
    """The largest share of a twist that keeps ``margin`` to every point, or comes no closer.

    Points inside the outline as the robot stands are errors of the map or the pose: left out.
    """
    near = _around(points, pose, view, outline)
    now = outline_distance(near, pose[0], pose[1], pose[2], outline)
    allowed = min(margin, now)
    for share in SHARES:
        x, y, yaw = pose[0], pose[1], pose[2]
        dt = horizon / steps
        clear = True
        for _ in range(steps):
            middle = yaw + 0.5 * share * angular * dt
            x += share * linear * dt * np.cos(middle)
            y += share * linear * dt * np.sin(middle)
            yaw += share * angular * dt
            if outline_distance(near, x, y, yaw, outline) < allowed - 1e-4:
                clear = False
                break
        if clear:
            return share
    return 0.0


@njit(cache=True)
def _around(
    points: NDArray[np.float64],
    pose: NDArray[np.float64],
    view: float,
    outline: tuple[float, float, float],
) -> NDArray[np.float64]:
    """The points nearer than ``view`` that do not lie inside the robot."""
    keep = np.zeros(len(points), dtype=np.bool_)
    for k in range(len(points)):
        if np.hypot(points[k, 0] - pose[0], points[k, 1] - pose[1]) < view:
            gap = outline_distance(points[k : k + 1], pose[0], pose[1], pose[2], outline)
            keep[k] = gap > 0.0
    return points[keep]


@njit(cache=True)
def outline_distance(
    points: NDArray[np.float64],
    x: float,
    y: float,
    yaw: float,
    outline: tuple[float, float, float],
) -> float:
    """Distance [m] from the robot's outline (front, back, side) to the nearest point; 0 inside."""
    front, back, side = outline
    cos, sin = np.cos(yaw), np.sin(yaw)
    nearest = np.inf
    for k in range(len(points)):
        dx, dy = points[k, 0] - x, points[k, 1] - y
        ahead, left = cos * dx + sin * dy, -sin * dx + cos * dy
        out_x = max(ahead - front, -back - ahead, 0.0)
        out_y = max(abs(left) - side, 0.0)
        nearest = min(nearest, np.sqrt(out_x * out_x + out_y * out_y))
    return nearest
