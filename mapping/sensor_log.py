"""A recorded run: the sensor messages that a mapper takes, in the order in which they came."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from mapping.messages import Imu, LaserScan, Odometry

Period = tuple[LaserScan | None, Sequence[Odometry], Sequence[Imu]]
"""What a mapper takes at once: a scan, and the odometry and IMU messages up to its last beam."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class SensorLog:
    """The messages of a recorded run, whatever file format they came in."""

    source: str
    """The file it was read from, for error messages and pictures."""
    scans: Sequence[LaserScan]
    """Scans in the order of the file; a time that runs backwards is left for the mapper."""
    odometry: Sequence[Odometry]
    """Odometry messages in the order of the file."""
    imu: Sequence[Imu] = ()
    """IMU messages in the order of the file; none when the robot has no IMU."""
    lidar_pose_base: tuple[float, float, float] = (0.0, 0.0, 0.0)
    """The lidar's pose in base_footprint."""

    def periods(self) -> Iterator[Period]:
        """The messages as a mapper gets them, a scan at a time; what follows the last scan last.

        With a scan come the odometry and IMU messages up to the first one at or after its last
        beam, so that the poses of all of its beams can be told.
        """
        taken_odometry = taken_imu = 0
        for scan in self.scans:
            end = scan.stamp + max(len(scan.ranges) - 1, 0) * scan.time_increment
            next_odometry = _until(self.odometry, taken_odometry, end)
            next_imu = _until(self.imu, taken_imu, end)
            yield (
                scan,
                self.odometry[taken_odometry:next_odometry],
                self.imu[taken_imu:next_imu],
            )
            taken_odometry, taken_imu = next_odometry, next_imu
        if taken_odometry < len(self.odometry) or taken_imu < len(self.imu):
            yield None, self.odometry[taken_odometry:], self.imu[taken_imu:]


def _until(messages: Sequence[Odometry] | Sequence[Imu], first: int, end: float) -> int:
    """One past the first message from ``first`` on that is no older than ``end`` [s]."""
    if not np.isfinite(end):
        return first
    place = first
    while place < len(messages):
        place += 1
        if messages[place - 1].stamp >= end:
            break
    return place
