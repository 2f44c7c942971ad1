"""Turns ROS 2 bags into sensor logs: folders with SQLite or MCAP files, and bare such files."""

import logging
import math
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from mapping.errors import TestbedError
from mapping.geometry import Pose
from mapping.io.range_limits import without_codes
from mapping.io.ros_frames import FrameTree, Transform, plain_name, transform, yaw_of
from mapping.io.ros_library import (
    IMU,
    IMU_TOPIC,
    LASER_SCAN,
    NANOSECONDS,
    ODOMETRY,
    ODOMETRY_TOPIC,
    SCAN_TOPIC,
    TF_MESSAGE,
    TF_STATIC_TOPIC,
    message_types,
    require_rosbags,
)
from mapping.io.ros_mounting import turned_over, upright
from mapping.messages import Imu, LaserScan, Odometry, Twist
from mapping.odometry_from_poses import odometry_from_poses
from mapping.sensor_log import SensorLog

BASE_FRAMES = ("base_footprint", "base_link")
"""The robot's own frame, by the names it may have, the first preferred (REP-105, REP-120)."""

ODOM_FRAME = "odom"
"""The frame in which odometry tells the robot's pose (REP-105)."""

STORAGES = (".mcap", ".db3")
"""Endings of the files that hold a bag's messages."""

NOT_MEASURED = -1.0
"""What the first element of a covariance is when a message does not tell the quantity."""

LOGGER = logging.getLogger(__name__)


def read_rosbag(
    path: str | Path,
    *,
    scan_topic: str = SCAN_TOPIC,
    odometry_topic: str = ODOMETRY_TOPIC,
    imu_topic: str = IMU_TOPIC,
) -> SensorLog:
    """Read the laser scans, odometry and IMU messages of a bag.

    Stamps are those of the messages' headers. A topic that is not there under its name is looked
    for behind any namespace, then by its type. Without a topic of odometry, odometry comes from the
    transforms from odom to the robot. The lidar's pose on the robot comes from the transforms; a
    bag without them leaves it at zero, and a warning in the log.

    Ranges mean what they mean in the message: ``+inf`` nothing there, 0.0 and NaN a failed beam.
    One at or beyond a ``range_max`` above 0 becomes ``+inf``, as drivers from before REP-117 meant
    it. A lidar mounted upside down gets angles that run backwards. What an IMU measured is turned
    into the robot's frame by the transforms, if they tell how it is mounted; one that says by its
    covariance that it has no gyroscope is left out.

    Args:
        path: A bag's folder, or one .mcap or .db3 file.
        scan_topic: Topic of sensor_msgs/LaserScan.
        odometry_topic: Topic of nav_msgs/Odometry.
        imu_topic: Topic of sensor_msgs/Imu.

    Raises:
        TestbedError: The rosbags library is missing, the bag cannot be read, it holds no scan, or
            several topics might be meant, or a scan does not say where its beams look.
    """
    require_rosbags()
    from rosbags.rosbag2 import Reader

    path = Path(path)
    try:
        with Reader(_storage(path)) as reader:
            return _Bag(path, reader).sensor_log(scan_topic, odometry_topic, imu_topic)
    except TestbedError:
        raise
    except Exception as error:  # on a broken file the library raises whatever its parser met
        reason = " ".join(str(error).split()) or type(error).__name__
        raise TestbedError(
            f"{path}: cannot be read ({reason}); must be a whole ROS 2 bag"
        ) from error


def _storage(path: Path) -> Path:
    """What the library can open: the path, or the one file of a bag that was never closed."""
    if not path.exists():
        raise TestbedError(f"{path}: no such file or folder; must be a ROS 2 bag or .mcap file")
    if path.is_dir() and not (path / "metadata.yaml").exists():
        files = sorted(file for file in path.iterdir() if file.suffix in STORAGES)
        if len(files) != 1:
            raise TestbedError(f"{path}: no metadata.yaml; must be the folder of a ROS 2 bag")
        return files[0]
    if path.is_file() and path.suffix not in STORAGES:
        raise TestbedError(
            f"{path}: ends in {path.suffix!r}; must be a bag's folder, or end in .mcap or .db3 "
            "(rosbags-convert turns a ROS 1 bag into a ROS 2 one)"
        )
    return path


