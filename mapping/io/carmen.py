"""The lines of a CARMEN log: one message a line, its kind first, its times last.

``KIND fields... ipc_timestamp ipc_hostname logger_timestamp``: the first time is the sensor's
[s], the second says when the logger wrote the line (CARMEN logger, writelog.c). The public logs of
SLAM research are in this format; Gmapping, MRPT and MATLAB read it.
"""

FLASER = "FLASER"
"""``n ranges... laser x y theta, robot x y theta``: a SICK that looks ahead, 180 degrees wide."""

ROBOTLASER1 = "ROBOTLASER1"
"""``type start_angle fov resolution max_range accuracy remission_mode, n ranges...,
m remissions..., laser x y theta, robot x y theta, tv rv forward_safety side_safety turn_axis``:
any laser."""

ODOM = "ODOM"
"""``x y theta tv rv acceleration``: what the wheels say."""

IMU = "IMU"
"""``acceleration x y z, quaternion w x y z, magnetometer x y z, gyroscope x y z``."""

PARAM = "PARAM"
"""``name value``: a setting of the robot, from here on."""

KINDS = (FLASER, ROBOTLASER1, ODOM, IMU, PARAM, "RLASER", "TRUEPOS", "SYNC")
"""Kinds of lines by which a CARMEN log is known; there are more, and readers skip what they do not
know."""

SICK_TYPES = ("0", "1")
"""What ``type`` calls a SICK LMS and a SICK PLS (CARMEN, laser_messages.h)."""

UNKNOWN_TYPE = "99"
"""What ``type`` calls any other laser (CARMEN, laser_messages.h)."""

SICK_NO_RETURN = 81.0
"""A SICK's readings from here on are codes (81.83 m to 81.91 m): it saw nothing. MRPT's reader has
the same bound."""

SICK_FOV_DEG = {180: (180.0, 1.0), 181: (180.0, 1.0), 360: (180.0, 0.5), 361: (180.0, 0.5)} | {
    400: (100.0, 0.25),
    401: (100.0, 0.25),
}
"""A SICK's number of beams -> its field of view and the angle between beams [deg], for lines that
do not tell (CARMEN, readlog.c). One beam less than fits means that the last was left out."""

OTHER_FOV_DEG = 180.0
"""Field of view for any other number of beams [deg] (CARMEN, readlog.c)."""

MAX_RANGE_PARAM = "robot_front_laser_max"
"""CARMEN's name for the range [m] from which on a front laser's reading means nothing was there."""

POSE_PARAMS = (
    "robot_frontlaser_offset",
    "robot_frontlaser_side_offset",
    "robot_frontlaser_angular_offset",
)
"""CARMEN's names for the lidar's pose on the robot: x [m], y [m], yaw [rad]."""

TIME_INCREMENT_PARAM = "robot_frontlaser_time_increment"
"""Our own: time between a rolling scan's beams [s], which no line of CARMEN's has."""

SCAN_TIME_PARAM = "robot_frontlaser_scan_time"
"""Our own: time between scans [s]."""

RANGE_MIN_PARAM = "robot_frontlaser_range_min"
"""Our own: nearest range that counts [m]."""

PARAMS = (
    MAX_RANGE_PARAM,
    *POSE_PARAMS,
    TIME_INCREMENT_PARAM,
    SCAN_TIME_PARAM,
    RANGE_MIN_PARAM,
)
"""The settings that are read; a robot has many more."""
