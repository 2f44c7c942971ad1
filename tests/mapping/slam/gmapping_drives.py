"""Drives around the arena for GMapping: with odometry that overestimates, and standing still."""

from collections.abc import Iterable, Iterator
from dataclasses import replace

import numpy as np
from numpy.typing import ArrayLike

from mapping.geometry import Pose, between, compose
from mapping.messages import LaserScan, Odometry, Twist
from mapping.slam.gmapping import Gmapping
from mapping.slam.gmapping_config import GmappingConfig
from tests.mapping.arena import circling, drive

Period = tuple[LaserScan | None, list[Odometry]]

FEW = GmappingConfig(particles=8)

EVERY_SCAN = replace(FEW, linearUpdate=0.0, angularUpdate=0.0)

ROUND = 35.0
"""Time once around the arena's posts [s]."""

SLIP = np.array([1.03, 1.0, 1.08])
"""What the bad odometry makes of a step: forward, sideways and of a turn."""


def still(stamp: float, pose: ArrayLike = (0.0, 0.0, 0.0)) -> list[Odometry]:
    return [Odometry(stamp=stamp, pose_odom=np.array(pose, dtype=float), twist=Twist())]


def slipping(periods: Iterable[Period]) -> Iterator[Period]:
    """The same drive with odometry that overestimates."""
    true: Pose | None = None
    told: Pose = np.zeros(3)
    for scan, odometry in periods:
        bad = []
        for message in odometry:
            step = np.zeros(3) if true is None else between(true, message.pose_odom)
            told = message.pose_odom if true is None else compose(told, SLIP * step)
            true = message.pose_odom
            twist = Twist(
                linear_x=SLIP[0] * message.twist.linear_x,
                angular_z=SLIP[2] * message.twist.angular_z,
            )
            bad.append(replace(message, pose_odom=told, twist=twist))
        yield scan, bad


def mapped(
    config: GmappingConfig, periods: Iterable[Period], start: ArrayLike = (0, 0, 0)
) -> Gmapping:
    mapper = Gmapping(config, start_pose_map=start)
    for scan, odometry in periods:
        mapper.update(scan, odometry)
    return mapper


def noisy_round(seconds: float = ROUND) -> list[Period]:
    return list(slipping(drive(circling(), seconds, np.random.default_rng(3))))