class _Bag:
    """An open bag."""

    def __init__(self, path: Path, reader: Any) -> None:
        self.path, self.reader = path, reader
        self.types = message_types()

    def sensor_log(self, scan_topic: str, odometry_topic: str, imu_topic: str) -> SensorLog:
        """The messages of three topics; see ``read_rosbag``."""
        scan_source = self.topic(LASER_SCAN, scan_topic)
        odometry_source = self.topic(ODOMETRY, odometry_topic)
        if not scan_source:
            topics = ", ".join(sorted({each.topic for each in self.reader.connections})) or "none"
            raise TestbedError(f"{self.path}: no {LASER_SCAN}; must hold one (topics: {topics})")
        scans, scan_frames = self.read(scan_source, _scan)
        odometry, bases = self.read(odometry_source, _odometry)
        self._check_angles(scans)
        imu, imu_frames = self.read(self.topic(IMU, imu_topic), _imu)
        tree = FrameTree()
        for link in self.transforms(static=True):
            _add(tree, link)
        lidar = tree.find(scan_frames[0], (*bases[:1], *BASE_FRAMES)) if scan_frames else None
        if lidar is None or not odometry_source:
            moving = list(self.transforms(static=False))
            for link in moving:
                _add(tree, link)
            if not odometry_source:
                odometry, bases = _odometry_of_transforms(moving)
            lidar = tree.find(scan_frames[0], (*bases[:1], *BASE_FRAMES)) if scan_frames else None
        if lidar is None:
            if odometry:  # else there is nothing to map, which is told instead
                LOGGER.warning("%s: no transform from robot to lidar; taken as zero", self.path)
            lidar = np.eye(4)
        mount = tree.find(imu_frames[0], (*bases[:1], *BASE_FRAMES)) if imu_frames else None
        told = [message for message in imu if message is not None]
        return SensorLog(
            source=str(self.path),
            scans=[turned_over(scan) for scan in scans] if lidar[2, 2] < 0.0 else scans,
            odometry=odometry,
            imu=told if mount is None else [upright(message, mount) for message in told],
            lidar_pose_base=(float(lidar[0, 3]), float(lidar[1, 3]), yaw_of(lidar)),
        )

    def _check_angles(self, scans: Sequence[LaserScan]) -> None:
        """Refuse scans that do not say where their beams look."""
        for scan in scans:
            step = scan.angle_increment
            if len(scan.ranges) > 1 and not (math.isfinite(step * scan.angle_min) and step != 0.0):
                raise TestbedError(
                    f"{self.path}: scan at {scan.stamp:.3f} s: angle_min {scan.angle_min:g}, "
                    f"angle_increment {step:g}; must be finite, and the increment not 0"
                )

    def topic(self, message_type: str, name: str) -> list[Any]:
        """The connections of the one topic of a type that is meant; none when there is none."""
        sources = [each for each in self.reader.connections if each.msgtype == message_type]
        names = sorted({source.topic for source in sources if source.msgcount > 0})
        behind_namespace = [each for each in names if each.endswith(name)]
        for candidates in ([each for each in names if each == name], behind_namespace, names):
            if len(candidates) == 1:
                return [source for source in sources if source.topic == candidates[0]]
            if candidates:
                raise TestbedError(
                    f"{self.path}: several topics of {message_type}: {', '.join(candidates)}; "
                    f"must be one, or one of them {name}"
                )
        return []

    def read(
        self, sources: Sequence[Any], convert: Callable[[Any], Any]
    ) -> tuple[list[Any], list[str]]:
        """The messages of a topic, and the frames that they name."""
        messages: list[Any] = []
        frames: list[str] = []
        for message in self.messages(sources):
            messages.append(convert(message))
            if not frames:
                frames.append(getattr(message, "child_frame_id", "") or message.header.frame_id)
        return messages, frames

    def transforms(self, *, static: bool) -> Iterator[Any]:
        """The transforms of the topics /tf_static or of those that are not, namespaced or not."""
        sources = [
            each
            for each in self.reader.connections
            if each.msgtype == TF_MESSAGE and each.topic.endswith(TF_STATIC_TOPIC) == static
        ]
        for message in self.messages(sources):
            yield from message.transforms

    def messages(self, sources: Sequence[Any]) -> Iterator[Any]:
        """The messages of some connections; without any, none."""
        if sources:
            for source, _, data in self.reader.messages(connections=sources):
                yield self.types.deserialize_cdr(data, source.msgtype)


