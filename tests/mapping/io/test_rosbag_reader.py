"""ROS 2 bags as robots and simulators leave them."""

import sys
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from rosbags.rosbag2 import StoragePlugin, Writer

from mapping.errors import TestbedError
from mapping.io.recorded_run import RecordedRun, StaticFrame
from mapping.io.ros_library import message_types
from mapping.io.ros_messages import RosMessages
from mapping.io.rosbag_reader import read_rosbag
from mapping.io.rosbag_writer import write_rosbag
from mapping.messages import Imu, LaserScan, Odometry
from mapping.sensor_log import SensorLog
from tests.mapping.io.logs import driven_log, logs, meanings

MAKE = RosMessages(message_types())


def write(path: Path, *messages: tuple[str, Any], storage: StoragePlugin) -> None:
    """A bag of messages, one a second on the clock of whoever recorded them."""
    connections = {}
    with Writer(path, version=9, storage_plugin=storage) as bag:
        for when, (topic, message) in enumerate(messages):
            kind = message.__msgtype__
            if topic not in connections:
                connections[topic] = bag.add_connection(topic, kind, typestore=MAKE.store)
            bag.write(connections[topic], when, MAKE.store.serialize_cdr(message, kind))


def bag(folder: Path, *messages: tuple[str, Any]) -> SensorLog:
    write(folder / "bag", *messages, storage=StoragePlugin.MCAP)
    return read_rosbag(folder / "bag")


def scan(stamp_ns: int = 5_500_000_000, frame: str = "base_scan", ranges: Any = (1.0, 2.0)) -> Any:
    message = MAKE.scan(stamp_ns, LaserScan(stamp=0.0, ranges=np.array(ranges, dtype=np.float32)))
    message.header.frame_id = frame
    return message


def odometry(x: float = 1.0, child: str = "base_footprint") -> Any:
    source = driven_log().odometry[0]
    message = MAKE.odometry(
        5_500_000_000, Odometry(stamp=0.0, pose_odom=np.array([x, 0.0, 0.5]), twist=source.twist)
    )
    message.child_frame_id = child
    return message


def link(parent: str, child: str, x: float, yaw: float = 0.0, when: int = 0) -> Any:
    frame = StaticFrame(parent=parent, child=child, position=(x, 0.0, 0.1), yaw=yaw)
    return MAKE.static_frames(when, [frame])


@settings(max_examples=15)
@given(logs())
def test_a_log_comes_back_from_a_bag_as_it_was(log: SensorLog) -> None:
    with TemporaryDirectory() as folder:
        write_rosbag(Path(folder) / "bag", RecordedRun(log=log))
        again = read_rosbag(Path(folder) / "bag")
    for before, after in zip(log.scans, again.scans, strict=True):
        assert after.stamp == pytest.approx(before.stamp, abs=1e-6, rel=0.0)
        assert after.angles == pytest.approx(before.angles, abs=1e-5), "float32 in the message"
        assert after.time_increment == pytest.approx(before.time_increment)
        (nothing, ranges), (nothing_after, ranges_after) = meanings(before), meanings(after)
        assert np.array_equal(nothing, nothing_after)
        assert np.allclose(ranges, ranges_after, rtol=1e-6, atol=0.0), "a hit at the very maximum"
    for before, after in zip(log.odometry, again.odometry, strict=True):
        assert after.stamp == pytest.approx(before.stamp, abs=1e-6, rel=0.0)
        assert after.pose_odom == pytest.approx(before.pose_odom, abs=1e-9)
        assert after.twist == before.twist
    for before, after in zip(log.imu, again.imu, strict=True):
        assert np.array_equal(after.orientation, before.orientation)
        assert np.array_equal(after.linear_acceleration, before.linear_acceleration)
    assert again.lidar_pose_base == pytest.approx(log.lidar_pose_base, abs=1e-9)


@pytest.mark.parametrize("storage", list(StoragePlugin))
def test_both_storages_are_read_as_folders_and_as_bare_files(
    tmp_path: Path, storage: StoragePlugin
) -> None:
    messages = (
        ("/scan", scan()),
        ("/odom", odometry()),
        ("/tf_static", link("base_footprint", "base_scan", 0.3)),
    )
    write(tmp_path / "bag", *messages, storage=storage)
    (file,) = (path for path in (tmp_path / "bag").iterdir() if path.name != "metadata.yaml")
    for path in (tmp_path / "bag", file):
        log = read_rosbag(path)
        assert log.scans[0].stamp == 5.5, "the header's, not the recorder's"
        assert log.scans[0].ranges.tolist() == [1.0, 2.0]
        assert log.lidar_pose_base == (0.3, 0.0, 0.0)
    (tmp_path / "bag" / "metadata.yaml").unlink()
    assert len(read_rosbag(tmp_path / "bag").scans) == 1, "a recorder that was killed writes none"


