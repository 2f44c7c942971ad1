"""What the fusion of odometry and gyroscope believes of their errors; the default is a Burger."""

import math
from dataclasses import dataclass, fields
from typing import Literal, get_args

from mapping.errors import TestbedError

HeadingSource = Literal["detect", "encoders", "imu"]
"""Where the odometry's heading comes from."""


@dataclass(frozen=True, slots=True, kw_only=True)
class FusionConfig:
    """Standard deviations of the errors, and what counts as standing, slipping and jumping.

    Errors of the odometry grow as a random walk: the four figures after the motion model of Thrun,
    Burgard and Fox, Probabilistic Robotics, 5.4, but with variances that grow with the way instead
    of its square, so that it does not matter into how many messages a way is cut. A Burger's stand
    here: a wheel errs by 0.5 mm a root metre [assumption, facts of the simulated wheels], and two
    of them stand 0.16 m apart. A robot with worse wheels needs larger ones.
    """

    way_per_way: float = 0.00035
    """Error of the way after one metre [m]: 0.5 mm / sqrt(2)."""
    way_per_turn: float = 0.0001
    """Error of the way after a spin of one radian [m]: 0.5 mm sqrt(0.16) / 2."""
    turn_per_way: float = 0.0044
    """Error of the odometry's turn after one metre [rad]: 0.5 mm sqrt(2) / 0.16 m."""
    turn_per_turn: float = 0.00125
    """Error of the odometry's turn after a spin of one radian [rad]: 0.5 mm / sqrt(0.16 m)."""
    turn_step: float = 1.8e-4
    """Rounding of one message's turn by whole ticks [rad]: 0.0506 mm / 0.16 m / sqrt(3)
    (XL430-W250: 4096 ticks a turn)."""
    way_scale: float = 0.005
    """Relative error of every way [1]: the wheels' radius, a tyre pressed or worn by 0.17 mm."""
    turn_scale: float = 0.012
    """Relative error of every turn of the encoders [1]: the wheel base's 1 % and the radius."""
    gyro_noise: float = 2e-4
    """White noise of one reading of the gyroscope [rad/s] (turtlebot3_simulations@eb50ff8)."""
    gyro_bias: float = 3.1e-4
    """Constant error of the gyroscope before the first rest [rad/s]: the firmware zeroes it in
    whole steps of 2000 deg/s / 2^15 (OpenCR MPU9250.cpp@2bd5e0c), which leaves step / sqrt(12)."""
    calibrated_bias: float = 7.5e-6
    """The same of one that was calibrated well at rest (turtlebot3_burger.gazebo.xacro, noetic)."""
    calibrated: float = 0.5
    """How likely that is, 0 to 1 [assumption]."""
    gyro_bias_walk: float = 1e-6
    """Change of that error in one second [rad/s], a random walk [assumption: warming up]."""
    gyro_window: float = 0.01
    """A reading is the mean rate of so long before its stamp [s]: the time between a Burger's, and
    about what its gyroscope's low-pass filter of 41 Hz makes (OpenCR MPU9250.cpp@2bd5e0c)."""
    gyro_gap: float = 0.1
    """Readings farther apart than this [s] leave the turn between them to the odometry."""
    standing_way: float = 1e-4
    """Up to this way between two messages [m], two ticks of a wheel, the robot may stand."""
    standing_turn: float = 1e-3
    """Up to this turn of the odometry between two messages [rad] it may stand."""
    standing_rate: float = 0.01
    """Up to this rate of every gyroscope reading [rad/s] it may stand."""
    settling_time: float = 0.3
    """So long all three must have held [s]: six times the motors' lag of 0.05 s, after which what
    is left of a spin is far below the bias."""
    slip_gate: float = 5.0
    """An odometry's turn this many standard deviations from the gyroscope's is a slip."""
    max_speed: float = 3.0
    """A message that asks for a faster motion [m/s] is not believed: twice as fast as robots that
    are let indoors, so that logs with seconds between messages pass."""
    max_turn_rate: float = 10.0
    """The same for turns [rad/s], and for readings of the gyroscope."""
    late_way: float = 1.5
    """What a motion may exceed these by [m]: logs hold messages stamped late, milliseconds apart,
    with a second's motion between them."""
    late_turn: float = 1.5
    """The same for turns [rad]."""
    heading_from: HeadingSource = "detect"
    """What the odometry's heading comes from. Only the encoders' tells something that the
    gyroscope does not. "detect" watches the robot stand: wheels then tell no turn at all, an IMU's
    heading never rests."""

    def __post_init__(self) -> None:
        """Refuse figures that are no errors."""
        if self.heading_from not in get_args(HeadingSource):
            raise TestbedError(
                f"fusion heading_from: {self.heading_from!r}; "
                f"must be one of {', '.join(get_args(HeadingSource))}"
            )
        for field in fields(self):
            value = getattr(self, field.name)
            if field.name == "heading_from":
                continue
            if not (math.isfinite(value) and value >= 0.0):
                raise TestbedError(f"fusion {field.name}: {value}; must be finite and not negative")
        if self.calibrated > 1.0:
            raise TestbedError(f"fusion calibrated: {self.calibrated}; must be from 0 to 1")
        for name in ("slip_gate", "max_speed", "max_turn_rate"):
            if getattr(self, name) == 0.0:
                raise TestbedError(f"fusion {name}: 0; must be above 0")
