import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from mapping.errors import TestbedError
from mapping.geometry import between, compose
from mapping.log_editing import reach_of, rebased, shortened
from mapping.messages import LaserScan, Odometry, Twist
from mapping.sensor_log import SensorLog


def scan(ranges: list[float], range_max: float = 80.0, stamp: float = 0.0) -> LaserScan:
    return LaserScan(stamp=stamp, ranges=np.array(ranges, dtype=np.float32), range_max=range_max)


def log(*range_maxima: float) -> SensorLog:
    scans = [scan([1.0], range_max) for range_max in range_maxima]
    return SensorLog(source="a.log", scans=scans, odometry=[])


def test_nothing_is_left_of_what_lies_beyond_the_range() -> None:
    cut = shortened(scan([1.0, 3.5, 3.6, 80.0, np.inf, 0.0, np.nan]), 3.5)
    assert np.array_equal(cut.ranges, [1.0, 3.5, np.inf, np.inf, np.inf, 0.0, np.nan], True)
    assert cut.range_max == 3.5


def test_a_scan_that_sees_less_far_stays_as_it_is() -> None:
    short = scan([1.0, np.inf, np.nan], range_max=3.5)
    assert shortened(short, 3.5) is short
    assert shortened(short, 80.0) is short


def test_a_scan_that_does_not_tell_its_range_gets_one() -> None:
    for none in (np.nan, 0.0, -1.0, np.inf):
        cut = shortened(scan([1.0, 5.0], range_max=none), 3.5)
        assert cut.range_max == 3.5
        assert cut.ranges.tolist() == [1.0, np.inf]


def test_the_scan_of_the_log_is_not_changed() -> None:
    long = scan([1.0, 5.0])
    shortened(long, 3.5)
    assert long.ranges.tolist() == [1.0, 5.0]


def test_the_reach_of_a_log_is_that_of_the_scan_that_sees_farthest() -> None:
    assert reach_of(log(3.5, np.nan, 8.0, np.inf, 0.0)) == 8.0


@pytest.mark.parametrize("range_max", [0.0, -1.0, np.nan, np.inf])
def test_a_log_that_does_not_tell_its_reach_is_refused(range_max: float) -> None:
    with pytest.raises(TestbedError, match=r"a\.log: range_max"):
        reach_of(log(range_max))
    assert reach_of(log(range_max), 3.5) == 3.5
    assert reach_of(log(range_max, 8.0), 3.5) == 8.0


@given(frame=st.tuples(st.floats(-50, 50), st.floats(-50, 50), st.floats(-3, 3)))
@settings(max_examples=20, deadline=None)
def test_rebased_odometry_is_the_same_in_whatever_frame_it_was_told(
    frame: tuple[float, float, float],
) -> None:
    poses = np.array([[0.0, 0.0, 0.0], [1.0, 0.5, 0.3], [2.0, -0.5, -2.0]])
    told = [
        Odometry(stamp=float(k), pose_odom=pose, twist=Twist(linear_x=0.1 * k))
        for k, pose in enumerate(compose(frame, poses))
    ]
    again = rebased(told)
    got = np.array([each.pose_odom for each in again])
    assert np.allclose(between(got, poses), 0.0, atol=1e-9)
    assert [each.stamp for each in again] == [0.0, 1.0, 2.0]
    assert again[2].twist.linear_x == 0.2


def test_odometry_that_is_not_finite_is_passed_by() -> None:
    poses = [np.full(3, np.inf), np.array([1.0, 0.0, 0.0]), np.array([2.0, np.nan, 0.0])]
    told = [Odometry(stamp=0.0, pose_odom=pose, twist=Twist()) for pose in poses]
    again = [each.pose_odom for each in rebased(told)]
    assert np.array_equal(again[0], poses[0])
    assert again[1].tolist() == [0.0, 0.0, 0.0]
    assert np.array_equal(again[2], poses[2], equal_nan=True)
    assert rebased([]) == []
