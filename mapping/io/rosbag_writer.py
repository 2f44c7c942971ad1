"""Turns recorded runs into ROS 2 bags in MCAP, which ``ros2 bag play`` and Foxglove take."""

import heapq
import math
from collections.abc import Iterable, Iterator
from functools import partial
from pathlib import Path
from typing import Any

from mapping.errors import TestbedError
from mapping.io.atomic_folder import write_folder_atomically
from mapping.io.recorded_run import RecordedRun, StaticFrame
from mapping.io.ros_library import (
    COMMAND_TOPIC,
    IMU_TOPIC,
    MAP_TOPIC,
    NANOSECONDS,
    ODOMETRY_TOPIC,
    SCAN_TOPIC,
    TF_STATIC_TOPIC,
    TF_TOPIC,
    message_types,
)
from mapping.io.ros_messages import RosMessages

BAG_VERSION = 8
"""Layout of metadata.yaml: the newest that Humble's ros2 bag reads; 9 changed how QoS is told."""

LATCHED_TOPICS = (MAP_TOPIC, TF_STATIC_TOPIC)
"""Topics whose last message later subscribers get too."""

FOREVER = (9223372036, 854775807)
"""How rosbag2 writes an unlimited duration: seconds and nanoseconds."""

Event = tuple[int, str, Any]
"""When a message is published [ns], its topic, the message."""


def write_rosbag(path: str | Path, run: RecordedRun) -> None:
    """Write a run as a bag with /scan /odom /imu /tf /tf_static /cmd_vel /map.

    Frames are map -> odom -> base_footprint -> base_link -> base_scan, imu_link (REP-105). Every
    message has its own stamp in its header; it is logged when it was complete, so a scan at its
    last beam. Chunks are compressed with zstd.

    Args:
        path: The bag's folder, or a file that ends in .mcap, which has no metadata.yaml beside it.
        run: What to write; a topic without messages is left out.

    Raises:
        TestbedError: The rosbags library is missing, the place cannot be written, or a stamp is
            negative or not finite.
    """
    path = Path(path)
    write = _write_file if path.suffix == ".mcap" else _write_folder
    write_folder_atomically(path, partial(write, run=run, messages=RosMessages(message_types())))


def _write_file(path: Path, *, run: RecordedRun, messages: RosMessages) -> None:
    """Write a folder and take its one file out of it."""
    folder = path.with_suffix("")
    _write_folder(folder, run=run, messages=messages)
    (folder / path.name).rename(path)


def _write_folder(path: Path, *, run: RecordedRun, messages: RosMessages) -> None:
    from rosbags.rosbag2 import CompressionFormat, CompressionMode, StoragePlugin, Writer

    bag = Writer(path, version=BAG_VERSION, storage_plugin=StoragePlugin.MCAP)
    bag.set_compression(CompressionMode.STORAGE, CompressionFormat.ZSTD)
    connections: dict[str, Any] = {}
    with bag:
        for when, topic, message in _events(run, messages):
            kind = message.__msgtype__
            if topic not in connections:
                connections[topic] = bag.add_connection(
                    topic,
                    kind,
                    typestore=messages.store,
                    offered_qos_profiles=[_latched()] if topic in LATCHED_TOPICS else [],
                )
            bag.write(connections[topic], when, messages.store.serialize_cdr(message, kind))


def _latched() -> Any:
    """Quality of service of a topic whose last message is kept for later subscribers."""
    from rosbags import interfaces as ros

    forever = ros.QosTime(*FOREVER)
    return ros.Qos(
        history=ros.QosHistory.KEEP_LAST,
        depth=1,
        reliability=ros.QosReliability.RELIABLE,
        durability=ros.QosDurability.TRANSIENT_LOCAL,
        deadline=forever,
        lifespan=forever,
        liveliness=ros.QosLiveliness.AUTOMATIC,
        liveliness_lease_duration=forever,
        avoid_ros_namespace_conventions=False,
    )


def _events(run: RecordedRun, messages: RosMessages) -> Iterator[Event]:
    """All messages in the order in which they were published."""
    streams = [
        _in_time(_odometry(run, messages)),
        _in_time(_imu(run, messages)),
        _in_time(_scans(run, messages)),
        _in_time(_map_from_odom(run, messages)),
        _in_time(_commands(run, messages)),
        _in_time(_maps(run, messages)),
    ]
    moving = heapq.merge(*streams, key=lambda event: event[0])
    first = next(moving, None)
    if first is not None:
        yield first[0], TF_STATIC_TOPIC, messages.static_frames(first[0], _frames(run))
        yield first
        yield from moving


def _in_time(events: Iterable[Event]) -> Iterator[Event]:
    """A topic's messages, logged no earlier than the one before: a bag's clock only goes on."""
    latest = 0
    for when, topic, message in events:
        latest = max(latest, when)
        yield latest, topic, message


def _odometry(run: RecordedRun, messages: RosMessages) -> Iterator[Event]:
    for each in run.log.odometry:
        when = nanoseconds(each.stamp)
        yield when, ODOMETRY_TOPIC, messages.odometry(when, each)
        yield when, TF_TOPIC, messages.odom_to_base(when, each.pose_odom)


def _imu(run: RecordedRun, messages: RosMessages) -> Iterator[Event]:
    for each in run.log.imu:
        when = nanoseconds(each.stamp)
        yield when, IMU_TOPIC, messages.imu(when, each)


def _scans(run: RecordedRun, messages: RosMessages) -> Iterator[Event]:
    for scan in run.log.scans:
        end = scan.stamp + max(len(scan.ranges) - 1, 0) * scan.time_increment
        yield nanoseconds(end), SCAN_TOPIC, messages.scan(nanoseconds(scan.stamp), scan)


def _map_from_odom(run: RecordedRun, messages: RosMessages) -> Iterator[Event]:
    for row in run.map_from_odom:
        when = nanoseconds(row[0])
        yield when, TF_TOPIC, messages.map_to_odom(when, row[1:])


def _commands(run: RecordedRun, messages: RosMessages) -> Iterator[Event]:
    for stamp, linear, angular in run.commands.tolist():
        yield nanoseconds(stamp), COMMAND_TOPIC, messages.command(linear, angular)


def _maps(run: RecordedRun, messages: RosMessages) -> Iterator[Event]:
    for stamp, drawn in run.maps:
        when = nanoseconds(stamp)
        yield when, MAP_TOPIC, messages.map(when, drawn)


def _frames(run: RecordedRun) -> tuple[StaticFrame, ...]:
    """The frames on the robot; those that are not known are told from the lidar's pose."""
    if run.frames:
        return run.frames
    x, y, yaw = run.log.lidar_pose_base
    return (
        StaticFrame(parent="base_footprint", child="base_link", position=(0.0, 0.0, 0.0)),
        StaticFrame(parent="base_link", child="base_scan", position=(x, y, 0.0), yaw=yaw),
    )


def nanoseconds(stamp: float) -> int:
    """A stamp as ROS has it, whole nanoseconds since 0.

    Raises:
        TestbedError: It is negative or not finite.
    """
    if not 0.0 <= stamp < math.inf:
        raise TestbedError(f"stamp: {stamp} s; must be finite and 0 or more to go into a ROS bag")
    return round(float(stamp) * NANOSECONDS)
