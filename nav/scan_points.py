"""Turns the newest scan into obstacle points in the map frame, each from its beam's own pose."""

from collections import deque

import numpy as np
from numpy.typing import NDArray

from mapping.burger import LIDAR_POSE_BASE
from mapping.deskew_kernels import aim, interpolate
from mapping.geometry import Pose, compose, transform_points
from mapping.messages import LaserScan

IN_THE_MAP = np.zeros(3)
"""The poses are in the map frame already."""

REMEMBERED_POSES = 8
"""Poses kept, 0.1 s apart: a scan is at most 0.3 s old when it arrives."""


class ScanPoints:
    """Keeps a short history of poses and places beams of a rolling scan by it."""

    def __init__(self) -> None:
        self.points: NDArray[np.float64] = np.zeros((0, 2))
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
            self.points = self._place(scan, reach)
        return is_new

    def follow_jump(self, jump: Pose) -> None:
        """Move what is remembered into a map drawn anew, in which the old one lies at ``jump``."""
        self.points = transform_points(jump, self.points)
        for i, (time, *pose, speed, rate) in enumerate(self._poses):
            self._poses[i] = (time, *compose(jump, pose).tolist(), speed, rate)

    def _remember(self, pose: Pose) -> None:
        x, y, yaw = pose.tolist()
        self._poses.append((self.time, x, y, yaw, 0.0, 0.0))

    def _place(self, scan: LaserScan, reach: float) -> NDArray[np.float64]:
        good = (scan.ranges >= scan.range_min) & (scan.ranges <= min(reach, scan.range_max))
        poses = interpolate(np.array(self._poses), scan.beam_stamps[good])
        ranges = scan.ranges[good].astype(np.float64)
        points: NDArray[np.float64]
        _, _, points = aim(IN_THE_MAP, poses, LIDAR_POSE_BASE, scan.angles[good], ranges)
        return points
