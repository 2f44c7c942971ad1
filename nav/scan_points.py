"""Turns the newest scan into points in the map frame, each from its beam's own pose."""

import math
from collections import deque
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mapping.burger import LIDAR_POSE_BASE
from mapping.deskew_kernels import aim, interpolate
from mapping.geometry import Pose, compose, transform_points, wrap_to_pi
from mapping.messages import LaserScan

IN_THE_MAP = np.zeros(3)
"""The poses are in the map frame already."""

REMEMBERED_POSES = 8
"""Poses kept, 0.1 s apart: a scan is at most 0.3 s old when it arrives."""


@dataclass(frozen=True, slots=True, kw_only=True)
class ScanView:
    """What a whole scan saw, in the map frame, with one place for all its beams."""

    stamp: float
    """Time of its middle beam [s]."""
    points: NDArray[np.float64]
    """Where its beams met something ``(n, 2)`` [m], each from its own pose, in their order."""
    beams: NDArray[np.int64]
    """Which beams these are ``(n,)``."""
    origin: NDArray[np.float64]
    """Where the sensor was at its middle beam ``(2,)`` [m]."""
    bearing: float
    """Direction of its first beam [rad]."""
    increment: float
    """Angle from beam to beam [rad], with what the robot turned meanwhile."""
    ranges: NDArray[np.float64]
    """How far its beams went ``(k,)`` [m]: inf where they met nothing, NaN where they failed."""


class ScanPoints:
    """Keeps a short history of poses and places beams of a rolling scan by it."""

    def __init__(self) -> None:
        self.points: NDArray[np.float64] = np.zeros((0, 2))
        """What the newest scan met within reach ``(n, 2)`` [m]."""
        self.view: ScanView | None = None
        """All that it saw; None before the first scan, and of a scan of fewer than two beams."""
        self.time = 0.0
        self._stamp = -1.0
        self._poses: deque[tuple[float, ...]] = deque(maxlen=REMEMBERED_POSES)

    def update(self, scan: LaserScan | None, pose: Pose, period: float, reach: float) -> bool:
        """Take the pose of this control period and, if it is new, the scan.

        Args:
            scan: Newest scan; one whose stamp was seen before changes nothing.
            pose: Pose of base_footprint in the map frame now ``(3,)``.
            period: Time since the last call [s].
            reach: Returns farther than this are left out [m].

        Returns:
            Whether the scan was new.
        """
        is_new = scan is not None and scan.stamp != self._stamp
        self.time += period
        if is_new and scan is not None:
            self.time = max(self.time, scan.stamp + scan.scan_time)
        self._remember(pose)
        if is_new and scan is not None:
            self._stamp = scan.stamp
            self._place(scan, reach)
        return is_new

    def follow_jump(self, jump: Pose) -> None:
        """Move what is remembered into a map drawn anew, in which the old one lies at ``jump``."""
        self.points = transform_points(jump, self.points)
        for i, (time, *pose, speed, rate) in enumerate(self._poses):
            self._poses[i] = (time, *compose(jump, pose).tolist(), speed, rate)

    def _remember(self, pose: Pose) -> None:
        x, y, yaw = pose.tolist()
        self._poses.append((self.time, x, y, yaw, 0.0, 0.0))

    def _place(self, scan: LaserScan, reach: float) -> None:
        """Place the beams of a scan by the poses remembered."""
        met = (scan.ranges >= scan.range_min) & (scan.ranges <= scan.range_max)
        beams = np.flatnonzero(met)
        poses = interpolate(np.array(self._poses), scan.beam_stamps)
        ranges = scan.ranges.astype(np.float64)
        points: NDArray[np.float64]
        _, _, points = aim(
            IN_THE_MAP, poses[beams], LIDAR_POSE_BASE, scan.angles[beams], ranges[beams]
        )
        self.points = points[ranges[beams] <= reach]
        self.view = _view_of(scan, poses, points, beams) if len(poses) > 1 else None


def _view_of(
    scan: LaserScan, poses: Pose, points: NDArray[np.float64], beams: NDArray[np.int64]
) -> ScanView:
    """The view of a scan of two beams or more, taken at poses ``(k, 3)``."""
    middle, last = len(poses) // 2, len(poses) - 1
    turned = float(wrap_to_pi(poses[last, 2] - poses[0, 2]))
    ranges = scan.ranges.astype(np.float64)
    ranges[~(ranges >= scan.range_min)] = math.nan
    return ScanView(
        stamp=float(scan.beam_stamps[middle]),
        points=points,
        beams=beams,
        origin=compose(poses[middle], np.array(LIDAR_POSE_BASE))[:2],
        bearing=float(poses[0, 2]) + LIDAR_POSE_BASE[2] + scan.angle_min,
        increment=turned / last + scan.angle_increment,
        ranges=ranges,
    )
