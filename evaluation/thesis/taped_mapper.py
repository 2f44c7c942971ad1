"""Keeps every message that a mapper is given, so that other mappers can map the same drive."""

from collections.abc import Sequence

from mapping.geometry import Pose
from mapping.grid import OccupancyGrid
from mapping.mapper import Mapper
from mapping.messages import Imu, LaserScan, Odometry
from mapping.pose_history import PoseHistory
from mapping.sensor_log import SensorLog


class TapedMapper:
    """A mapper that maps as the one inside it does, and remembers what it was told."""

    def __init__(self, mapper: Mapper) -> None:
        self._mapper = mapper
        self._scans: list[LaserScan] = []
        self._odometry: list[Odometry] = []
        self._imu: list[Imu] = []

    @property
    def grid(self) -> OccupancyGrid:
        """The map so far."""
        return self._mapper.grid

    @property
    def pose_map(self) -> Pose:
        """The newest pose in the map frame ``(3,)``."""
        return self._mapper.pose_map

    @property
    def updates(self) -> int:
        """How many scans went into the map."""
        return self._mapper.updates

    @property
    def scans_dropped(self) -> int:
        """How many new scans did not."""
        return self._mapper.scans_dropped

    @property
    def trajectory(self) -> PoseHistory:
        """Where base_footprint was at every scan, as believed now."""
        return self._mapper.trajectory

    def update(
        self, scan: LaserScan | None, odometry: Sequence[Odometry], imu: Sequence[Imu] = ()
    ) -> None:
        """Remember the messages, each scan once, and pass them on."""
        if scan is not None and (not self._scans or scan.stamp > self._scans[-1].stamp):
            self._scans.append(scan)
        self._odometry.extend(odometry)
        self._imu.extend(imu)
        self._mapper.update(scan, odometry, imu)

    def finish(self) -> None:
        """Do what the mapper put off."""
        self._mapper.finish()

    def log(self, source: str, lidar_pose_base: tuple[float, float, float]) -> SensorLog:
        """All messages so far, under the name of where they come from."""
        return SensorLog(
            source=source,
            scans=tuple(self._scans),
            odometry=tuple(self._odometry),
            imu=tuple(self._imu),
            lidar_pose_base=lidar_pose_base,
        )
