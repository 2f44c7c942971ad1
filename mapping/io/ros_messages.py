"""Turns the testbed's messages into those of ROS 2, field by field."""

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mapping.geometry import Pose
from mapping.io.map_server import MapFile
from mapping.io.range_limits import hits_below_maximum
from mapping.io.recorded_run import StaticFrame
from mapping.io.ros_library import (
    IMU,
    LASER_SCAN,
    NANOSECONDS,
    OCCUPANCY_GRID,
    ODOMETRY,
    TF_MESSAGE,
    TWIST,
)
from mapping.messages import Imu, LaserScan, Odometry

MAP_FRAME, ODOM_FRAME, BASE_FRAME = "map", "odom", "base_footprint"
SCAN_FRAME, IMU_FRAME = "base_scan", "imu_link"
"""Frames as REP-105 and turtlebot3_burger.urdf name them."""


class RosMessages:
    """Makes messages of the types of a rosbags type store."""

    def __init__(self, store: Any) -> None:
        self.store = store
        self._types = store.types
        self._unknown_3x3 = np.zeros(9)
        self._unknown_6x6 = np.zeros(36)
        """Covariances of zeros: not known (sensor_msgs/Imu)."""

    def scan(self, when: int, scan: LaserScan) -> Any:
        """sensor_msgs/LaserScan."""
        return self._types[LASER_SCAN](
            header=self._header(when, SCAN_FRAME),
            angle_min=scan.angle_min,
            angle_max=scan.angle_max,
            angle_increment=scan.angle_increment,
            time_increment=scan.time_increment,
            scan_time=scan.scan_time,
            range_min=scan.range_min,
            range_max=scan.range_max,
            ranges=hits_below_maximum(np.asarray(scan.ranges, np.float32), scan.range_max),
            intensities=np.empty(0, dtype=np.float32),
        )

    def odometry(self, when: int, message: Odometry) -> Any:
        """nav_msgs/Odometry, the twist in base_footprint."""
        types = self._types
        x, y, yaw = message.pose_odom.tolist()
        point = types["geometry_msgs/msg/Point"](x, y, 0.0)
        pose = types["geometry_msgs/msg/Pose"](point, self._heading(yaw))
        twist = self.command(message.twist.linear_x, message.twist.angular_z)
        return types[ODOMETRY](
            header=self._header(when, ODOM_FRAME),
            child_frame_id=BASE_FRAME,
            pose=types["geometry_msgs/msg/PoseWithCovariance"](pose, self._unknown_6x6),
            twist=types["geometry_msgs/msg/TwistWithCovariance"](twist, self._unknown_6x6),
        )

    def imu(self, when: int, message: Imu) -> Any:
        """sensor_msgs/Imu."""
        return self._types[IMU](
            header=self._header(when, IMU_FRAME),
            orientation=self._quaternion(*message.orientation.tolist()),
            orientation_covariance=self._unknown_3x3,
            angular_velocity=self._vector(*message.angular_velocity.tolist()),
            angular_velocity_covariance=self._unknown_3x3,
            linear_acceleration=self._vector(*message.linear_acceleration.tolist()),
            linear_acceleration_covariance=self._unknown_3x3,
        )

    def command(self, linear: float, angular: float) -> Any:
        """geometry_msgs/Twist."""
        return self._types[TWIST](
            linear=self._vector(linear, 0.0, 0.0), angular=self._vector(0.0, 0.0, angular)
        )

    def map(self, when: int, drawn: MapFile) -> Any:
        """nav_msgs/OccupancyGrid."""
        types = self._types
        rows, columns = drawn.states.shape
        corner = types["geometry_msgs/msg/Point"](*drawn.origin, 0.0)
        info = types["nav_msgs/msg/MapMetaData"](
            map_load_time=self._time(when),
            resolution=drawn.resolution,
            width=columns,
            height=rows,
            origin=types["geometry_msgs/msg/Pose"](corner, self._heading(0.0)),
        )
        return types[OCCUPANCY_GRID](
            header=self._header(when, MAP_FRAME), info=info, data=drawn.states.ravel()
        )

    def map_to_odom(self, when: int, pose: NDArray[np.float64]) -> Any:
        """tf2_msgs/TFMessage of the pose of odom in map, as every SLAM node publishes it."""
        x, y, yaw = pose.tolist()
        return self._transforms([self._transform(when, MAP_FRAME, ODOM_FRAME, (x, y, 0.0), yaw)])

    def odom_to_base(self, when: int, pose: Pose) -> Any:
        """tf2_msgs/TFMessage of the robot's pose in odom."""
        x, y, yaw = pose.tolist()
        return self._transforms([self._transform(when, ODOM_FRAME, BASE_FRAME, (x, y, 0.0), yaw)])

    def static_frames(self, when: int, frames: Sequence[StaticFrame]) -> Any:
        """tf2_msgs/TFMessage of frames that do not move."""
        return self._transforms(
            [
                self._transform(when, frame.parent, frame.child, frame.position, frame.yaw)
                for frame in frames
            ]
        )

    def _transforms(self, transforms: list[Any]) -> Any:
        return self._types[TF_MESSAGE](transforms=transforms)

    def _transform(
        self, when: int, parent: str, child: str, position: tuple[float, float, float], yaw: float
    ) -> Any:
        types = self._types
        return types["geometry_msgs/msg/TransformStamped"](
            header=self._header(when, parent),
            child_frame_id=child,
            transform=types["geometry_msgs/msg/Transform"](
                self._vector(*position), self._heading(yaw)
            ),
        )

    def _header(self, when: int, frame: str) -> Any:
        return self._types["std_msgs/msg/Header"](stamp=self._time(when), frame_id=frame)

    def _time(self, when: int) -> Any:
        seconds, rest = divmod(when, NANOSECONDS)
        return self._types["builtin_interfaces/msg/Time"](sec=seconds, nanosec=rest)

    def _vector(self, x: float, y: float, z: float) -> Any:
        return self._types["geometry_msgs/msg/Vector3"](x, y, z)

    def _quaternion(self, x: float, y: float, z: float, w: float) -> Any:
        return self._types["geometry_msgs/msg/Quaternion"](x, y, z, w)

    def _heading(self, yaw: float) -> Any:
        """A rotation about z."""
        return self._quaternion(0.0, 0.0, math.sin(0.5 * yaw), math.cos(0.5 * yaw))
