"""Scans for the navigation tests: walls and round things seen by a rolling lidar that moves."""

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from mapping.burger import LIDAR_BEAMS, LIDAR_POSE_BASE, LIDAR_SCAN_TIME
from mapping.geometry import Pose, compose, wrap_to_pi
from mapping.messages import LaserScan
from nav.scan_points import ScanPoints, ScanView

PERIOD = 0.1
"""Control period [s]: a scan comes every other one."""

Way = Callable[[float], NDArray[np.float64]]
"""Where something round is at a time [s], ``(2,)`` [m]."""


@dataclass
class Room:
    """What stands and what walks."""

    walls: NDArray[np.float64] = field(default_factory=lambda: np.zeros((0, 4)))
    """Segments ``(n, 4)`` from x, y to x, y [m]."""
    posts: NDArray[np.float64] = field(default_factory=lambda: np.zeros((0, 3)))
    """Round things that stand ``(m, 3)``: x, y, radius [m]."""
    legs: tuple[Way, ...] = ()
    """Round things that move."""
    leg_radius: float = 0.06

    def clearance(self, place: NDArray[np.float64]) -> float:
        """Distance to the nearest thing that stands [m]."""
        a, b = self.walls[:, :2], self.walls[:, 2:]
        along = b - a
        share = np.sum((place - a) * along, axis=1) / np.sum(along**2, axis=1)
        nearest = a + np.clip(share, 0.0, 1.0)[:, None] * along
        gaps = [
            np.hypot(*(nearest - place).T),
            np.hypot(*(self.posts[:, :2] - place).T) - self.posts[:, 2],
        ]
        return float(np.concatenate(gaps).min(initial=np.inf))


def box(x: float, y: float, width: float, depth: float) -> NDArray[np.float64]:
    """The four sides ``(4, 4)`` of a box from its lower left corner [m]."""
    corners = np.array([[x, y], [x + width, y], [x + width, y + depth], [x, y + depth]])
    return np.hstack((corners, np.roll(corners, -1, axis=0)))


def scan_of(
    room: Room, stamp: float, poses: Pose, rng: np.random.Generator | None = None
) -> LaserScan:
    """A scan whose beams are taken from poses ``(360, 3)`` of base_footprint, each at its time.

    With a generator it has the noise of the LDS-01's datasheet: three sigmas are 10 mm below 0.5 m
    and 3.5 % above.
    """
    eyes = compose(poses, np.array(LIDAR_POSE_BASE))
    angles = eyes[:, 2] + np.radians(np.arange(LIDAR_BEAMS))
    directions = np.column_stack((np.cos(angles), np.sin(angles)))
    times = stamp + np.arange(LIDAR_BEAMS) * LIDAR_SCAN_TIME / LIDAR_BEAMS
    true = np.minimum(
        _to_walls(room.walls, eyes[:, :2], directions),
        _to_discs(*_discs(room, times), eyes[:, :2], directions),
    )
    ranges = true
    if rng is not None:
        sigma = np.where(true < 0.5, 0.010, 0.035 * np.where(np.isfinite(true), true, 0.0)) / 3.0
        ranges = np.round(true + sigma * rng.standard_normal(LIDAR_BEAMS), 3)
    ranges = np.where(ranges > 3.5, np.inf, np.where(ranges < 0.12, 0.0, ranges))
    return LaserScan(stamp=stamp, ranges=ranges.astype(np.float32))


def _to_walls(
    walls: NDArray[np.float64], eyes: NDArray[np.float64], directions: NDArray[np.float64]
) -> NDArray[np.float64]:
    """How far each ray ``(k,)`` goes to the nearest segment [m]."""
    offset = walls[None, :, :2] - eyes[:, None]
    along = walls[:, 2:] - walls[:, :2]
    across = _cross(directions[:, None], along[None])
    with np.errstate(divide="ignore", invalid="ignore"):
        distance = _cross(offset, along[None]) / across
        share = _cross(offset, directions[:, None]) / across
    met = (share >= 0.0) & (share <= 1.0) & (distance > 0.0)
    return np.where(met, distance, np.inf).min(axis=1, initial=np.inf)


def _discs(
    room: Room, times: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Middles ``(k, m, 2)`` of all round things at each beam's time, and their radii ``(m,)``."""
    standing = np.broadcast_to(room.posts[:, :2], (len(times), len(room.posts), 2))
    walking = [np.array([way(time) for time in times])[:, None] for way in room.legs]
    radii = np.concatenate((room.posts[:, 2], np.full(len(room.legs), room.leg_radius)))
    return np.concatenate([standing, *walking], axis=1), radii


def _to_discs(
    middles: NDArray[np.float64],
    radii: NDArray[np.float64],
    eyes: NDArray[np.float64],
    directions: NDArray[np.float64],
) -> NDArray[np.float64]:
    """How far each ray goes to the nearest disc [m]."""
    offset = middles - eyes[:, None]
    ahead = np.sum(offset * directions[:, None], axis=2)
    half = radii**2 - np.sum(offset**2, axis=2) + ahead**2
    distance = ahead - np.sqrt(np.maximum(half, 0.0))
    return np.where((half > 0.0) & (distance > 0.0), distance, np.inf).min(axis=1, initial=np.inf)


def _cross(a: NDArray[np.float64], b: NDArray[np.float64]) -> NDArray[np.float64]:
    return np.asarray(a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0])


def views_of(
    room: Room,
    poses: Pose,
    rng: np.random.Generator | None = None,
    pose_error: tuple[float, float] = (0.0, 0.0),
) -> list[ScanView]:
    """What a robot sees that is at poses ``(n, 3)``, one a control period, in their frame.

    Args:
        room: What there is to see.
        poses: True poses of base_footprint.
        rng: Source of the lidar's noise and of the errors; None for neither.
        pose_error: Most that the poses it believes in are wrong by, along x and y [m] and in yaw
            [rad]: drawn anew for every scan, evenly, and fading from one to the next.
    """
    points = ScanPoints()
    believed = poses + _errors(len(poses), rng, pose_error)
    turned = np.column_stack((poses[:, :2], np.unwrap(poses[:, 2])))
    ticks = PERIOD * np.arange(len(poses))
    views = []
    for k in range(len(poses)):
        scan = None
        if k >= 2 and k % 2 == 0:
            stamp = ticks[k - 2]
            moments = stamp + np.arange(LIDAR_BEAMS) * LIDAR_SCAN_TIME / LIDAR_BEAMS
            at = np.column_stack([np.interp(moments, ticks, column) for column in turned.T])
            scan = scan_of(room, float(stamp), at, rng)
        pose = believed[k].copy()
        pose[2] = wrap_to_pi(pose[2])
        if points.update(scan, pose, PERIOD if k else 0.0, reach=1.2) and points.view is not None:
            views.append(points.view)
    return views


def _errors(
    count: int, rng: np.random.Generator | None, pose_error: tuple[float, float]
) -> NDArray[np.float64]:
    """Errors of poses ``(count, 3)``, drawn for every other one."""
    if rng is None or pose_error == (0.0, 0.0):
        return np.zeros((count, 3))
    length, angle = pose_error
    drawn = rng.uniform(-1.0, 1.0, (count // 2 + 2, 3)) * (length, length, angle)
    moments = np.arange(count) / 2.0
    return np.column_stack([np.interp(moments, np.arange(len(drawn)), row) for row in drawn.T])
