"""Messages for the fusion, and drives fed to it."""

from collections.abc import Sequence

import numpy as np

from mapping.geometry import Pose, between, wrap_to_pi
from mapping.messages import Imu, Odometry, Twist
from mapping.slam.fusion import FusedTrack
from tests.mapping.slam.drives import Drive, imu_message


def message(stamp: float, pose: Sequence[float], v: float = 0.0, w: float = 0.0) -> Odometry:
    return Odometry(
        stamp=stamp,
        pose_odom=np.array(pose, dtype=np.float64),
        twist=Twist(linear_x=v, angular_z=w),
    )


def gyro(stamp: float, rate: float) -> Imu:
    return imu_message(np.array([stamp, 0, 0, 0, 1, 0, 0, rate, 0, 0, 9.81]))


def ahead(metres: float, stamp: float) -> Odometry:
    return message(stamp, (metres, 0.0, 0.0), v=0.2)


def follow(track: FusedTrack, run: Drive, every: int = 3) -> Pose:
    """Feed a drive, ``every`` odometry messages at once; the poses after each time ``(n, 3)``."""
    poses, taken = [], 0
    stamps = np.array([message.stamp for message in run.imu])
    for first in range(0, len(run.odometry), every):
        messages = run.odometry[first : first + every]
        upto = int(np.searchsorted(stamps, messages[-1].stamp + 1e-9))
        track.add(messages, run.imu[taken:upto])
        taken = upto
        assert track.newest is not None
        poses.append(track.newest)
    return np.array(poses)


def yaw_error(start: Pose, end: Pose, run: Drive) -> float:
    """How far a believed turn from the first message to the last is off [rad]."""
    turn = between(start, end)[2] - between(run.poses[0], run.poses[-1])[2]
    return float(wrap_to_pi(turn))


def rms(values: Sequence[float]) -> float:
    return float(np.sqrt(np.mean(np.square(values))))