def test_topics_are_found_behind_a_namespace_and_by_their_type(tmp_path: Path) -> None:
    topics = (
        ("/robot1/scan", scan()),
        ("/wheels", odometry(7.0)),
        ("/robot1/tf_static", link("robot1/base_link", "base_scan", 0.2)),
    )
    log = bag(tmp_path, *topics)
    assert len(log.scans) == 1
    assert log.odometry[0].pose_odom[0] == 7.0
    assert log.lidar_pose_base == (0.2, 0.0, 0.0)


def test_the_plain_name_is_preferred_to_others_of_its_type(tmp_path: Path) -> None:
    topics = (("/truth", odometry(1.0)), ("/odom", odometry(2.0)), ("/scan", scan()))
    assert bag(tmp_path, *topics).odometry[0].pose_odom[0] == 2.0


def test_several_topics_that_might_be_meant_are_told(tmp_path: Path) -> None:
    with pytest.raises(TestbedError, match=r"/a/scan, /b/scan; must be one, or one of them /scan"):
        bag(tmp_path, ("/a/scan", scan()), ("/b/scan", scan()))
    assert len(read_rosbag(tmp_path / "bag", scan_topic="/b/scan").scans) == 1


def test_a_bag_without_scans_is_told_with_what_it_has(tmp_path: Path) -> None:
    with pytest.raises(TestbedError, match=r"no sensor_msgs/msg/LaserScan.*topics: /odom"):
        bag(tmp_path, ("/odom", odometry()))


def test_the_lidars_pose_goes_over_all_links_between_robot_and_lidar(tmp_path: Path) -> None:
    log = bag(
        tmp_path,
        ("/scan", scan(frame="laser")),
        ("/odom", odometry()),
        ("/tf_static", link("/base_footprint", "base_link", 0.1, yaw=np.pi / 2)),
        ("/tf_static", link("base_link", "mast", 0.2)),
        ("/tf", link("mast", "laser", 0.0, yaw=0.5)),
        ("/tf", link("mast", "laser", 9.0, yaw=0.9)),
    )
    assert log.lidar_pose_base == pytest.approx((0.1, 0.2, np.pi / 2 + 0.5))


def test_a_lidar_upside_down_turns_the_other_way(tmp_path: Path) -> None:
    rolled = link("base_link", "base_scan", 0.1)
    rolled.transforms[0].transform.rotation = MAKE.store.types["geometry_msgs/msg/Quaternion"](
        1.0, 0.0, 0.0, 0.0
    )
    log = bag(tmp_path, ("/scan", scan()), ("/tf_static", rolled))
    assert log.scans[0].angles == pytest.approx([0.0, -np.pi / 180])
    assert log.lidar_pose_base == pytest.approx((0.1, 0.0, 0.0))


def imu(rate: float, down: float) -> Any:
    message = MAKE.imu(
        5_500_000_000,
        Imu(
            stamp=0.0,
            orientation=np.array([0.0, 0.0, 0.0, 1.0]),
            angular_velocity=np.array([0.0, 0.1, rate]),
            linear_acceleration=np.array([0.0, 0.0, down]),
        ),
    )
    message.header.frame_id = "imu_link"
    return message


def test_an_imu_upside_down_is_turned_into_the_robots_frame(tmp_path: Path) -> None:
    rolled = link("base_link", "imu_link", 0.1)
    rolled.transforms[0].transform.rotation = MAKE.store.types["geometry_msgs/msg/Quaternion"](
        1.0, 0.0, 0.0, 0.0
    )
    log = bag(tmp_path, ("/scan", scan()), ("/tf_static", rolled), ("/imu", imu(-0.5, -9.8)))
    assert log.imu[0].angular_velocity == pytest.approx([0.0, -0.1, 0.5])
    assert log.imu[0].linear_acceleration == pytest.approx([0.0, 0.0, 9.8])


def test_an_imu_without_a_gyroscope_is_none(tmp_path: Path) -> None:
    silent = imu(0.0, 9.8)
    silent.angular_velocity_covariance = np.array([-1.0] + [0.0] * 8)
    assert not bag(tmp_path, ("/scan", scan()), ("/imu", silent)).imu


@pytest.mark.parametrize("step", [0.0, np.nan])
def test_beams_that_look_nowhere_are_refused(tmp_path: Path, step: float) -> None:
    blind = scan()
    blind.angle_increment = step
    with pytest.raises(TestbedError, match=r"angle_increment .*must be finite"):
        bag(tmp_path, ("/scan", blind))


