"""Deskewing's inner loops: poses between odometry messages, and the beams shot from them."""

import math

import numpy as np
from numba import njit
from numpy.typing import NDArray


@njit(cache=True)
def interpolate(rows: NDArray[np.float64], stamps: NDArray[np.float64]) -> NDArray[np.float64]:
    """Poses ``(n, 3)`` at moments ``(n,)``, from rows ``(m, 6)`` of stamp, pose and twist.

    Between rows linearly, yaw the short way round; outside of them along the arc of the nearest
    row's twist, with the heading of the arc's middle.
    """
    count, last = len(stamps), len(rows) - 1
    poses = np.empty((count, 3))
    after = 1
    for i in range(count):
        stamp = stamps[i]
        if stamp <= rows[0, 0] or stamp >= rows[last, 0]:
            row = rows[0] if stamp <= rows[0, 0] else rows[last]
            gone, turned = row[4] * (stamp - row[0]), row[5] * (stamp - row[0])
            heading = row[3] + 0.5 * turned
            poses[i, 0] = row[1] + gone * math.cos(heading)
            poses[i, 1] = row[2] + gone * math.sin(heading)
            poses[i, 2] = _wrap(row[3] + turned)
            continue
        while rows[after, 0] < stamp:
            after += 1
        while rows[after - 1, 0] > stamp:
            after -= 1
        a, b = rows[after - 1], rows[after]
        share = (stamp - a[0]) / (b[0] - a[0])
        poses[i, 0] = a[1] + share * (b[1] - a[1])
        poses[i, 1] = a[2] + share * (b[2] - a[2])
        poses[i, 2] = _wrap(a[3] + share * _wrap(b[3] - a[3]))
    return poses


@njit(cache=True)
def aim(
    start: NDArray[np.float64],
    poses_odom: NDArray[np.float64],
    mount: tuple[float, float, float],
    angles: NDArray[np.float64],
    reach: NDArray[np.float64],
) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
    """Where each beam starts, where it points and where it ends in the map frame.

    Args:
        start: Pose of the odometry frame in the map ``(3,)``.
        poses_odom: Pose of base_footprint in the odometry frame at each beam's time ``(n, 3)``.
        mount: Pose of the sensor in base_footprint.
        angles: Direction of each beam in the sensor frame ``(n,)`` [rad].
        reach: Length of each beam ``(n,)`` [m].

    Returns:
        Origins, unit directions and ends, each ``(n, 2)``.
    """
    count = len(angles)
    origins, directions = np.empty((count, 2)), np.empty((count, 2))
    ends = np.empty((count, 2))
    cos_start, sin_start = math.cos(start[2]), math.sin(start[2])
    for i in range(count):
        x, y, yaw = poses_odom[i]
        cos, sin = math.cos(start[2] + yaw), math.sin(start[2] + yaw)
        origins[i, 0] = start[0] + cos_start * x - sin_start * y + cos * mount[0] - sin * mount[1]
        origins[i, 1] = start[1] + sin_start * x + cos_start * y + sin * mount[0] + cos * mount[1]
        angle = start[2] + yaw + mount[2] + angles[i]
        directions[i, 0], directions[i, 1] = math.cos(angle), math.sin(angle)
        ends[i, 0] = origins[i, 0] + reach[i] * directions[i, 0]
        ends[i, 1] = origins[i, 1] + reach[i] * directions[i, 1]
    return origins, directions, ends


@njit(cache=True)
def bounds(
    origins: NDArray[np.float64], ends: NDArray[np.float64]
) -> tuple[float, float, float, float]:
    """Left, right, bottom and top of points ``(n, 2)``, n >= 1, and as many others."""
    left = right = origins[0, 0]
    bottom = top = origins[0, 1]
    for points in (origins, ends):
        for i in range(len(points)):
            left, right = min(left, points[i, 0]), max(right, points[i, 0])
            bottom, top = min(bottom, points[i, 1]), max(top, points[i, 1])
    return left, right, bottom, top


@njit(cache=True)
def _wrap(angle: float) -> float:
    """The same angle in (-pi, pi]."""
    return math.pi - (math.pi - angle) % (2.0 * math.pi)
