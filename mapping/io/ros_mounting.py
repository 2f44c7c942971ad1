"""Turns what a sensor measured in its own axes into the robot's, by how it is mounted."""

from dataclasses import replace

from mapping.io.ros_frames import Transform
from mapping.messages import Imu, LaserScan


def turned_over(scan: LaserScan) -> LaserScan:
    """A scan of a lidar whose z axis points down, as seen from above."""
    return LaserScan(
        stamp=scan.stamp,
        ranges=scan.ranges,
        angle_min=-scan.angle_min,
        angle_increment=-scan.angle_increment,
        time_increment=scan.time_increment,
        scan_time=scan.scan_time,
        range_min=scan.range_min,
        range_max=scan.range_max,
    )


def upright(message: Imu, mount: Transform) -> Imu:
    """What the same unit would say if its axes were the robot's; ``mount`` is its pose there."""
    turn = mount[:3, :3]
    return replace(
        message,
        angular_velocity=turn @ message.angular_velocity,
        linear_acceleration=turn @ message.linear_acceleration,
    )
