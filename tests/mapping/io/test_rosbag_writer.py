"""Bags that are written, seen by a reader that is not ours."""

import struct
from collections import Counter
from pathlib import Path

import numpy as np
import pytest
import yaml
from mcap.reader import make_reader

from mapping.errors import TestbedError
from mapping.io.map_server import MapFile
from mapping.io.recorded_run import RecordedRun, StaticFrame
from mapping.io.rosbag_writer import write_rosbag
from mapping.messages import LaserScan
from mapping.sensor_log import SensorLog
from tests.mapping.io.logs import driven_log

STATES = np.array([[-1, 0, 100], [0, 0, -1]], dtype=np.int8)


def whole_run() -> RecordedRun:
    drawn = MapFile(resolution=0.05, origin=(-1.5, 2.5), states=STATES)
    times = np.arange(0.1, 2.0, 0.1)
    return RecordedRun(
        log=driven_log(),
        commands=np.column_stack((times, np.full_like(times, 0.2), np.full_like(times, -0.5))),
        map_from_odom=np.column_stack((times, np.tile([1.0, 2.0, np.pi / 2], (len(times), 1)))),
        maps=[(0.5, drawn), (1.9, drawn)],
        frames=(StaticFrame(parent="base_link", child="base_scan", position=(-0.032, 0.0, 0.172)),),
    )


def messages(path: Path) -> list[tuple[str, str, int, bytes]]:
    """Topic, type, log time and bytes of every message, in the order of the file."""
    with path.open("rb") as file:
        return [
            (channel.topic, schema.name, message.log_time, message.data)
            for schema, channel, message in make_reader(file).iter_messages(log_time_order=False)
        ]


def test_an_independent_reader_finds_every_topic_with_its_type_and_messages(tmp_path: Path) -> None:
    write_rosbag(tmp_path / "bag", whole_run())
    assert {path.name for path in (tmp_path / "bag").iterdir()} == {"bag.mcap", "metadata.yaml"}
    found = messages(tmp_path / "bag" / "bag.mcap")
    assert Counter((topic, kind) for topic, kind, *_ in found) == {
        ("/scan", "sensor_msgs/msg/LaserScan"): 10,
        ("/odom", "nav_msgs/msg/Odometry"): 60,
        ("/imu", "sensor_msgs/msg/Imu"): 200,
        ("/tf", "tf2_msgs/msg/TFMessage"): 60 + 19,
        ("/tf_static", "tf2_msgs/msg/TFMessage"): 1,
        ("/cmd_vel", "geometry_msgs/msg/Twist"): 19,
        ("/map", "nav_msgs/msg/OccupancyGrid"): 2,
    }
    assert np.all(np.diff([when for _, _, when, _ in found]) >= 0)
    assert found[0][0] == "/tf_static", "whoever listens needs the frames first"


def test_the_metadata_counts_the_same_messages_in_a_layout_that_humble_reads(
    tmp_path: Path,
) -> None:
    write_rosbag(tmp_path / "bag", whole_run())
    metadata = yaml.safe_load((tmp_path / "bag" / "metadata.yaml").read_text())
    told = metadata["rosbag2_bagfile_information"]
    assert told["version"] <= 8
    assert told["storage_identifier"] == "mcap"
    assert told["relative_file_paths"] == ["bag.mcap"]
    assert told["message_count"] == len(messages(tmp_path / "bag" / "bag.mcap"))
    latched = {
        each["topic_metadata"]["name"]
        for each in told["topics_with_message_count"]
        if "durability: 1" in each["topic_metadata"]["offered_qos_profiles"]
    }
    assert latched == {"/map", "/tf_static"}


def test_a_scan_is_laid_out_as_ros_lays_it_out(tmp_path: Path) -> None:
    ranges = np.array([1.25, np.inf, 0.0, np.nan], dtype=np.float32)
    scan = LaserScan(stamp=1234567890.123456, ranges=ranges, angle_min=-0.5, scan_time=0.25)
    write_rosbag(
        tmp_path / "a.mcap", RecordedRun(log=SensorLog(source="a", scans=[scan], odometry=[]))
    )
    assert [path.name for path in tmp_path.iterdir()] == ["a.mcap"]
    (_, _, when, data) = next(each for each in messages(tmp_path / "a.mcap") if each[0] == "/scan")
    little_endian_cdr, seconds, nanoseconds, length = struct.unpack_from("<IiII", data)
    assert little_endian_cdr == 0x0100
    assert seconds == 1234567890
    assert nanoseconds == pytest.approx(123456000, abs=200), "a float64 resolves 0.2 us here"
    assert data[16 : 16 + length] == b"base_scan\x00"
    fields = struct.unpack_from("<7fI4fI", data, 16 + 12)  # the name is padded to 12 bytes
    assert fields[:3] == pytest.approx((-0.5, -0.5 + 3 * np.pi / 180, np.pi / 180))
    assert fields[3:7] == pytest.approx((1 / 1800, 0.25, 0.12, 3.5))
    assert fields[7] == 4
    assert np.array_equal(np.array(fields[8:12], dtype=np.float32), ranges, equal_nan=True)
    assert fields[12] == 0, "no intensities"
    assert when == pytest.approx((scan.stamp + 3 / 1800) * 1e9, abs=1e3), "logged when complete"


def test_a_map_is_told_row_by_row_from_its_origin(tmp_path: Path) -> None:
    write_rosbag(tmp_path / "bag", whole_run())
    data = next(
        data for topic, *_, data in messages(tmp_path / "bag" / "bag.mcap") if topic == "/map"
    )
    resolution, width, height = struct.unpack_from("<fII", data, 4 + 8 + 4 + 4 + 8)
    assert (resolution, width, height) == (np.float32(0.05), 3, 2)
    assert list(struct.unpack("<6b", data[-6:])) == STATES.ravel().tolist()


def test_writing_again_replaces_the_bag_and_gives_the_same_bytes(tmp_path: Path) -> None:
    written = []
    for _ in range(2):
        write_rosbag(tmp_path / "bag", whole_run())
        written.append((tmp_path / "bag" / "bag.mcap").read_bytes())
    assert written[0] == written[1]
    assert [path.name for path in tmp_path.iterdir()] == ["bag"]


@pytest.mark.parametrize("stamp", [-1.0, np.nan, np.inf])
def test_a_stamp_that_ros_cannot_tell_leaves_the_former_bag(tmp_path: Path, stamp: float) -> None:
    write_rosbag(tmp_path / "bag", whole_run())
    scan = LaserScan(stamp=stamp, ranges=np.ones(3, dtype=np.float32))
    wrong = RecordedRun(log=SensorLog(source="a", scans=[scan], odometry=[]))
    with pytest.raises(TestbedError, match=r"stamp: .*must be finite"):
        write_rosbag(tmp_path / "bag", wrong)
    assert len(messages(tmp_path / "bag" / "bag.mcap")) > 100
    assert [path.name for path in tmp_path.iterdir()] == ["bag"]


def test_a_folder_that_is_not_there_is_told(tmp_path: Path) -> None:
    with pytest.raises(TestbedError, match="cannot be written"):
        write_rosbag(tmp_path / "gone" / "bag", whole_run())
