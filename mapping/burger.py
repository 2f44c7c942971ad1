"""The figures of the TurtleBot3 Burger that mapping and navigation need, each with its source.

The rest of the robot (masses, inertias, motors) stands in ``envs.burger_constants``.
"""

LIDAR_POSE_BASE = (-0.032, 0.0, 0.0)
"""base_scan in base_footprint: x [m], y [m], yaw [rad] (turtlebot3_burger.urdf@da785b7)."""

LIDAR_BEAMS = 360
"""Beams of the LDS-01 in one turn, 1 degree apart (ROBOTIS e-manual, LDS-01)."""

LIDAR_SCAN_TIME = 0.2
"""Time of one turn of the LDS-01 [s]: 300 rpm, 5 Hz (ROBOTIS e-manual, LDS-01)."""

LIDAR_RANGE_MIN = 0.12
"""Nearest range the LDS-01 reports [m] (hls_lfcd_lds_driver@5bf13c1)."""

LIDAR_RANGE_MAX = 3.5
"""Farthest range the LDS-01 reports [m] (hls_lfcd_lds_driver@5bf13c1)."""

MAX_LINEAR_SPEED = 0.22
"""Fastest forward command of /cmd_vel [m/s] (turtlebot3_teleop@da785b7)."""

MAX_ANGULAR_SPEED = 2.84
"""Fastest turn command of /cmd_vel [rad/s] (turtlebot3_teleop@da785b7)."""

ROBOT_RADIUS = 0.105
"""Radius that the firmware and Nav2 give the robot [m] (OpenCR turtlebot3_burger.h@68ec75d)."""