def test_without_transforms_the_lidar_is_taken_to_be_the_robot_and_a_warning_says_so(
    tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    log = bag(tmp_path, ("/scan", scan()), ("/odom", odometry()))
    assert log.lidar_pose_base == (0.0, 0.0, 0.0)
    assert "no transform" in caplog.text


def test_a_bag_without_odometry_is_not_warned_of_besides(
    tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    assert bag(tmp_path, ("/scan", scan())).odometry == []
    assert caplog.text == ""


def test_without_an_odometry_topic_the_transforms_tell_it(tmp_path: Path) -> None:
    steps = [link("odom", "base_footprint", 0.5 * i, when=2_000_000_000 * i) for i in range(3)]
    others = [link("map", "odom", 9.0), link("odom", "marker", 9.0)]
    topics = [("/tf", each) for each in [*others, *steps]]
    lidar = ("/tf_static", link("base_footprint", "base_scan", 0.3))
    log = bag(tmp_path, ("/scan", scan()), *topics, lidar)
    assert [message.stamp for message in log.odometry] == [0.0, 2.0, 4.0]
    assert [message.pose_odom[0] for message in log.odometry] == [0.0, 0.5, 1.0]
    assert [message.twist.linear_x for message in log.odometry] == [0.0, 0.25, 0.25]
    assert log.lidar_pose_base == (0.3, 0.0, 0.0)


def test_ranges_and_angles_keep_their_meaning(tmp_path: Path) -> None:
    ranges = [np.inf, -np.inf, np.nan, 0.0, 3.4, 1.0]
    read = bag(tmp_path, ("/scan", scan(ranges=ranges))).scans[0]
    assert np.array_equal(read.ranges, np.array(ranges, dtype=np.float32), equal_nan=True)
    assert read.time_increment == pytest.approx(1 / 1800)
    read.ranges[0] = 1.0  # must be a copy of its own, not a view of the file's bytes


def test_ranges_at_and_beyond_the_maximum_mean_that_nothing_was_there(tmp_path: Path) -> None:
    message = scan()
    message.ranges = np.array([3.49, 3.5, 4.5, np.nan, 0.0], dtype=np.float32)
    message.range_max = np.float32(3.5)
    unknown_maximum = scan(ranges=(4.5,))
    unknown_maximum.range_max = 0.0
    log = bag(tmp_path, ("/scan", message), ("/scan", unknown_maximum))
    expected = np.array([3.49, np.inf, np.inf, np.nan, 0.0], dtype=np.float32)
    assert np.array_equal(log.scans[0].ranges, expected, equal_nan=True)
    assert log.scans[1].ranges.tolist() == [4.5]


def test_a_maximum_without_bound_makes_no_hits_of_nothing(tmp_path: Path) -> None:
    endless = LaserScan(stamp=0.0, ranges=np.float32([np.inf, 4.5]), range_max=np.inf)
    assert bag(tmp_path, ("/scan", MAKE.scan(0, endless))).scans[0].ranges.tolist() == [np.inf, 4.5]


def test_a_transform_that_is_not_finite_is_left_out(tmp_path: Path) -> None:
    wrong = link("base_link", "base_scan", np.nan)
    right = link("base_link", "base_scan", 0.4)
    log = bag(tmp_path, ("/scan", scan()), ("/tf_static", wrong), ("/tf_static", right))
    assert log.lidar_pose_base == (0.4, 0.0, 0.0)


def test_a_broken_bag_is_told_in_one_line(tmp_path: Path) -> None:
    write_rosbag(tmp_path / "a.mcap", RecordedRun(log=driven_log()))
    whole = (tmp_path / "a.mcap").read_bytes()
    middle = len(whole) // 2
    for broken in (b"", b"no bag", whole[:middle], whole[:middle] + bytes(99) + whole[middle:]):
        (tmp_path / "b.mcap").write_bytes(broken)
        with pytest.raises(TestbedError, match=r"b\.mcap: cannot be read") as error:
            read_rosbag(tmp_path / "b.mcap")
        assert "\n" not in str(error.value)


@pytest.mark.parametrize(
    ("name", "told"),
    [("gone.mcap", "no such file"), ("a.bag", "rosbags-convert"), ("folder", "no metadata.yaml")],
)
def test_what_is_no_bag_is_told(tmp_path: Path, name: str, told: str) -> None:
    (tmp_path / "folder").mkdir()
    (tmp_path / "a.bag").write_bytes(b"#ROSBAG V2.0\n")
    with pytest.raises(TestbedError, match=told):
        read_rosbag(tmp_path / name)


def test_without_the_library_the_error_says_how_to_get_it(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, "rosbags.rosbag2", None)
    with pytest.raises(TestbedError, match=r"pip install 'burger-testbed\[ros\]'"):
        read_rosbag(tmp_path)
