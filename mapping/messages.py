"""The sensor messages, with the field names of ROS, and how they lie in an observation.

An observation of ``envs:TurtleBot3Burger-v0`` is a dict of arrays; its rows become messages here,
so that mappers and navigators see the same types from the simulator and from a recorded log.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import isfinite
from typing import Any, overload

import numpy as np
from numpy.typing import NDArray

from mapping.burger import LIDAR_BEAMS, LIDAR_RANGE_MAX, LIDAR_RANGE_MIN, LIDAR_SCAN_TIME
from mapping.geometry import Pose

ODOMETRY_COLUMNS = ("stamp", "x", "y", "yaw", "linear_x", "angular_z")
IMU_COLUMNS = ("stamp", "qx", "qy", "qz", "qw", "wx", "wy", "wz", "ax", "ay", "az")

_TURN_RATE_COLUMNS = (IMU_COLUMNS.index("stamp"), IMU_COLUMNS.index("wz"))

_ACCELERATION_COLUMNS = tuple(IMU_COLUMNS.index(name) for name in ("stamp", "ax", "ay"))

Observation = Mapping[str, NDArray[Any]]


@dataclass(frozen=True, slots=True, kw_only=True)
class Twist:
    """A velocity in the robot's own frame, geometry_msgs/Twist of a differential drive."""

    linear_x: float = 0.0
    """Forward speed [m/s]."""
    angular_z: float = 0.0
    """Turn rate [rad/s], counter-clockwise positive."""


@dataclass(frozen=True, slots=True, kw_only=True)
class LaserScan:
    """One turn of a lidar, sensor_msgs/LaserScan.

    The scan is rolling: beam ``i`` points to ``angle_min + i * angle_increment`` in the sensor
    frame and is taken at ``stamp + i * time_increment``, from where the sensor then was.

    A range is a distance [m], or ``+inf``: nothing within ``range_max`` (the only value that
    clears space to the full range), or ``0.0``, NaN, ``-inf``: the beam failed and tells nothing
    (REP-117, and the LDS-01 driver's 0.0).
    """

    stamp: float
    """Time of the first beam [s]."""
    ranges: NDArray[np.float32]
    """Ranges ``(n,)`` [m]."""
    angle_min: float = 0.0
    angle_increment: float = 2.0 * np.pi / LIDAR_BEAMS
    time_increment: float = LIDAR_SCAN_TIME / LIDAR_BEAMS
    scan_time: float = LIDAR_SCAN_TIME
    range_min: float = LIDAR_RANGE_MIN
    range_max: float = LIDAR_RANGE_MAX

    @property
    def angle_max(self) -> float:
        """Direction of the last beam [rad]."""
        return self.angle_min + (len(self.ranges) - 1) * self.angle_increment

    @property
    def angles(self) -> NDArray[np.float64]:
        """Direction of every beam ``(n,)`` in the sensor frame [rad]."""
        beams = np.arange(len(self.ranges), dtype=np.float64)
        return self.angle_min + beams * self.angle_increment

    @property
    def beam_stamps(self) -> NDArray[np.float64]:
        """Time of every beam ``(n,)`` [s]."""
        beams = np.arange(len(self.ranges), dtype=np.float64)
        return self.stamp + beams * self.time_increment

    @classmethod
    def from_observation(cls, observation: Observation) -> "LaserScan | None":
        """The newest whole scan; a range at ``range_max`` becomes ``+inf`` again.

        Returns None when no scan is complete yet (``scan_stamp`` is negative).
        """
        stamp = float(observation["scan_stamp"][0])
        if stamp < 0.0:
            return None
        ranges = np.array(observation["ranges"], dtype=np.float32)
        ranges[ranges >= np.float32(LIDAR_RANGE_MAX)] = np.inf
        return cls(stamp=stamp, ranges=ranges)


