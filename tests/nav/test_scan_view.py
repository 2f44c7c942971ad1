"""One scan seen as a whole: every beam by one place, one bearing and one turn from beam to beam."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from mapping.burger import LIDAR_POSE_BASE
from mapping.geometry import compose
from mapping.messages import LaserScan
from nav.scan_points import ScanPoints, ScanView
from tests.nav.scans import PERIOD, Room, box, scan_of, views_of

SCAN = np.full(360, 1.0, dtype=np.float32)


def view_from_rest(ranges: list[float]) -> ScanView:
    points = ScanPoints()
    points.update(LaserScan(stamp=0.0, ranges=np.array(ranges, dtype=np.float32)), HERE, 0.1, 1.2)
    assert points.view is not None
    return points.view


HERE = np.array([1.0, 2.0, 0.5])


def test_beams_that_failed_are_not_a_number_and_those_that_met_nothing_infinite() -> None:
    view = view_from_rest([0.0, math.nan, -math.inf, 0.05, math.inf, 3.0, 0.5])
    assert np.isnan(view.ranges[:4]).all()
    assert view.ranges[4] == math.inf
    assert view.ranges[5:].tolist() == [3.0, 0.5]
    assert view.beams.tolist() == [5, 6], "those that met something, however far"
    assert view.points.shape == (2, 2)


def test_at_rest_its_place_and_direction_are_the_sensors() -> None:
    view = view_from_rest([1.0] * 360)
    assert view.origin == pytest.approx(compose(HERE, np.array(LIDAR_POSE_BASE))[:2])
    assert view.bearing == pytest.approx(HERE[2])
    assert view.increment == pytest.approx(math.radians(1.0))


@given(
    yaw=st.floats(-math.pi, math.pi),
    speed=st.floats(-0.21, 0.21),
    rate=st.floats(-1.6, 1.6),
    seed=st.integers(0, 1_000),
)
@settings(max_examples=20)
def test_while_driving_and_turning_its_rays_end_where_its_points_are(
    yaw: float, speed: float, rate: float, seed: int
) -> None:
    """Also where the yaw passes pi."""
    corner = np.random.default_rng(seed).uniform(-1.5, -0.8, 2)
    room = Room(walls=box(*corner, 3.0, 2.6))
    ticks = PERIOD * np.arange(7)
    middles = yaw + 0.5 * rate * ticks
    chord = speed * ticks * np.sinc(0.5 * rate * ticks / np.pi)
    poses = np.column_stack((chord * np.cos(middles), chord * np.sin(middles), yaw + rate * ticks))
    for view in views_of(room, poses):
        angles = view.bearing + view.increment * view.beams
        along = np.column_stack((np.cos(angles), np.sin(angles)))
        rays = view.origin + view.ranges[view.beams, None] * along
        # from the middle beam's place to the first one's: 0.1 s at 0.21 m/s, and the mount's turn
        assert np.hypot(*(rays - view.points).T).max() < 0.021 + 0.032 * 0.16 + 0.001


def test_there_is_no_view_before_a_scan_nor_of_a_single_beam() -> None:
    points = ScanPoints()
    points.update(None, HERE, 0.1, 1.2)
    assert points.view is None
    points.update(LaserScan(stamp=0.1, ranges=SCAN[:1]), HERE, 0.1, 1.2)
    assert points.view is None
    points.update(scan_of(Room(walls=box(0, 0, 3, 3)), 0.2, np.tile(HERE, (360, 1))), HERE, 0.1, 1)
    assert points.view is not None
    assert points.view.stamp == pytest.approx(0.3, abs=1e-3), "its middle beam's"
