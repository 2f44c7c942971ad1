"""Keeps the messages of a run while it goes on, and writes them as a CARMEN log and a ROS 2 bag.

A control period takes 1 kB and a scan 1.4 kB: 18 kB a simulated second, 130 MB in two hours.
"""

import shutil
from collections.abc import Iterator
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from envs.burger_constants import BASE_LINK_HEIGHT, IMU_POSITION, LIDAR_POSITION
from envs.burger_env import IMU_ROWS, ODOMETRY_ROWS
from evaluation.packed_map import PackedMap
from mapping.burger import LIDAR_BEAMS, LIDAR_POSE_BASE
from mapping.coarse_map import coarse_map
from mapping.geometry import Pose, compose, inverse
from mapping.grid import OccupancyGrid
from mapping.io.carmen_writer import write_carmen
from mapping.io.map_server import MapFile
from mapping.io.recorded_run import RecordedRun, StaticFrame
from mapping.io.ros_library import require_rosbags
from mapping.io.rosbag_writer import write_rosbag
from mapping.io.sensor_log_file import RECORDED_BAG, RECORDED_LOG
from mapping.messages import (
    IMU_COLUMNS,
    ODOMETRY_COLUMNS,
    Imu,
    LaserScan,
    Observation,
    Odometry,
)
from mapping.sensor_log import SensorLog

MAP_PERIOD = 5.0
"""The growing map is published every so often [s] (``map_update_interval`` of slam_toolbox and of
gmapping)."""

MAP_RESOLUTION = 0.05
"""In cells of this edge [m] (``resolution`` of slam_toolbox); the last map has the mapper's own."""

FRAMES = (
    StaticFrame(parent="base_footprint", child="base_link", position=(0.0, 0.0, BASE_LINK_HEIGHT)),
    StaticFrame(parent="base_link", child="base_scan", position=LIDAR_POSITION),
    StaticFrame(parent="base_link", child="imu_link", position=IMU_POSITION),
)
"""The Burger's sensors on the robot (turtlebot3_burger.urdf)."""

_PERIOD = np.dtype(
    [
        ("time", np.float64),
        ("command", np.float64, 2),
        ("map_from_odom", np.float64, 3),
        ("odometry", np.float64, (ODOMETRY_ROWS, len(ODOMETRY_COLUMNS))),
        ("imu", np.float64, (IMU_ROWS, len(IMU_COLUMNS))),
    ]
)
"""What is kept of a control period."""

_SCAN = np.dtype([("stamp", np.float64), ("ranges", np.float32, LIDAR_BEAMS)])
"""What is kept of a scan; all else is the same in each."""


class Recorder:
    """Notes every control period of a run; Ctrl-C leaves each one noted whole or not at all."""

    def __init__(self) -> None:
        """Make sure before the run that it can be written.

        Raises:
            TestbedError: The rosbags library is not installed.
        """
        require_rosbags()
        self._periods, self._scans = bytearray(), bytearray()
        self._newest_scan = -np.inf
        self._maps: list[PackedMap] = []

    def note(
        self,
        observation: Observation,
        action: NDArray[np.float32],
        pose_map: Pose,
        grid: OccupancyGrid,
    ) -> None:
        """Keep what one control period brought.

        Args:
            observation: The messages, as ``envs:TurtleBot3Burger-v0`` gives them.
            action: The command that answered them ``(2,)``.
            pose_map: Where the mapper then took the robot to be, at the newest odometry.
            grid: The map so far; kept in coarse cells every MAP_PERIOD.
        """
        time = float(observation["time"][0])
        if not self._maps or time >= self._maps[-1].time + MAP_PERIOD:
            self._maps.append(PackedMap.of(time, coarse_map(grid, MAP_RESOLUTION)))
        self._note_scan(observation)
        odometry = observation["odometry"]
        map_from_odom = compose(pose_map, inverse(odometry[-1, 1:4]))
        row = np.array((time, action, map_from_odom, odometry, observation["imu"]), dtype=_PERIOD)
        self._periods += row.tobytes()

    def run(self, grid: OccupancyGrid, source: str) -> RecordedRun:
        """All that was noted, with the last map at its own resolution."""
        periods = np.frombuffer(bytes(self._periods), dtype=_PERIOD)
        odometry, imu = periods["odometry"], periods["imu"]
        log = SensorLog(
            source=source,
            scans=[
                LaserScan(stamp=float(row["stamp"]), ranges=row["ranges"])
                for row in np.frombuffer(bytes(self._scans), dtype=_SCAN)
            ],
            odometry=Odometry.from_observation(
                {"odometry": odometry.reshape(-1, len(ODOMETRY_COLUMNS))}
            ),
            imu=Imu.from_observation({"imu": imu.reshape(-1, len(IMU_COLUMNS))}),
            lidar_pose_base=LIDAR_POSE_BASE,
        )
        return RecordedRun(
            log=log,
            commands=np.column_stack((periods["time"], periods["command"])),
            map_from_odom=np.column_stack((odometry[:, -1, 0], periods["map_from_odom"])),
            maps=self._maps_until(periods["time"].max(initial=0.0), grid),
            frames=FRAMES,
        )

    def write(self, folder: Path, grid: OccupancyGrid) -> None:
        """Write ``log.carmen`` and ``bag/`` into a folder, each whole or not at all.

        Args:
            folder: Where to write.
            grid: The map at the end of the run.

        Raises:
            TestbedError: They cannot be written.
        """
        run = self.run(grid, str(folder))
        write_carmen(folder / RECORDED_LOG, run.log)
        write_rosbag(folder / RECORDED_BAG, run)

    def _note_scan(self, observation: Observation) -> None:
        """Keep the observation's scan if it is a new one."""
        scan = LaserScan.from_observation(observation)
        if scan is not None and scan.stamp != self._newest_scan:
            self._newest_scan = scan.stamp
            self._scans += np.array((scan.stamp, scan.ranges), dtype=_SCAN).tobytes()

    def _maps_until(self, end: float, grid: OccupancyGrid) -> Iterator[tuple[float, MapFile]]:
        """The coarse maps, and at the end the whole one."""
        for drawn in self._maps:
            yield drawn.time, drawn.unpack()
        yield end, coarse_map(grid, grid.resolution)


def remove_recording(folder: Path) -> None:
    """Take an earlier run's recording away, which would pass for this one's."""
    (folder / RECORDED_LOG).unlink(missing_ok=True)
    shutil.rmtree(folder / RECORDED_BAG, ignore_errors=True)
