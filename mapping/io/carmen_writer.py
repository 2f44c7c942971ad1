"""Turns sensor logs into CARMEN logs that CARMEN's readers take and that ours reads back whole."""

import heapq
from collections.abc import Iterable, Iterator, Sequence
from functools import partial
from pathlib import Path
from typing import BinaryIO

import numpy as np
from numpy.typing import NDArray

from mapping.geometry import Pose, compose
from mapping.io.atomic import write_atomically
from mapping.io.carmen import (
    IMU,
    ODOM,
    PARAM,
    POSE_PARAMS,
    RANGE_MIN_PARAM,
    ROBOTLASER1,
    SCAN_TIME_PARAM,
    TIME_INCREMENT_PARAM,
    UNKNOWN_TYPE,
)
from mapping.io.range_limits import hits_below_maximum
from mapping.messages import Imu, LaserScan, Odometry
from mapping.sensor_log import SensorLog

HEADER = """\
# CARMEN log: one message a line, metres, radians and seconds
# ODOM x y theta tv rv accel ipc_timestamp ipc_hostname logger_timestamp
# ROBOTLASER1 type start_angle fov resolution max_range accuracy remission_mode n ranges...
#   m remissions... laser_x laser_y laser_theta robot_x robot_y robot_theta
#   tv rv forward_safety side_safety turn_axis ipc_timestamp ipc_hostname logger_timestamp
# IMU acc_x acc_y acc_z q_w q_x q_y q_z mag_x mag_y mag_z gyro_x gyro_y gyro_z ipc_timestamp ...
# A range equal to max_range: nothing was there. A range of 0: the beam failed.
"""

HOST = "nohost"
"""What stands for the computer that a message came from."""


def write_carmen(path: str | Path, log: SensorLog) -> None:
    """Write a log's scans as ``ROBOTLASER1``, its odometry as ``ODOM``, its IMU as ``IMU`` lines.

    Every number has the digits that bring it back. A reading is written as the float32 it is, so
    ranges come back to the last bit; but ``+inf`` and finite readings beyond ``range_max`` both
    become ``max_range``, and failed beams, whatever marked them, become 0. The lidar's pose,
    ``range_min`` and the rolling scan's times go into ``PARAM`` lines.

    The lines stand in the order in which the messages were complete. A scan's own line tells the
    robot's pose at its first beam, interpolated from the odometry.

    Raises:
        TestbedError: The file cannot be written.
    """
    write_atomically(path, partial(_write, log))


def _write(log: SensorLog, file: BinaryIO) -> None:
    params = zip(POSE_PARAMS, log.lidar_pose_base, strict=True)
    head = [_param(name, value) for name, value in params]
    lines = heapq.merge(
        _in_time([message.stamp for message in log.odometry], map(_odom, log.odometry)),
        _in_time([message.stamp for message in log.imu], map(_imu, log.imu)),
        _in_time(list(map(_end, log.scans)), _scans(log)),
        key=lambda timed: timed[0],
    )
    file.write((HEADER + "".join(head)).encode())
    file.writelines(line.encode() for _, line in lines)


def _end(scan: LaserScan) -> float:
    """When the last beam was taken [s]."""
    return scan.stamp + max(len(scan.ranges) - 1, 0) * scan.time_increment


def _in_time(times: Sequence[float], lines: Iterable[str]) -> Iterator[tuple[float, str]]:
    """Lines with the times by which they are merged, which never run backwards."""
    known = np.nan_to_num(np.array(times, dtype=np.float64), nan=-np.inf)
    return zip(np.maximum.accumulate(known).tolist(), lines, strict=True)


def _odom(message: Odometry) -> str:
    """An odometry message as a line; its acceleration is not known."""
    x, y, yaw = message.pose_odom.tolist()
    twist = message.twist
    return _line(ODOM, [x, y, yaw, twist.linear_x, twist.angular_z, 0.0], message.stamp)


def _imu(message: Imu) -> str:
    """An IMU message as a line; there is no magnetometer."""
    x, y, z, w = message.orientation.tolist()
    acceleration, gyroscope = message.linear_acceleration, message.angular_velocity
    magnetometer = (0.0, 0.0, 0.0)
    row = [*acceleration.tolist(), w, x, y, z, *magnetometer, *gyroscope.tolist()]
    return _line(IMU, row, message.stamp)


def _scans(log: SensorLog) -> Iterator[str]:
    """The scans as lines, with PARAM lines before the first and wherever one of them changes."""
    told: tuple[float, ...] = ()
    robot_poses = _poses_at([scan.stamp for scan in log.scans], log.odometry)
    laser_poses = compose(robot_poses, log.lidar_pose_base)
    for scan, robot, laser in zip(log.scans, robot_poses, laser_poses, strict=True):
        settings = (scan.time_increment, scan.scan_time, scan.range_min)
        names = (TIME_INCREMENT_PARAM, SCAN_TIME_PARAM, RANGE_MIN_PARAM)
        changed = "" if settings == told else "".join(map(_param, names, settings))
        told = settings
        yield changed + _scan(scan, laser, robot)


def _param(name: str, value: float) -> str:
    return f"{PARAM} {name} {_number(value)}\n"


def _scan(scan: LaserScan, laser_pose: Pose, robot_pose: Pose) -> str:
    """A scan as a line; accuracy, remissions, velocities and safety distances are not known."""
    count = len(scan.ranges)
    fov = max(count - 1, 0) * scan.angle_increment
    settings = (scan.angle_min, fov, scan.angle_increment, scan.range_max, 0.0)
    words = [ROBOTLASER1, UNKNOWN_TYPE, *map(_number, settings), "0", str(count)]
    words += [*_readings(scan), "0"]
    figures = [*laser_pose.tolist(), *robot_pose.tolist(), *[0.0] * 5]
    return _line(" ".join(words), figures, scan.stamp)


def _readings(scan: LaserScan) -> list[str]:
    """The ranges, each with the digits that tell its float32 from every other."""
    ranges = hits_below_maximum(np.asarray(scan.ranges, dtype=np.float32), scan.range_max)
    ranges[~(ranges > 0.0)] = 0.0
    beyond = np.isinf(ranges) | (ranges > np.float32(scan.range_max))
    words: list[str] = ranges.astype(str).tolist()
    for i in np.flatnonzero(beyond):
        words[i] = _number(scan.range_max)
    return words


def _line(start: str, row: Sequence[float], stamp: float) -> str:
    """A line; the logger's time is the sensor's."""
    return f"{start} {' '.join(map(_number, row))} {_number(stamp)} {HOST} {_number(stamp)}\n"


def _number(value: float) -> str:
    """The shortest decimals that come back as this number."""
    return repr(float(value))


def _poses_at(stamps: Sequence[float], odometry: Sequence[Odometry]) -> Pose:
    """The robot's poses ``(n, 3)`` at stamps ``(n,)``; the first or last one outside of them."""
    rows = np.array([(message.stamp, *message.pose_odom) for message in odometry]).reshape(-1, 4)
    rows = rows[np.isfinite(rows).all(axis=1)]
    if len(rows) == 0:
        return np.zeros((len(stamps), 3))
    rows = rows[np.argsort(rows[:, 0], kind="stable")]
    at = np.asarray(stamps, dtype=np.float64)
    columns: list[NDArray[np.float64]] = [
        np.interp(at, rows[:, 0], column)
        for column in (rows[:, 1], rows[:, 2], np.unwrap(rows[:, 3]))
    ]
    return np.column_stack(columns)
