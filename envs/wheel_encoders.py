"""Turns the angles of the two wheels into odometry, as the firmware of the robot does."""

import math
from dataclasses import dataclass
from typing import Literal, get_args

import numpy as np

from envs.burger_constants import (
    CONTACT_CREEP,
    ENCODER_TICKS,
    WHEEL_RADIUS,
    WHEEL_SEPARATION,
)
from mapping.errors import TestbedError
from mapping.geometry import Pose, between

YawSource = Literal["encoders", "imu"]
"""Where odometry takes its heading from: the wheels (as the thesis) or the IMU (as ROBOTIS)."""

OdometryRow = tuple[float, float, float, float, float, float]
"""One message: stamp, x, y, yaw, linear_x, angular_z (messages.ODOMETRY_COLUMNS)."""

TICK = 2.0 * math.pi / ENCODER_TICKS
"""Wheel angle of one tick [rad]: 0.0506 mm on the floor."""

_LARGEST_ERROR = 0.1
"""Beyond 10 % (or 10 cm a root metre) a draw could turn a radius negative; nothing drives so."""


@dataclass(frozen=True, slots=True, kw_only=True)
class OdometryConfig:
    """How wrong the robot's idea of its own wheels is; the default is a robot used as it comes.

    The systematic errors are those of Borenstein and Feng's UMBmark (IEEE Trans. Robotics and
    Automation 12(6), 1996); slip grows as a random walk over the way of each wheel, as in Thrun,
    Burgard and Fox, Probabilistic Robotics, 5.4.

    What is drawn once an episode is drawn from a normal distribution.
    """

    wheel_radius_sigma: float = 0.005
    """Relative error of the radius assumed for both wheels, drawn once an episode: a tyre pressed
    or worn by 0.17 mm."""
    wheel_mismatch_sigma: float = 0.0
    """Relative difference between the two radii, drawn once an episode. 0.1 % would turn the
    heading by 0.36 degrees a metre; UMBmark takes it out, so the presets leave it out."""
    wheel_base_sigma: float = 0.01
    """Relative error of the wheel separation assumed, drawn once an episode: 1.6 mm, as a tyre
    18 mm wide may touch the floor anywhere across its width."""
    slip: float = 0.0005
    """Standard deviation of a wheel's error after one metre of its way [m]; it grows with the root
    of the way [assumption: 0.25 degrees a root metre, 1.8 degrees after the 50 m there and back of
    the thesis's hallway, which make its figure 5.11 draw a second one]."""
    yaw_source: YawSource = "imu"
    """What the heading comes from: the firmware and turtlebot3_node (use_imu) take the IMU."""
    truth: bool = False
    """Report the true pose and velocity instead, as Gazebo's ``odometrySource = world``."""

    def __post_init__(self) -> None:
        """Refuse figures that are no errors."""
        for name in ("wheel_radius_sigma", "wheel_mismatch_sigma", "wheel_base_sigma", "slip"):
            value = getattr(self, name)
            if not 0.0 <= value <= _LARGEST_ERROR:
                raise TestbedError(
                    f"odometry {name}: {value}; must be from 0 to {_LARGEST_ERROR:g}"
                )
        if self.yaw_source not in get_args(YawSource):
            raise TestbedError(
                f"odometry yaw_source: {self.yaw_source!r}; must be 'encoders' or 'imu'"
            )


ODOMETRY_PRESETS: dict[str, OdometryConfig] = {
    "ideal": OdometryConfig(wheel_radius_sigma=0.0, wheel_base_sigma=0.0, slip=0.0),
    "typical": OdometryConfig(),
    "poor": OdometryConfig(wheel_radius_sigma=0.015, wheel_base_sigma=0.03, slip=0.0015),
    "truth": OdometryConfig(truth=True),
}
"""Named settings of odometry; ``poor`` is three times ``typical``."""


class WheelEncoders:
    """Counts ticks and integrates them to a pose, 30 times a second.

    The radius that it reckons with has the model's own contact creep calibrated out, so that
    ``ideal`` errs only by whole ticks; the errors of the settings come on top.
    """

    def __init__(self, config: OdometryConfig) -> None:
        self.config = config

    def reset(
        self, rng: np.random.Generator, wheel_angles: tuple[float, float], pose_world: Pose
    ) -> None:
        """Take a new robot and make the odometry frame the pose ``(3,)`` where it stands."""
        self._rng = rng
        scale, mismatch, base = rng.standard_normal(3).tolist()
        radius = (1.0 - CONTACT_CREEP) * WHEEL_RADIUS
        radius *= 1.0 + self.config.wheel_radius_sigma * scale
        half_mismatch = 0.5 * self.config.wheel_mismatch_sigma * mismatch
        self._tick_ways = (TICK * radius * (1 - half_mismatch), TICK * radius * (1 + half_mismatch))
        self._base = WHEEL_SEPARATION * (1.0 + self.config.wheel_base_sigma * base)
        self._ticks = _ticks(wheel_angles)
        self._start_world = pose_world.copy()
        self._pose = (0.0, 0.0, 0.0)
        self._imu_yaw = 0.0
        self._stamp = 0.0

    def read(self, stamp: float, wheel_angles: tuple[float, float], imu_yaw: float) -> OdometryRow:
        """The message of this moment, from the wheels' angles [rad] and the IMU's heading [rad].

        Midpoint integration, as OpenCR turtlebot3_core.ino has it; the velocity is the mean since
        the message before.
        """
        left, right = self._ways(wheel_angles)
        way = 0.5 * (left + right)
        if self.config.yaw_source == "imu":
            turn = math.remainder(imu_yaw - self._imu_yaw, 2.0 * math.pi)
            self._imu_yaw = imu_yaw
        else:
            turn = (right - left) / self._base
        x, y, yaw = self._pose
        x += way * math.cos(yaw + 0.5 * turn)
        y += way * math.sin(yaw + 0.5 * turn)
        self._pose = (x, y, math.remainder(yaw + turn, 2.0 * math.pi))
        period, self._stamp = stamp - self._stamp, stamp
        return (stamp, *self._pose, way / period, turn / period)

    def read_truth(
        self, stamp: float, pose_world: Pose, velocity_base: tuple[float, float]
    ) -> OdometryRow:
        """The message that the truth makes: pose in the odometry frame, velocity in the robot's."""
        x, y, yaw = between(self._start_world, pose_world).tolist()
        return (stamp, x, y, yaw, *velocity_base)

    def _ways(self, wheel_angles: tuple[float, float]) -> tuple[float, float]:
        """How far each wheel seems to have rolled since the last message [m]."""
        ticks = _ticks(wheel_angles)
        left = (ticks[0] - self._ticks[0]) * self._tick_ways[0]
        right = (ticks[1] - self._ticks[1]) * self._tick_ways[1]
        self._ticks = ticks
        if self.config.slip == 0.0:
            return left, right
        noise_left, noise_right = self._rng.standard_normal(2).tolist()
        return (
            left + self.config.slip * math.sqrt(abs(left)) * noise_left,
            right + self.config.slip * math.sqrt(abs(right)) * noise_right,
        )


def _ticks(wheel_angles: tuple[float, float]) -> tuple[int, int]:
    """Whole ticks that the encoders have counted."""
    left, right = wheel_angles
    return math.floor(left / TICK), math.floor(right / TICK)
