"""A CARMEN log that is written brings back the run."""

from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
import pytest
from hypothesis import given, settings

from mapping.errors import TestbedError
from mapping.io.carmen_reader import read_carmen
from mapping.io.carmen_writer import write_carmen
from mapping.sensor_log import SensorLog
from tests.mapping.io.logs import driven_log, logs, meanings


def round_trip(log: SensorLog) -> SensorLog:
    with TemporaryDirectory() as folder:
        write_carmen(Path(folder) / "a.log", log)
        return read_carmen(Path(folder) / "a.log")


@settings(max_examples=60)
@given(logs())
def test_a_log_comes_back_as_it_was(log: SensorLog) -> None:
    again = round_trip(log)
    assert again.lidar_pose_base == log.lidar_pose_base
    for before, after in zip(log.scans, again.scans, strict=True):
        for name in ("stamp", "angle_min", "angle_increment", "time_increment", "scan_time"):
            assert getattr(after, name) == getattr(before, name)
        assert after.range_min == before.range_min
        assert after.range_max == before.range_max
        (nothing, ranges), (nothing_after, ranges_after) = meanings(before), meanings(after)
        assert np.array_equal(nothing, nothing_after)
        assert np.allclose(ranges, ranges_after, rtol=1e-6, atol=0.0), "a hit at the very maximum"
        assert np.array_equal(ranges == 0.0, ranges_after == 0.0)
    for before, after in zip(log.odometry, again.odometry, strict=True):
        assert after.stamp == before.stamp
        assert np.array_equal(after.pose_odom, before.pose_odom)
        assert after.twist == before.twist
    for before, after in zip(log.imu, again.imu, strict=True):
        assert after.stamp == before.stamp
        assert np.array_equal(after.orientation, before.orientation)
        assert np.array_equal(after.angular_velocity, before.angular_velocity)
        assert np.array_equal(after.linear_acceleration, before.linear_acceleration)


def test_the_messages_stand_in_the_order_in_which_they_were_complete(tmp_path: Path) -> None:
    write_carmen(tmp_path / "a.log", driven_log(start=1e9))
    lines = (tmp_path / "a.log").read_text().splitlines()
    rolling = 359 / 1800
    ends = [
        float(line.split()[-1]) + (rolling if line.startswith("ROBOTLASER1") else 0.0)
        for line in lines
        if line.split()[0] in ("ODOM", "IMU", "ROBOTLASER1")
    ]
    assert np.all(np.diff(ends) >= 0.0)
    assert len(ends) == 60 + 200 + 10


def test_other_readers_find_the_interpolated_poses_in_a_scans_line(tmp_path: Path) -> None:
    log = driven_log()
    write_carmen(tmp_path / "a.log", log)
    lines = (tmp_path / "a.log").read_text().splitlines()
    words = [line for line in lines if line.startswith("ROBOTLASER1")][1].split()
    laser, robot = (np.array(words[-14 + i : -11 + i], dtype=float) for i in (0, 3))
    geometry = [0.0, 359 * np.pi / 180, np.pi / 180, 3.5]
    assert [float(word) for word in words[2:6]] == pytest.approx(geometry)
    assert robot == pytest.approx(log.odometry[6].pose_odom), "the scan at 0.2 s"
    offset = np.cos(robot[2]) * -0.032, np.sin(robot[2]) * -0.032
    assert laser[:2] - robot[:2] == pytest.approx(offset)


def test_a_log_without_odometry_stands_still(tmp_path: Path) -> None:
    log = SensorLog(source="a", scans=driven_log().scans, odometry=[])
    assert all(not message.pose_odom.any() for message in round_trip(log).odometry)


def test_a_folder_that_is_not_there_is_told(tmp_path: Path) -> None:
    with pytest.raises(TestbedError, match="cannot be written"):
        write_carmen(tmp_path / "gone" / "a.log", driven_log())
