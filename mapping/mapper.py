"""What every mapper does: take the messages of one control period, keep a pose and a grid."""

from collections.abc import Sequence
from typing import Protocol

from mapping.geometry import Pose
from mapping.grid import OccupancyGrid
from mapping.messages import Imu, LaserScan, Odometry
from mapping.pose_history import PoseHistory


class Mapper(Protocol):
    """Maps while it is driven around; sees sensor messages only, never the truth."""

    @property
    def grid(self) -> OccupancyGrid:
        """The map so far.

        Users of it look again at what lies within the lidar's reach of the robot, and at all of it
        when its ``redraws`` has grown: a mapper that draws the map anew must count that up.
        """

    @property
    def pose_map(self) -> Pose:
        """The newest pose of base_footprint in the map frame ``(3,)``."""

    @property
    def updates(self) -> int:
        """How many scans went into the map."""

    @property
    def scans_dropped(self) -> int:
        """How many new scans did not: gated, unusable, or without a pose for their time."""

    @property
    def trajectory(self) -> PoseHistory:
        """Where base_footprint was at the first beam of every scan with a pose, as believed now.

        A mapper that corrects the past gives corrected poses.
        """

    def update(
        self, scan: LaserScan | None, odometry: Sequence[Odometry], imu: Sequence[Imu] = ()
    ) -> None:
        """Take the messages of one control period.

        Args:
            scan: The newest whole scan, or None when no new one arrived. A scan whose stamp was
                seen before is used only once.
            odometry: Odometry messages since the last call, oldest first; may be empty.
            imu: IMU messages since the last call, oldest first; may be empty.
        """

    def finish(self) -> None:
        """Do now what was put off, as the last correction and drawing the map anew."""
