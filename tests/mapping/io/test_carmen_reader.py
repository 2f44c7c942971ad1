"""CARMEN logs as the loggers of many robots wrote them."""

from pathlib import Path

import numpy as np
import pytest

from mapping.errors import TestbedError
from mapping.io.carmen_reader import read_carmen
from mapping.sensor_log import SensorLog

STAMP = 976052890.244111


def flaser(
    ranges: list[float],
    *,
    laser: str = "1.1 2 0.5",
    robot: str = "1 2 0.5",
    stamp: float = STAMP,
    logger: float = 0.1,
) -> str:
    readings = " ".join(map(str, ranges))
    return f"FLASER {len(ranges)} {readings} {laser} {robot} {stamp!r} host {logger!r}"


def robotlaser(ranges: str, *, kind: str = "2", settings: str = "-1.0 2.0 0.5 4.0 0.01 0") -> str:
    return (
        f"ROBOTLASER1 {kind} {settings} {ranges} 2 17 18 0.1 0.2 0.3 0 0.2 0.3 "
        f"0.4 0.5 0.6 0.7 0.8 {STAMP!r} host 0.1"
    )


def odom(stamp: float, pose: str = "1 2 0.5", speeds: str = "0.3 -0.1") -> str:
    return f"ODOM {pose} {speeds} 0.0 {stamp!r} host 0.1"


def read(folder: Path, *lines: str, end: str = "\n") -> SensorLog:
    (folder / "a.log").write_text("\n".join(lines) + end)
    return read_carmen(folder / "a.log")


@pytest.mark.parametrize(
    ("beams", "last_deg"),
    [(180, 89.0), (181, 90.0), (360, 89.5), (361, 90.0), (401, 50.0), (91, 90.0)],
)
def test_the_beams_of_a_sick_lie_where_its_convention_has_them(
    tmp_path: Path, beams: int, last_deg: float
) -> None:
    scan = read(tmp_path, flaser([1.0] * beams)).scans[0]
    first_deg = -50.0 if beams == 401 else -90.0
    assert np.degrees(scan.angles[[0, -1]]) == pytest.approx([first_deg, last_deg])


def test_a_stamp_of_a_billion_seconds_keeps_its_microseconds(tmp_path: Path) -> None:
    log = read(tmp_path, flaser([1.0]))
    assert log.scans[0].stamp == STAMP
    assert log.odometry[0].stamp == STAMP


def test_a_sicks_codes_beyond_81_m_mean_that_nothing_was_there(tmp_path: Path) -> None:
    scan = read(tmp_path, flaser([0.0, 80.9, 81.0, 81.83, 81.91])).scans[0]
    assert scan.ranges.tolist() == [0.0, np.float32(80.9), np.inf, np.inf, np.inf]
    assert scan.range_max == 81.0


def test_a_parameter_tells_a_nearer_maximum_from_there_on(tmp_path: Path) -> None:
    parameter = "PARAM robot_front_laser_max 8.0"
    log = read(tmp_path, flaser([7.9, 8.1]), parameter, flaser([7.9, 8.1]))
    assert log.scans[0].ranges.tolist() == np.float32([7.9, 8.1]).tolist()
    assert log.scans[1].ranges.tolist() == [np.float32(7.9), np.inf]


def test_the_known_maximum_of_81_92_does_not_make_hits_of_codes(tmp_path: Path) -> None:
    log = read(tmp_path, "PARAM robot_front_laser_max 81.92", flaser([81.83]))
    assert np.isinf(log.scans[0].ranges).all()


def test_a_robotlaser_line_tells_its_geometry_and_skips_remissions(tmp_path: Path) -> None:
    log = read(tmp_path, robotlaser("3 1.5 4.0 0.0"))
    scan = log.scans[0]
    assert scan.angles.tolist() == pytest.approx([-1.0, -0.5, 0.0])
    assert scan.ranges.tolist() == [1.5, np.inf, 0.0]
    assert scan.range_max == 4.0
    assert scan.stamp == STAMP
    assert log.odometry[0].pose_odom.tolist() == [0.0, 0.2, 0.3]


