"""Turns a velocity command into the speeds of the two wheels, within what the robot can do."""

import math

from envs.burger_constants import MAX_WHEEL_SPEED, WHEEL_RADIUS, WHEEL_SEPARATION
from mapping.burger import MAX_ANGULAR_SPEED, MAX_LINEAR_SPEED
from mapping.errors import TestbedError


def wheel_speeds(linear: float, angular: float) -> tuple[float, float]:
    """Speeds of the left and the right wheel [rad/s] for a command.

    The command is clamped to the limits of /cmd_vel, then each wheel on its own to 61 rpm as the
    firmware does (OpenCR turtlebot3_motor_driver.cpp), so that a fast curve gets wider.

    Args:
        linear: Forward speed [m/s].
        angular: Turn rate [rad/s], counter-clockwise positive.

    Raises:
        TestbedError: A speed is not finite.
    """
    if not (math.isfinite(linear) and math.isfinite(angular)):
        raise TestbedError(f"command: ({linear} m/s, {angular} rad/s); must be finite")
    forward = _clamp(linear, MAX_LINEAR_SPEED)
    turning = _clamp(angular, MAX_ANGULAR_SPEED) * 0.5 * WHEEL_SEPARATION
    return (
        _clamp((forward - turning) / WHEEL_RADIUS, MAX_WHEEL_SPEED),
        _clamp((forward + turning) / WHEEL_RADIUS, MAX_WHEEL_SPEED),
    )


def _clamp(value: float, limit: float) -> float:
    """The nearest value in [-limit, limit]."""
    return min(max(value, -limit), limit)
