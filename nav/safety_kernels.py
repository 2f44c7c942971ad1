"""The safety layer's inner loop: moving the robot's outline along a twist among points."""

import numpy as np
from numba import njit
from numpy.typing import NDArray

from nav.cell_window_kernels import cells_around
from nav.outline import Rectangle

SHARES = (1.0, 0.75, 0.5, 0.25)
"""Shares of a twist that are tried, in turn."""
ROUNDING = 1e-4
"""A tenth of a millimetre nearer is no nearer [m]."""


@njit(cache=True)
def clear_share(
    scan_points: NDArray[np.float64],
    pose: NDArray[np.float64],
    linear: float,
    angular: float,
    outline: tuple[Rectangle, Rectangle],
    margin: float,
    horizon: float,
    steps: int,
    view: float,
    blind: tuple[float, float],
    log_odds: NDArray[np.float32],
    lattice: tuple[float, float, float],
    occupied_above: float,
) -> float:
    """The largest share of a twist that keeps ``margin`` to every point, or comes no closer.

    Points inside the outline as the robot stands are errors of the map or the pose: left out.

    Args:
        scan_points: ``(n, 2)`` in the map frame [m].
        pose: Of base_footprint in the map frame ``(3,)``.
        linear: Forward speed of the twist [m/s].
        angular: Turn rate of the twist [rad/s].
        outline: The rectangles that the robot consists of.
        margin: Distance to keep [m].
        horizon: How long the twist is followed [s].
        steps: Poses looked at along the way.
        view: Points farther from the robot are left out [m].
        blind: Where the lidar sits ahead of the axle and the radius it cannot see within [m]; what
            the map has there is added to the points.
        log_odds: The map.
        lattice: Its origin x, y and its resolution [m].
        occupied_above: Log odds above which a cell is occupied.
    """
    unseen = _too_near_to_see(pose, blind, log_odds, lattice, occupied_above)
    points = _around(np.concatenate((scan_points, unseen)), pose, view, outline)
    now = outline_distance(points, pose[0], pose[1], pose[2], outline)
    allowed = min(margin, now) - ROUNDING
    for share in SHARES:
        if _keeps(points, pose, share * linear, share * angular, outline, allowed, horizon, steps):
            return share
    return 0.0


@njit(cache=True)
def _keeps(
    points: NDArray[np.float64],
    pose: NDArray[np.float64],
    linear: float,
    angular: float,
    outline: tuple[Rectangle, Rectangle],
    allowed: float,
    horizon: float,
    steps: int,
) -> bool:
    """Whether a twist leaves at least ``allowed`` [m] to every point all along the horizon."""
    x, y, yaw = pose[0], pose[1], pose[2]
    dt = horizon / steps
    for _ in range(steps):
        middle = yaw + 0.5 * angular * dt
        x += linear * dt * np.cos(middle)
        y += linear * dt * np.sin(middle)
        yaw += angular * dt
        if outline_distance(points, x, y, yaw, outline) < allowed:
            return False
    return True


@njit(cache=True)
def _too_near_to_see(
    pose: NDArray[np.float64],
    blind: tuple[float, float],
    log_odds: NDArray[np.float32],
    lattice: tuple[float, float, float],
    occupied_above: float,
) -> NDArray[np.float64]:
    """Centres ``(n, 2)`` of the map's occupied cells within the lidar's blind radius [m]."""
    left, bottom, resolution = lattice
    x = pose[0] + blind[0] * np.cos(pose[2])
    y = pose[1] + blind[0] * np.sin(pose[2])
    radius = blind[1] + resolution
    first_row, end_row, first_column, end_column = cells_around(
        log_odds.shape, lattice, x, y, radius
    )
    points = np.empty(((end_row - first_row) * (end_column - first_column), 2))
    count = 0
    for i in range(first_row, end_row):
        for j in range(first_column, end_column):
            if log_odds[i, j] <= occupied_above:
                continue
            points[count, 0] = left + (j + 0.5) * resolution
            points[count, 1] = bottom + (i + 0.5) * resolution
            count += np.hypot(points[count, 0] - x, points[count, 1] - y) < radius
    return points[:count]


@njit(cache=True)
def _around(
    points: NDArray[np.float64],
    pose: NDArray[np.float64],
    view: float,
    outline: tuple[Rectangle, Rectangle],
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
    outline: tuple[Rectangle, Rectangle],
) -> float:
    """Distance [m] from the robot's outline to the nearest point; 0 inside, inf without points."""
    cos, sin = np.cos(yaw), np.sin(yaw)
    nearest = np.inf
    for k in range(len(points)):
        dx, dy = points[k, 0] - x, points[k, 1] - y
        ahead, left = cos * dx + sin * dy, -sin * dx + cos * dy
        for front, back, side in outline:
            out_x = max(ahead - front, -back - ahead, 0.0)
            out_y = max(abs(left) - side, 0.0)
            nearest = min(nearest, np.sqrt(out_x * out_x + out_y * out_y))
    return nearest
