"""Turns recorded messages into those of a robot that saw less far, or started elsewhere."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from mapping.errors import TestbedError
from mapping.geometry import between
from mapping.messages import LaserScan, Odometry
from mapping.sensor_log import SensorLog


def reach_of(log: SensorLog, otherwise: float | None = None) -> float:
    """How far the log's lidar reports ranges [m]; ``otherwise`` if no scan tells.

    Raises:
        TestbedError: No scan tells, and there is no ``otherwise``.
    """
    told = [scan.range_max for scan in log.scans if 0.0 < scan.range_max < np.inf]
    if not told:
        if otherwise is not None:
            return otherwise
        raise TestbedError(
            f"{log.source}: range_max of no scan is a finite number above 0; one must be, or "
            "--max-range given"
        )
    return float(max(told))


def shortened(scan: LaserScan, max_range: float) -> LaserScan:
    """The scan that a lidar would have taken that sees ``max_range`` [m] far and no farther.

    Readings beyond become ``+inf``, so that nothing of them is left to be used. A scan whose
    ``range_max`` is no number above 0 is taken to have seen so far.
    """
    beyond = scan.ranges > max_range
    if 0.0 < scan.range_max <= max_range and not np.any(np.isfinite(scan.ranges[beyond])):
        return scan
    ranges = scan.ranges.copy()
    ranges[beyond] = np.inf
    range_max = scan.range_max if 0.0 < scan.range_max <= max_range else max_range
    return replace(scan, ranges=ranges, range_max=range_max)


def rebased(odometry: Sequence[Odometry]) -> list[Odometry]:
    """The same odometry told from its first usable pose; one that is not usable stays as it is."""
    poses = np.array([message.pose_odom for message in odometry], dtype=np.float64).reshape(-1, 3)
    usable = np.array([message.is_usable for message in odometry], dtype=np.bool_)
    if usable.any():
        poses[usable] = between(poses[np.argmax(usable)], poses[usable])
    return [replace(each, pose_odom=pose) for each, pose in zip(odometry, poses, strict=True)]
