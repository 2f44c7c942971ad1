"""Beams placed by the pose of their own time."""

import numpy as np
import pytest

from mapping.burger import LIDAR_POSE_BASE
from mapping.messages import LaserScan
from nav.scan_points import ScanPoints


def test_a_scan_taken_while_turning_shows_a_round_wall_as_a_circle() -> None:
    rate, radius = 1.5, 1.0
    points = ScanPoints()
    points.update(None, np.array([0.0, 0.0, 0.0]), 0.0, reach=2.0)
    times = np.arange(1, 4) * 0.1
    for time in times[:2]:
        points.update(None, np.array([0.0, 0.0, rate * time]), 0.1, reach=2.0)
    stamps = np.arange(360) / 1800.0
    directions = rate * stamps + np.radians(np.arange(360))
    mount = LIDAR_POSE_BASE[0] * np.column_stack((np.cos(rate * stamps), np.sin(rate * stamps)))
    along = np.column_stack((np.cos(directions), np.sin(directions)))
    half = np.sum(mount * along, axis=1)
    ranges = -half + np.sqrt(half**2 + radius**2 - LIDAR_POSE_BASE[0] ** 2)
    scan = LaserScan(stamp=0.0, ranges=ranges.astype(np.float32))
    assert points.update(scan, np.array([0.0, 0.0, rate * 0.3]), 0.1, reach=2.0)
    # 1 mm: poses are interpolated between control periods, exact for a steady turn
    assert np.hypot(*points.points.T) == pytest.approx(np.full(360, radius), abs=1e-3)


def test_failed_and_empty_beams_make_no_points() -> None:
    points = ScanPoints()
    ranges = np.array([0.0, np.nan, np.inf, -np.inf, 0.05, 3.9, 0.5], dtype=np.float32)
    points.update(LaserScan(stamp=0.0, ranges=ranges), np.zeros(3), 0.1, reach=5.0)
    assert len(points.points) == 1


def test_the_same_scan_is_used_once() -> None:
    points = ScanPoints()
    scan = LaserScan(stamp=0.4, ranges=np.ones(360, dtype=np.float32))
    assert points.update(scan, np.zeros(3), 0.1, reach=2.0)
    assert not points.update(scan, np.ones(3), 0.1, reach=2.0)
    assert points.time == pytest.approx(0.7), "the scan's end and one period"
