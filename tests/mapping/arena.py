"""A small world of which everything is known by arithmetic: a box of a room with round posts."""

from collections.abc import Callable, Iterator

import numpy as np
from numpy.typing import NDArray

from mapping.burger import LIDAR_POSE_BASE, LIDAR_RANGE_MAX
from mapping.geometry import compose
from mapping.messages import LaserScan, Odometry, Twist
from mapping.sensor_model import range_sigma
from mapping.truth import TruthMap, truth_map

HALF_WIDTH, HALF_HEIGHT = 2.0, 1.5
"""The room reaches this far from the origin [m]."""

POSTS = ((0.0, 0.5, 0.15), (-1.0, -0.6, 0.15))
"""Centre and radius of the posts [m]."""

Array = NDArray[np.float64]
PoseAt = Callable[[Array], Array]


def true_ranges(origins: Array, angles: Array) -> Array:
    """Distance [m] from each origin ``(n, 2)`` along each angle ``(n,)`` to what is there."""
    cos, sin = np.cos(angles), np.sin(angles)
    with np.errstate(divide="ignore"):
        to_x = (np.copysign(HALF_WIDTH, cos) - origins[:, 0]) / cos
        to_y = (np.copysign(HALF_HEIGHT, sin) - origins[:, 1]) / sin
    nearest = np.minimum(to_x, to_y)
    for x, y, radius in POSTS:
        dx, dy = x - origins[:, 0], y - origins[:, 1]
        along = dx * cos + dy * sin
        inside = radius**2 - (dx**2 + dy**2 - along**2)
        reach = np.where((inside > 0.0) & (along > 0.0), along - np.sqrt(np.abs(inside)), np.inf)
        nearest = np.minimum(nearest, reach)
    return nearest


def scan_at(stamp: float, pose_at: PoseAt, rng: np.random.Generator | None = None) -> LaserScan:
    """A rolling scan by a robot whose pose at times ``(n,)`` is known; noisy with a generator."""
    scan = LaserScan(stamp=stamp, ranges=np.zeros(360, dtype=np.float32))
    sensors = compose(pose_at(scan.beam_stamps), LIDAR_POSE_BASE)
    ranges = true_ranges(sensors[:, :2], sensors[:, 2] + scan.angles)
    if rng is not None:
        ranges = ranges + rng.normal(0.0, range_sigma(ranges))
    ranges[ranges > LIDAR_RANGE_MAX] = np.inf
    return LaserScan(stamp=stamp, ranges=ranges.astype(np.float32))


def odometry_at(stamp: float, pose_at: PoseAt) -> Odometry:
    """True odometry; the twist by differences over a millisecond."""
    before, after = pose_at(np.array([stamp - 5e-4, stamp + 5e-4]))
    step = after - before
    return Odometry(
        stamp=stamp,
        pose_odom=pose_at(np.array([stamp]))[0],
        twist=Twist(linear_x=float(np.hypot(*step[:2])) / 1e-3, angular_z=float(step[2]) / 1e-3),
    )


def drive(
    pose_at: PoseAt, seconds: float, rng: np.random.Generator | None = None
) -> Iterator[tuple[LaserScan | None, list[Odometry]]]:
    """What a mapper is given in each control period of 0.1 s: odometry at 30 Hz, scans at 5 Hz."""
    for period in range(round(seconds / 0.1)):
        end = 0.1 * (period + 1)
        odometry = [odometry_at(end - 0.1 + k / 30.0, pose_at) for k in range(3)]
        scan = scan_at(end - 0.2, pose_at, rng) if period % 2 else None
        yield scan, odometry


def circling(radius: float = 1.1, speed: float = 0.2) -> PoseAt:
    """Around both posts, on an ellipse, heading along it."""

    def pose_at(stamps: Array) -> Array:
        turn = speed / radius * stamps
        x, y = 1.45 * np.cos(turn), radius * np.sin(turn)
        yaw = np.unwrap(np.arctan2(radius * np.cos(turn), -1.45 * np.sin(turn)))
        return np.column_stack((x, y, yaw))

    return pose_at


def standing(x: float = 0.0, y: float = 0.0, yaw: float = 0.0) -> PoseAt:
    return lambda stamps: np.tile([x, y, yaw], (len(stamps), 1)).astype(np.float64)


def arena_truth(resolution: float = 0.01) -> TruthMap:
    """The truth of the arena, with 10 cm of wall around."""
    left, bottom = -HALF_WIDTH - 0.1, -HALF_HEIGHT - 0.1
    shape = round(-2 * bottom / resolution), round(-2 * left / resolution)
    y, x = (np.indices(shape) + 0.5) * resolution + np.array([bottom, left])[:, None, None]
    occupied = (np.abs(x) >= HALF_WIDTH) | (np.abs(y) >= HALF_HEIGHT)
    for post_x, post_y, radius in POSTS:
        occupied |= np.hypot(x - post_x, y - post_y) <= radius
    return truth_map(occupied, resolution=resolution, origin=(left, bottom), start=(1.45, 0.0))