FARTHEST_ODOMETRY = 1e8
"""Odometry farther from where it started than this [m] tells nothing: its numbers have steps of
more than 10 nm, and what is left of small motions after a jump that far would be noise."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Odometry:
    """What the wheel encoders say, nav_msgs/Odometry in the plane."""

    stamp: float
    """Time [s]."""
    pose_odom: Pose
    """Pose of base_footprint ``(3,)`` in the frame where the robot started."""
    twist: Twist
    """Velocity in base_footprint."""

    @property
    def row(self) -> tuple[float, float, float, float, float, float]:
        """The message as numbers, in the order of ODOMETRY_COLUMNS."""
        x, y, yaw = self.pose_odom.tolist()
        return self.stamp, x, y, yaw, self.twist.linear_x, self.twist.angular_z

    @property
    def is_usable(self) -> bool:
        """Whether every number is finite, and the place no farther than FARTHEST_ODOMETRY."""
        row = self.row
        far = FARTHEST_ODOMETRY
        return all(map(isfinite, row)) and abs(row[1]) <= far and abs(row[2]) <= far

    @classmethod
    def from_observation(cls, observation: Observation) -> "Sequence[Odometry]":
        """Every odometry message that arrived in the last control period, oldest first."""
        return [
            cls(stamp=row[0], pose_odom=pose, twist=Twist(linear_x=row[4], angular_z=row[5]))
            for row, pose in zip(
                observation["odometry"].tolist(), observation["odometry"][:, 1:4], strict=True
            )
        ]


@dataclass(frozen=True, slots=True, kw_only=True)
class Imu:
    """What the inertial unit says, sensor_msgs/Imu."""

    stamp: float
    """Time [s]."""
    orientation: NDArray[np.float64]
    """Quaternion ``(4,)`` x, y, z, w as ROS orders it; its yaw drifts (no magnetometer)."""
    angular_velocity: NDArray[np.float64]
    """Gyroscope ``(3,)`` [rad/s] about x, y, z of imu_link."""
    linear_acceleration: NDArray[np.float64]
    """Accelerometer ``(3,)`` [m/s2]; at rest it reads +9.81 along z."""

    @classmethod
    def from_observation(cls, observation: Observation) -> "Sequence[Imu]":
        """Every IMU message that arrived in the last control period, oldest first.

        Each is made when it is asked for: a mapper that uses none pays for none.
        """
        return _ImuRows(observation["imu"])


class _ImuRows(Sequence[Imu]):
    """Rows ``(n, 11)`` of an observation, seen as messages."""

    def __init__(self, rows: NDArray[np.float64]) -> None:
        self._rows = rows

    def __len__(self) -> int:
        return len(self._rows)

    @overload
    def __getitem__(self, index: int) -> Imu: ...

    @overload
    def __getitem__(self, index: slice) -> Sequence[Imu]: ...

    def __getitem__(self, index: int | slice) -> Imu | Sequence[Imu]:
        if isinstance(index, slice):
            return _ImuRows(self._rows[index])
        row = self._rows[index]
        return Imu(
            stamp=float(row[0]),
            orientation=row[1:5],
            angular_velocity=row[5:8],
            linear_acceleration=row[8:11],
        )

    def turn_rates(self) -> NDArray[np.float64]:
        """Stamp and angular velocity about z of every row ``(n, 2)``, without making messages."""
        return self._rows.take(_TURN_RATE_COLUMNS, axis=1)

    def accelerations(self) -> NDArray[np.float64]:
        """Stamp and linear acceleration along x and y of every row ``(n, 3)``."""
        return self._rows.take(_ACCELERATION_COLUMNS, axis=1)


def turn_rates(imu: Sequence[Imu]) -> NDArray[np.float64]:
    """Stamp [s] and angular velocity about z [rad/s] of every message ``(n, 2)``."""
    if isinstance(imu, _ImuRows):
        return imu.turn_rates()
    rows = [(message.stamp, message.angular_velocity[2]) for message in imu]
    return np.array(rows, dtype=np.float64).reshape(-1, 2)


def accelerations(imu: Sequence[Imu]) -> NDArray[np.float64]:
    """Stamp [s] and linear acceleration along x and y [m/s2] of every message ``(n, 3)``."""
    if isinstance(imu, _ImuRows):
        return imu.accelerations()
    rows = [(message.stamp, *message.linear_acceleration[:2]) for message in imu]
    return np.array(rows, dtype=np.float64).reshape(-1, 3)
