"""Turns poses that a log has without velocities into odometry messages."""

import numpy as np
from numpy.typing import NDArray

from mapping.geometry import Pose, between, wrap_to_pi
from mapping.messages import Odometry, Twist


def odometry_from_poses(stamps: NDArray[np.float64], poses: Pose) -> list[Odometry]:
    """Odometry messages of poses ``(n, 3)`` at stamps ``(n,)`` [s], velocities by differences.

    A velocity is that from the message before, so that none knows what comes; it is 0 for the first
    one and where no time has gone by. Yaws are wrapped; what is not finite stays so.
    """
    wrapped = np.where(np.abs(poses[:, 2]) < np.pi, poses[:, 2], wrap_to_pi(poses[:, 2]))
    poses = np.column_stack((poses[:, :2], wrapped))
    with np.errstate(divide="ignore", invalid="ignore"):
        steps, past = between(poses[:-1], poses[1:]), np.diff(stamps)[:, np.newaxis]
        moving = np.where(past > 0.0, steps[:, [0, 2]] / past, 0.0)
    twists = np.vstack((np.zeros((min(len(poses), 1), 2)), moving)).tolist()
    return [
        Odometry(stamp=stamp, pose_odom=pose, twist=Twist(linear_x=linear, angular_z=angular))
        for stamp, pose, (linear, angular) in zip(stamps.tolist(), poses, twists, strict=True)
    ]
