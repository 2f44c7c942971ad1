"""Tells where the robot is: by odometry and gyroscope about, by each scan exactly."""

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from mapping.geometry import Pose, between, compose
from mapping.messages import Imu, Odometry
from mapping.pose_covariance import carried, turned
from mapping.slam.fusion import FusedTrack
from mapping.slam.keyframe_graph import KeyframeGraph, view_of
from mapping.slam.local_map import LocalMap
from mapping.slam.odometry_calibration import OdometryCalibration
from mapping.slam.scan_cloud import ScanCloud
from mapping.slam.scan_match_config import ScanMatchConfig
from mapping.slam.scan_matcher import match_twice
from mapping.slam.shove_detector import ShoveDetector

START_COVARIANCE = np.diag(np.square([0.004, 0.004, 0.0015]))
"""How sure the first pose is: as sure as the first match will be [m^2, m^2, rad^2]."""

SHOVE_COVARIANCE = np.diag(np.square([0.1, 0.1, 0.15]))
"""How far a robot that is shoved may be pushed between two scans [m^2, m^2, rad^2]."""

STILL_SHIFT, STILL_TURN = 5e-4, 5e-4
"""A robot that moved less than this [m, rad] since its last scan is where it was."""


class ScanTracker:
    """The pose of the newest scan, in the frame of the keyframes, and the way since then."""

    def __init__(self, config: ScanMatchConfig, graph: KeyframeGraph, start_pose_map: Pose) -> None:
        """Begin where the odometry begins.

        Args:
            config: How to match.
            graph: The keyframes to match with.
            start_pose_map: The pose ``(3,)`` where the odometry counts from.
        """
        self.pose = start_pose_map
        """Pose of the newest scan ``(3,)``; the start pose before the first."""
        self.covariance = START_COVARIANCE
        """How sure that is among the keyframes around ``(3, 3)``."""
        self.reckoned = np.zeros(3)
        """The motion ``(3,)`` since the last keyframe, by odometry and gyroscope alone."""
        self.reckoned_covariance = np.zeros((3, 3))
        """How sure that is ``(3, 3)``, in the frame of the keyframe."""
        self.local = LocalMap(graph, config.local_map)
        self._matcher = config.matcher
        self._track = FusedTrack(config.fusion)
        self._calibration = OdometryCalibration(config.calibration)
        self._has_gyro = False
        self._shoves = ShoveDetector()
        self._scan_odom: Pose | None = None
        self._unmatched = np.zeros(2)

    def add(self, odometry: Sequence[Odometry], imu: Sequence[Imu]) -> None:
        """Take the messages of one control period."""
        self._track.add(odometry, imu)
        self._shoves.add(odometry, imu)
        if not self._has_gyro and len(imu) > 0:
            self._has_gyro = True
            self._calibration.trust_heading()

    def poses_at(self, stamps: ArrayLike) -> Pose | None:
        """Poses ``(n, 3)`` of the odometry at moments ``(n,)`` [s], None when it does not say."""
        return self._track.poses_at(stamps)

    def locate(self, cloud: ScanCloud, pose_odom: Pose, near: int) -> float:
        """Find where a scan was taken; returns which share of it the keyframes explain, 0..1.

        Args:
            cloud: What it saw.
            pose_odom: Where the odometry says that it was taken ``(3,)``.
            near: The keyframe nearest to the last scan.
        """
        last = self._scan_odom
        if last is None:
            self.pose, self._scan_odom = compose(self.pose, pose_odom), pose_odom
            self._track.mark()
            return 0.0
        motion = between(last, pose_odom)
        shoved = self._shoves.is_shoved
        if _is_still(motion) and not shoved:
            return 1.0
        spread, self._scan_odom = self._track.motion_covariance(), pose_odom
        self._track.mark()
        corrected = self._calibration.corrected(motion)
        predicted = compose(self.pose, corrected)
        spread = self._calibration.widened(motion, spread, has_gyro=self._has_gyro)
        # a gyroscope keeps the heading, and for the scale alone windows need not be wider
        if not self._has_gyro:
            left, self._unmatched = self._calibration.left(self._unmatched, motion)
            spread = spread + left
        if shoved:
            spread = spread + SHOVE_COVARIANCE
        self._reckon(corrected, spread)
        covariance = carried(self.covariance, self.pose, predicted, spread)
        self.local.follow(near, view_of(predicted, cloud))
        match = match_twice(self.local.field, cloud, predicted, covariance, self._matcher)
        if not match.refused:
            self._unmatched = np.zeros(2)
        if not match.refused and not shoved:
            noise = turned(covariance + match.seen_covariance, -self.pose[2])
            self._calibration.learn(motion, between(self.pose, match.seen), noise)
        self.pose, self.covariance = match.pose, match.covariance
        return match.score

    @property
    def way_disagreement(self) -> tuple[float, float]:
        """How much longer ways are by matching than by the odometry, relative; and its variance."""
        calibration = self._calibration
        return float(calibration.errors[0]), float(calibration.covariance[0, 0])

    def forget_reckoned(self) -> None:
        """Count the reckoned motion from the newest scan on: it became a keyframe."""
        self.reckoned, self.reckoned_covariance = np.zeros(3), np.zeros((3, 3))

    def _reckon(self, motion: Pose, spread: NDArray[np.float64]) -> None:
        moved = compose(self.reckoned, motion)
        self.reckoned_covariance = carried(self.reckoned_covariance, self.reckoned, moved, spread)
        self.reckoned = moved

    def motion_since_scan(self) -> Pose | None:
        """The motion since the newest scan ``(3,)``, from the start if there was none.

        None before any odometry.
        """
        newest = self._track.newest
        if newest is None or self._scan_odom is None:
            return newest
        return self._calibration.corrected(between(self._scan_odom, newest))


def _is_still(motion: Pose) -> bool:
    return math.hypot(motion[0], motion[1]) < STILL_SHIFT and abs(motion[2]) < STILL_TURN
