"""Keeps what an episode shows of the robot's way: the truth, the mapper's belief, the odometry."""

import numpy as np
from numpy.typing import NDArray

from mapping.geometry import Pose
from mapping.pose_history import PoseHistory


class Track:
    """Where the robot was, believed to be and said to be, a row per control period."""

    def __init__(self) -> None:
        self._map, self._world, self._odom = PoseHistory(), PoseHistory(), PoseHistory()

    def __len__(self) -> int:
        return len(self._odom)

    def note(self, stamp: float, pose_map: Pose, pose_world: Pose, pose_odom: Pose) -> None:
        """Add one row; it counts when its last part is in, so Ctrl-C may come at any moment."""
        self._map.add(stamp, pose_map)
        self._world.add(stamp, pose_world)
        self._odom.add(stamp, pose_odom)

    @property
    def stamps(self) -> NDArray[np.float64]:
        """Times ``(n,)`` [s]."""
        return self._odom.stamps

    @property
    def pose_map(self) -> Pose:
        """What the mapper believed at the time, in the map frame ``(n, 3)``."""
        return self._map.poses[: len(self)]

    @property
    def pose_world(self) -> Pose:
        """The truth, in the world frame ``(n, 3)``."""
        return self._world.poses[: len(self)]

    @property
    def pose_odom(self) -> Pose:
        """What odometry said, in the frame where the robot started ``(n, 3)``."""
        return self._odom.poses
