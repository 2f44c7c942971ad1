import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mapping.messages import Imu, LaserScan, Odometry, Twist
from mapping.sensor_log import SensorLog

STAMPS = st.lists(
    st.one_of(st.floats(-2.0, 5.0), st.sampled_from([0.0, 1.0, np.nan, np.inf, -np.inf])),
    max_size=12,
)


def scan(stamp: float, beams: int = 3) -> LaserScan:
    return LaserScan(
        stamp=stamp, ranges=np.ones(beams, dtype=np.float32), time_increment=0.2 / max(beams, 1)
    )


def odometry(stamp: float) -> Odometry:
    return Odometry(stamp=stamp, pose_odom=np.zeros(3), twist=Twist())


def imu(stamp: float) -> Imu:
    return Imu(
        stamp=stamp,
        orientation=np.array([0.0, 0.0, 0.0, 1.0]),
        angular_velocity=np.zeros(3),
        linear_acceleration=np.zeros(3),
    )


def log(scans: list[float], wheels: list[float], gyro: list[float], beams: int = 3) -> SensorLog:
    return SensorLog(
        source="test",
        scans=[scan(stamp, beams) for stamp in scans],
        odometry=[odometry(stamp) for stamp in wheels],
        imu=[imu(stamp) for stamp in gyro],
    )


@given(scans=STAMPS, wheels=STAMPS, gyro=STAMPS, beams=st.sampled_from([0, 1, 3]))
def test_every_message_comes_exactly_once_and_in_order(
    scans: list[float], wheels: list[float], gyro: list[float], beams: int
) -> None:
    whole = log(scans, wheels, gyro, beams)
    periods = list(whole.periods())
    for got, sent in (
        ([each for each, _, _ in periods if each is not None], whole.scans),
        ([message for _, part, _ in periods for message in part], whole.odometry),
        ([message for _, _, part in periods for message in part], whole.imu),
    ):
        assert [id(message) for message in got] == [id(message) for message in sent]


@given(
    scans=st.lists(st.floats(0.0, 5.0), min_size=1, max_size=8),
    wheels=st.lists(st.floats(0.0, 6.0), max_size=30),
)
def test_with_a_scan_comes_odometry_up_to_its_last_beam(
    scans: list[float], wheels: list[float]
) -> None:
    whole = log(sorted(scans), sorted(wheels), [])
    seen = 0
    for each, part, _ in whole.periods():
        seen += len(part)
        if each is None:
            continue
        end = each.stamp + 2 * each.time_increment
        # all older than the last beam, and the first that is not, if there is one
        needed = sum(message.stamp < end for message in whole.odometry)
        assert seen >= min(needed + 1, len(whole.odometry))
        assert all(message.stamp < end for message in part[:-1])


def test_what_follows_the_last_scan_comes_last() -> None:
    periods = list(log([0.0], [0.0, 1.0, 2.0], [0.5, 3.0]).periods())
    assert len(periods) == 2
    last, wheels, gyro = periods[1]
    assert last is None
    assert [message.stamp for message in wheels] == [2.0]
    assert [message.stamp for message in gyro] == [3.0]


def test_a_scan_without_a_time_takes_no_messages_from_the_next() -> None:
    periods = list(log([np.nan, 1.0], [0.9, 1.1, 1.2], []).periods())
    assert [len(part) for _, part, _ in periods] == [0, 3]


@pytest.mark.parametrize("wheels", [[], [0.0, 1.0]])
def test_a_log_without_scans_is_at_most_one_period(wheels: list[float]) -> None:
    periods = list(log([], wheels, []).periods())
    assert [len(part) for _, part, _ in periods] == ([2] if wheels else [])
