"""Turns the newest scan of an observation into points on the map, for pictures."""

import numpy as np
from numpy.typing import NDArray

from mapping.burger import LIDAR_POSE_BASE
from mapping.deskew_kernels import aim, interpolate
from mapping.geometry import Pose, between
from mapping.messages import LaserScan, Observation


def scan_ends(observation: Observation, pose_map: Pose) -> NDArray[np.float64]:
    """Where the beams of the newest scan met something ``(n, 2)`` [m]; none before the first scan.

    Each is placed from where the robot was when it was shot. The scan is up to 0.3 s older than the
    odometry of the observation; the robot is taken to have come along the arc of its oldest twist.

    Args:
        observation: As ``envs:TurtleBot3Burger-v0`` gives it.
        pose_map: Pose of base_footprint in the map frame at the newest odometry ``(3,)``.
    """
    scan = LaserScan.from_observation(observation)
    if scan is None:
        return np.zeros((0, 2))
    odometry = np.ascontiguousarray(observation["odometry"])
    moved = between(odometry[-1, 1:4], interpolate(odometry, scan.beam_stamps))
    met = np.flatnonzero((scan.ranges >= scan.range_min) & (scan.ranges <= scan.range_max))
    ranges = scan.ranges[met].astype(np.float64)
    _, _, ends = aim(pose_map, moved[met], LIDAR_POSE_BASE, scan.angles[met], ranges)
    return np.asarray(ends)