def test_a_robotlaser_line_without_resolution_has_its_beams_spread_over_its_field(
    tmp_path: Path,
) -> None:
    scan = read(tmp_path, robotlaser("3 1 1 1", settings="-1.0 2.0 0 4.0 0.01 0")).scans[0]
    assert scan.angles.tolist() == pytest.approx([-1.0, 0.0, 1.0])


def test_a_sick_behind_a_robotlaser_line_has_codes_too(tmp_path: Path) -> None:
    settings = "-1.0 2.0 0.5 81.92 0.01 0"
    scan = read(tmp_path, robotlaser("2 1.0 81.83", kind="0", settings=settings)).scans[0]
    assert scan.ranges.tolist() == [1.0, np.inf]


def test_the_lidars_pose_is_that_of_the_first_line(tmp_path: Path) -> None:
    ahead = flaser([1.0], laser="1.2 3.0 1.5707963267948966", robot="1.2 2.7 1.5707963267948966")
    log = read(tmp_path, ahead, flaser([1.0], laser="9 9 0"))
    assert log.lidar_pose_base == (0.3, 0.0, 0.0)


def test_parameters_tell_the_lidars_pose_before_the_lines_do(tmp_path: Path) -> None:
    offset, side = "PARAM robot_frontlaser_offset 0.2", "PARAM robot_frontlaser_side_offset -0.1"
    assert read(tmp_path, offset, side, flaser([1.0])).lidar_pose_base == (0.2, -0.1, 0.0)


def test_without_odom_lines_the_scans_own_poses_are_the_odometry(tmp_path: Path) -> None:
    poses = ("0 0 3.1", "0 0 -3.1", "0 0 -3.1")
    lines = [flaser([1.0], robot=pose, stamp=10.0 + i) for i, pose in enumerate(poses)]
    log = read(tmp_path, *lines)
    turned = 2.0 * np.pi - 6.2
    rates = [message.twist.angular_z for message in log.odometry]
    assert rates == pytest.approx([0.0, turned, 0.0])
    assert [message.pose_odom[2] for message in log.odometry] == [3.1, -3.1, -3.1]


def test_speeds_are_measured_along_the_robot(tmp_path: Path) -> None:
    north = [
        flaser([1.0], robot=f"0 {0.4 * i} 1.5707963267948966", stamp=10.0 + 2.0 * i)
        for i in range(2)
    ]
    assert read(tmp_path, *north).odometry[1].twist.linear_x == pytest.approx(0.2)


def test_odom_lines_are_the_odometry_when_there_are_enough(tmp_path: Path) -> None:
    log = read(tmp_path, odom(1.0), flaser([1.0], stamp=1.5), odom(2.0, pose="3 4 7"))
    assert [message.stamp for message in log.odometry] == [1.0, 2.0]
    assert log.odometry[0].twist.linear_x == 0.3
    assert log.odometry[0].twist.angular_z == -0.1
    assert log.odometry[1].pose_odom == pytest.approx([3.0, 4.0, 7.0 - 2.0 * np.pi])


def test_few_odom_lines_give_way_to_the_scans_own_poses(tmp_path: Path) -> None:
    log = read(tmp_path, odom(1.0), *(flaser([1.0], stamp=stamp) for stamp in (2.0, 3.0)))
    assert [message.stamp for message in log.odometry] == [2.0, 3.0]


def test_a_log_whose_sensors_had_no_clock_has_the_loggers_times(tmp_path: Path) -> None:
    lines = [flaser([1.0], stamp=0.0, logger=logger) for logger in (0.5, 0.7)]
    assert [scan.stamp for scan in read(tmp_path, *lines).scans] == [0.5, 0.7]


def test_what_no_mapper_needs_is_skipped(tmp_path: Path) -> None:
    others = (
        "# comment with FLASER in it",
        "",
        "   ",
        "PARAM robot_frontlaser_use on",
        "PARAM robot_length 0.5 976052857.1 host 0.1",
        "SYNC tag 1.0 host 1.0",
        "RLASER 2 1 2",
        "TRUEPOS 1 2 3 4 5 6 1.0 host 1.0",
        "NMEAGGA 1 2 N 3 E",
        "IMU 1 2 3",
        "RAWLASER1 0 0",
        "\x00\xff garbage",
    )
    log = read(tmp_path, *others, flaser([1.0]), *others)
    assert len(log.scans) == 1
    assert len(log.imu) == 0


