"""Turns the newest scan into obstacle points in the map frame, each from its beam's own pose."""

from collections import deque

import numpy as np
from numpy.typing import NDArray

from mapping.burger import LIDAR_POSE_BASE
from mapping.geometry import Pose
from mapping.messages import LaserScan

REMEMBERED_POSES = 8
"""Poses kept, 0.1 s apart: a scan is at most 0.3 s old when it arrives."""


class ScanPoints:
    """Keeps a short history of poses and places beams of a rolling scan by it."""

    def __init__(self) -> None:
        self.points: NDArray[np.float64] = np.zeros((0, 2))
        self.time = 0.0
        self._stamp = -1.0
        self._poses: deque[tuple[float, float, float, float]] = deque(maxlen=REMEMBERED_POSES)

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

    def _remember(self, pose: Pose) -> None:
        yaw = float(pose[2])
        if self._poses:
            last = self._poses[-1][3]
            yaw = last + float(np.pi - np.mod(np.pi - (yaw - last), 2.0 * np.pi))
        self._poses.append((self.time, float(pose[0]), float(pose[1]), yaw))

    def _place(self, scan: LaserScan, reach: float) -> NDArray[np.float64]:
        ranges = scan.ranges.astype(np.float64)
        good = (ranges >= scan.range_min) & (ranges <= min(reach, scan.range_max))
        stamps, ranges, angles = scan.beam_stamps[good], ranges[good], scan.angles[good]
        times, xs, ys, yaws = np.array(self._poses).T
        yaw = np.interp(stamps, times, yaws)
        mount_x, mount_y, mount_yaw = LIDAR_POSE_BASE
        cos, sin = np.cos(yaw), np.sin(yaw)
        beam = yaw + mount_yaw + angles
        x = np.interp(stamps, times, xs) + cos * mount_x - sin * mount_y + ranges * np.cos(beam)
        y = np.interp(stamps, times, ys) + sin * mount_x + cos * mount_y + ranges * np.sin(beam)
        return np.column_stack((x, y))
