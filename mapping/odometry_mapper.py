"""What mappers that trust the odometry share: the pose, and which scans are drawn."""

from abc import ABC, abstractmethod
from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike

from mapping.deskew import OdometryTrack
from mapping.errors import TestbedError
from mapping.geometry import Pose, compose
from mapping.grid import OccupancyGrid
from mapping.messages import Imu, LaserScan, Odometry
from mapping.pose_history import PoseHistory


class OdometryMapper(ABC):
    """Keeps the pose from odometry and lets a subclass draw each new scan once.

    A scan is dropped, and counted in ``scans_dropped``, when its stamp is older than the newest
    seen or not finite, when there is no odometry for it yet, when no beam of it tells anything,
    or when the subclass's rule refuses it. A scan seen before is not counted again.
    """

    def __init__(self, grid: OccupancyGrid, start_pose_map: ArrayLike) -> None:
        self.grid = grid
        self.start_pose_map = checked_pose("start_pose_map", start_pose_map)
        self.updates = 0
        self.scans_dropped = 0
        self.track = OdometryTrack()
        self.pose_map: Pose = self.start_pose_map
        """The newest pose in the map frame ``(3,)``; the start pose before any odometry."""
        self.trajectory = PoseHistory()
        self._newest_scan = -np.inf

    def update(
        self, scan: LaserScan | None, odometry: Sequence[Odometry], imu: Sequence[Imu] = ()
    ) -> None:
        """Take the messages of one control period; IMU readings are not used."""
        self.track.add(odometry)
        if self.track.newest is not None:
            self.pose_map = compose(self.start_pose_map, self.track.newest)
        if scan is None or scan.stamp == self._newest_scan:
            return
        if scan.stamp > self._newest_scan:
            self._newest_scan = scan.stamp
            pose_odom = self.track.poses_at([scan.stamp])
            if pose_odom is not None:
                self.trajectory.add(scan.stamp, compose(self.start_pose_map, pose_odom[0]))
            if self.draw(scan):
                self.updates += 1
                return
        self.scans_dropped += 1

    def finish(self) -> None:  # noqa: B027 - there is nothing to do
        """Nothing is put off."""

    @abstractmethod
    def draw(self, scan: LaserScan) -> bool:
        """Draw a new scan into the grid; False when it could not be used."""


def checked_pose(name: str, pose: ArrayLike) -> Pose:
    """A pose ``(3,)`` as float64, or one clear error."""
    try:
        checked = np.array(pose, dtype=np.float64)
    except (TypeError, ValueError):
        checked = np.empty(0)
    if checked.shape != (3,) or not np.all(np.isfinite(checked)):
        raise TestbedError(
            f"{name}: {pose!r}; must be three finite numbers x [m], y [m], yaw [rad]"
        )
    return checked