WHOLE = flaser([1.5, 2.5, 3.5], stamp=12.5)


@pytest.mark.parametrize("kept", range(len(WHOLE)))
def test_a_last_line_cut_anywhere_is_either_left_out_or_whole(tmp_path: Path, kept: int) -> None:
    scans = read(tmp_path, flaser([1.0], stamp=11.0), WHOLE[:kept], end="").scans
    assert len(scans) in (1, 2)
    if len(scans) == 2:
        assert scans[1].ranges.tolist() == [1.5, 2.5, 3.5]
        assert scans[1].stamp == 12.5


@pytest.mark.parametrize(
    "broken",
    [
        "FLASER 3 1.0 2.0",
        "FLASER three 1.0 2.0",
        "FLASER -1 1.0 0 0 0 0 0 0 1.0 host 1.0",
        "FLASER",
        "ODOM 1 2 x 0 0 0 1.0 host 1.0",
        "ODOM 1 2 3",
        "ROBOTLASER1 0 -1 2 0.5 4.0 0.01 0 3 1 1 1 5 1 1",
        robotlaser("3 1 1 1", settings="nan 2.0 0.5 4.0 0.01 0"),
        robotlaser("3 1 1 1", settings="-1.0 inf 0.0 4.0 0.01 0"),
        robotlaser("3 1 1 1", settings="-1.0 2.0 nan 4.0 0.01 0"),
        "PARAM robot_front_laser_max far",
    ],
)
def test_a_broken_line_in_the_middle_is_told_with_file_and_line(
    tmp_path: Path, broken: str
) -> None:
    with pytest.raises(TestbedError, match=r"a\.log: line 3: .*must be a whole \w+ line") as error:
        read(tmp_path, "# log", flaser([1.0]), broken, flaser([1.0]))
    assert "\n" not in str(error.value)
    assert len(read(tmp_path, "# log", flaser([1.0]), broken).scans) == 1, "survives as the last"


@pytest.mark.parametrize("text", ["", "# nothing\n", "nonsense 1 2 3\n", "PARAM a 1\n"])
def test_a_file_without_scans_and_odometry_is_no_log(tmp_path: Path, text: str) -> None:
    with pytest.raises(TestbedError, match=r"a\.log.*must be a CARMEN log"):
        read(tmp_path, text, end="")


def test_a_missing_file_is_told(tmp_path: Path) -> None:
    with pytest.raises(TestbedError, match=r"gone\.log: cannot be read"):
        read_carmen(tmp_path / "gone.log")


def test_poses_and_ranges_that_are_no_numbers_do_no_harm(tmp_path: Path) -> None:
    wrong = flaser([float("nan"), float("inf"), float("-inf")], laser="nan 0 0", robot="inf 0 nan")
    log = read(tmp_path, wrong, flaser([1.0], stamp=STAMP + 1.0))
    assert log.lidar_pose_base == (0.0, 0.0, 0.0)
    assert np.isnan(log.scans[0].ranges[0])
    assert len(log.odometry) == 2


@pytest.mark.parametrize("sensor", [(5.0, 5.0, 5.0), (1005.0, 6.0, 7.0)], ids=["stood", "set back"])
def test_a_sensors_clock_that_loses_scans_yields_to_the_loggers(
    tmp_path: Path, sensor: tuple[float, ...]
) -> None:
    lines = [flaser([1.0], stamp=t, logger=0.2 * k) for k, t in enumerate(sensor)]
    assert [scan.stamp for scan in read(tmp_path, *lines).scans] == [0.0, 0.2, 0.4]


def test_a_byte_order_mark_takes_no_line_away(tmp_path: Path) -> None:
    (tmp_path / "a.log").write_text("\ufeff" + flaser([1.0]) + "\n", encoding="utf-8")
    assert len(read_carmen(tmp_path / "a.log").scans) == 1
