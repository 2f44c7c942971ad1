"""Turns the covariance of a pose into that of the pose after a motion, or seen from elsewhere."""

import math

import numpy as np
from numpy.typing import NDArray

from mapping.geometry import Pose

Covariance = NDArray[np.float64]
"""Of a pose ``(3, 3)`` [m2, m2, rad2]."""


def carried(covariance: Covariance, pose: Pose, moved: Pose, spread: Covariance) -> Covariance:
    """The covariance after a motion, in the frame that the poses are given in.

    Probabilistic Robotics, table 7.2, lines 3 to 7: G Sigma G^T, and the motion's own.

    Args:
        covariance: Before the motion.
        pose: The pose before it ``(3,)``.
        moved: The pose after it ``(3,)``.
        spread: The motion's own covariance, in the frame of ``pose``.
    """
    dx, dy = moved[:2] - pose[:2]
    carry = np.array([[1.0, 0.0, -dy], [0.0, 1.0, dx], [0.0, 0.0, 1.0]])
    return np.asarray(carry @ covariance @ carry.T + turned(spread, pose[2]))


def turned(covariance: Covariance, yaw: float) -> Covariance:
    """A covariance given in a frame that is turned by ``yaw`` [rad], in the frame it is turned in.

    With ``-yaw`` the way back.
    """
    cos, sin = math.cos(yaw), math.sin(yaw)
    turn = np.array([[cos, -sin, 0.0], [sin, cos, 0.0], [0.0, 0.0, 1.0]])
    return np.asarray(turn @ covariance @ turn.T)
