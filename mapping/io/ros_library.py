"""Brings in the rosbags library, which reads and writes ROS 2 bags without ROS; it is optional."""

from typing import Any

from mapping.errors import TestbedError

SCAN_TOPIC, ODOMETRY_TOPIC, IMU_TOPIC = "/scan", "/odom", "/imu"
TF_TOPIC, TF_STATIC_TOPIC = "/tf", "/tf_static"
COMMAND_TOPIC, MAP_TOPIC = "/cmd_vel", "/map"
"""Topics as the TurtleBot3's own launch files name them."""

LASER_SCAN, ODOMETRY, IMU = (
    "sensor_msgs/msg/LaserScan",
    "nav_msgs/msg/Odometry",
    "sensor_msgs/msg/Imu",
)
TF_MESSAGE, TWIST, OCCUPANCY_GRID = (
    "tf2_msgs/msg/TFMessage",
    "geometry_msgs/msg/Twist",
    "nav_msgs/msg/OccupancyGrid",
)
"""Types of the messages on them."""

NANOSECONDS = 1_000_000_000
"""In a second: ROS tells time in whole ones."""


def require_rosbags() -> None:
    """Make sure that bags can be read and written.

    Raises:
        TestbedError: The library is not installed; says how to install it.
    """
    try:
        import rosbags.rosbag2
        import rosbags.typesys  # noqa: F401
    except ImportError:
        raise TestbedError(
            "ROS bags need the rosbags library; install it with pip install 'burger-testbed[ros]'"
        ) from None


def message_types() -> Any:
    """The message types of ROS 2 Humble.

    Those of the topics above are the same in every ROS 2 from Foxy to Kilted, so bags of all of
    them are read with these, whatever else they hold.
    """
    require_rosbags()
    from rosbags.typesys import Stores, get_typestore

    return get_typestore(Stores.ROS2_HUMBLE)
