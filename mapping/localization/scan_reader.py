"""Turns the messages of a robot into the points that each scan saw and the motion between scans."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mapping.burger import LIDAR_POSE_BASE, LIDAR_RANGE_MAX
from mapping.geometry import Pose, between
from mapping.messages import Imu, LaserScan, Odometry
from mapping.sensor_model import LDS_01, RangeNoise, read_beams
from mapping.slam.fusion import FusedTrack
from mapping.slam.scan_cloud import ScanCloud, make_cloud


@dataclass(frozen=True, slots=True, kw_only=True)
class ReaderConfig:
    """The lidar; the default is a Burger's."""

    max_range: float = LIDAR_RANGE_MAX
    """Farther readings are not used [m]."""
    lidar_pose_base: tuple[float, float, float] = LIDAR_POSE_BASE
    """The lidar's pose in base_footprint."""
    range_noise: RangeNoise = LDS_01
    """How far its readings scatter."""
    spacing: float = 0.03
    """Readings with a standard deviation up to this are worth most [m]."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Reading:
    """A scan, deskewed, and how the robot came to where it was taken."""

    cloud: ScanCloud
    """What it saw, in base_footprint at its first beam."""
    motion: Pose
    """Pose ``(3,)`` of that base_footprint in the one of the reading before; of the first in the
    odometry frame."""
    spread: NDArray[np.float64]
    """Covariance of the motion ``(3, 3)``."""
    is_first: bool
    """Whether there was no reading before."""


class ScanReader:
    """Fuses odometry and gyroscope and deskews scans with them."""

    def __init__(self, config: ReaderConfig | None = None) -> None:
        self.config = config or ReaderConfig()
        self._track = FusedTrack()
        self._newest_stamp = -np.inf
        self._newest_odom: Pose | None = None

    def add(self, odometry: Sequence[Odometry], imu: Sequence[Imu]) -> None:
        """Take the messages of one control period."""
        self._track.add(odometry, imu)

    def read(self, scan: LaserScan | None) -> Reading | None:
        """The reading of a new scan; None if it is none, is known, or cannot be used.

        A scan that is left out leaves its motion to the next one.
        """
        if scan is None or not scan.stamp > self._newest_stamp:
            return None
        self._newest_stamp = scan.stamp
        config = self.config
        beams = read_beams(scan, config.max_range)
        stamps = np.append(scan.stamp, scan.beam_stamps[beams.indices])
        poses_odom = self._track.poses_at(stamps)
        if poses_odom is None or not beams.hits.any():
            return None
        cloud = make_cloud(
            scan,
            beams,
            between(poses_odom[0], poses_odom[1:]),
            lidar_pose_base=config.lidar_pose_base,
            range_noise=config.range_noise,
            resolution=config.spacing,
            reach=config.max_range,
        )
        last, self._newest_odom = self._newest_odom, poses_odom[0]
        spread = self._track.motion_covariance()
        self._track.mark()
        motion = poses_odom[0] if last is None else between(last, poses_odom[0])
        return Reading(cloud=cloud, motion=motion, spread=spread, is_first=last is None)

    def motion_since(self) -> Pose:
        """The robot's motion ``(3,)`` since the newest reading; none before the first."""
        newest = self._track.newest
        if newest is None or self._newest_odom is None:
            return np.zeros(3)
        return between(self._newest_odom, newest)