def _seconds(stamp: Any) -> float:
    """A builtin_interfaces/Time [s]."""
    return float((stamp.sec * NANOSECONDS + stamp.nanosec) / NANOSECONDS)


def _scan(message: Any) -> LaserScan:
    ranges = np.array(message.ranges, dtype=np.float32)
    return LaserScan(
        stamp=_seconds(message.header.stamp),
        ranges=without_codes(ranges, message.range_max),
        angle_min=float(message.angle_min),
        angle_increment=float(message.angle_increment),
        time_increment=float(message.time_increment),
        scan_time=float(message.scan_time),
        range_min=float(message.range_min),
        range_max=float(message.range_max),
    )


def _odometry(message: Any) -> Odometry:
    velocity = message.twist.twist
    return Odometry(
        stamp=_seconds(message.header.stamp),
        pose_odom=_planar(_transform(message.pose.pose.position, message.pose.pose.orientation)),
        twist=Twist(linear_x=float(velocity.linear.x), angular_z=float(velocity.angular.z)),
    )


def _imu(message: Any) -> Imu | None:
    """An IMU's message, None if it says that there is no gyroscope (sensor_msgs/Imu: -1)."""
    if message.angular_velocity_covariance[0] == NOT_MEASURED:
        return None
    return Imu(
        stamp=_seconds(message.header.stamp),
        orientation=np.array(_xyzw(message.orientation)),
        angular_velocity=np.array(_xyz(message.angular_velocity)),
        linear_acceleration=np.array(_xyz(message.linear_acceleration)),
    )


def _add(tree: FrameTree, link: Any) -> None:
    """Put a geometry_msgs/TransformStamped into a tree."""
    pose = link.transform
    tree.add(
        link.header.frame_id, link.child_frame_id, _xyz(pose.translation), _xyzw(pose.rotation)
    )


def _odometry_of_transforms(links: Sequence[Any]) -> tuple[list[Odometry], list[str]]:
    """Odometry from the transforms from odom to the robot, and the robot's frame."""
    found = [link for link in links if _last(link.header.frame_id) == ODOM_FRAME]
    if not found:
        return [], []
    children = [link.child_frame_id for link in found]
    base = next((each for name in BASE_FRAMES for each in children if _last(each) == name), "")
    links = [link for link in found if link.child_frame_id == (base or children[0])]
    stamps = np.array([_seconds(link.header.stamp) for link in links])
    poses = [
        _planar(_transform(link.transform.translation, link.transform.rotation)) for link in links
    ]
    return odometry_from_poses(stamps, np.array(poses)), [base or children[0]]


def _last(frame: str) -> str:
    """A frame's name without its namespace."""
    return plain_name(frame).rsplit("/", 1)[-1]


def _transform(position: Any, orientation: Any) -> Transform:
    return transform(_xyz(position), _xyzw(orientation))


def _planar(matrix: Transform) -> Pose:
    return np.array([matrix[0, 3], matrix[1, 3], yaw_of(matrix)])


def _xyz(vector: Any) -> tuple[float, float, float]:
    return vector.x, vector.y, vector.z


def _xyzw(quaternion: Any) -> tuple[float, float, float, float]:
    return quaternion.x, quaternion.y, quaternion.z, quaternion.w
