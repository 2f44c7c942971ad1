"""Turns the motion of the base into what its inertial unit reports."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from envs.burger_constants import IMU_POSITION, IMU_RATE
from envs.imu_kernels import GRAVITY, disturb, madgwick, mean_rates, specific_forces
from mapping.errors import TestbedError
from mapping.messages import IMU_COLUMNS

PERIOD = 1.0 / IMU_RATE
"""Time between messages [s]."""

GYRO_RANGE = math.radians(2000.0)
"""Fastest rate that the gyroscope reports [rad/s] (OpenCR IMU.cpp@68ec75d)."""

ACCEL_RANGE = 8.0 * GRAVITY
"""Largest acceleration that the accelerometer reports [m/s2] (OpenCR IMU.cpp@68ec75d)."""

GYRO_STEP = GYRO_RANGE / 2**15
"""Smallest step of the gyroscope [rad/s]: it reports 16 bits with a sign."""


@dataclass(frozen=True, slots=True, kw_only=True)
class ImuConfig:
    """Errors of the MPU-9250 on the OpenCR board, and of the filter that reads it."""

    gyro_sigma: float = 2e-4
    """White noise of a rate [rad/s] (turtlebot3_simulations@eb50ff8, model.sdf)."""
    gyro_bias_sigma: float = 7.5e-6
    """Constant error of a rate [rad/s], drawn once an episode for each axis: 1.5 degrees an hour,
    what a calibration at rest leaves (turtlebot3_burger.gazebo.xacro, branch noetic: 7.5e-6)."""
    accel_sigma: float = 1.7e-2
    """White noise of an acceleration [m/s2] (turtlebot3_simulations@eb50ff8, model.sdf)."""
    accel_bias_sigma: float = 0.1
    """Constant error of an acceleration [m/s2], drawn once an episode for each axis
    (turtlebot3_burger.gazebo.xacro, branch noetic: 0.1)."""
    filter_gain: float = 0.1
    """Gain of the attitude filter, Madgwick's beta [1/s] (OpenCR MadgwickAHRS.cpp@ef9be99)."""

    def __post_init__(self) -> None:
        """Refuse figures that are no errors."""
        for name in self.__slots__:
            value = getattr(self, name)
            if not (math.isfinite(value) and value >= 0.0):
                raise TestbedError(f"imu {name}: {value}; must be finite and not negative")


IMU_PRESETS: dict[str, ImuConfig] = {
    "ideal": ImuConfig(gyro_sigma=0.0, gyro_bias_sigma=0.0, accel_sigma=0.0, accel_bias_sigma=0.0),
    "typical": ImuConfig(),
    "drifting": ImuConfig(gyro_bias_sigma=GYRO_STEP / math.sqrt(12.0)),
}
"""Named settings of the IMU. ``drifting`` is the robot whose gyroscope the firmware zeroed by the
mean of 512 readings but in whole steps (OpenCR MPU9250.cpp@2bd5e0c): what is left is spread over
one step, 0.0003 rad/s or a degree a minute."""


class InertialUnit:
    """A gyroscope, an accelerometer and a 6-axis Madgwick filter, as in the firmware.

    Rates and accelerations are means since the message before, as the device's low-pass filters
    make them: 41 Hz (OpenCR MPU9250.cpp@2bd5e0c), where a mean over 10 ms has 44 Hz. The attitude
    filter has no magnetometer: its yaw starts at 0 and drifts.
    """

    def __init__(self, config: ImuConfig) -> None:
        self.config = config
        self._offset = np.array(IMU_POSITION)

    def reset(self, rng: np.random.Generator) -> None:
        """Take a new device, level and with yaw 0."""
        self._rng = rng
        self._gyro_bias = self.config.gyro_bias_sigma * rng.standard_normal(3)
        self._accel_bias = self.config.accel_bias_sigma * rng.standard_normal(3)
        self._attitude = np.array((1.0, 0.0, 0.0, 0.0))

    def read(
        self,
        stamps: NDArray[np.float64],
        positions: NDArray[np.float64],
        velocities: NDArray[np.float64],
    ) -> NDArray[np.float64]:
        """The messages ``(n, 11)`` of n moments, 10 ms apart, columns messages.IMU_COLUMNS.

        Args:
            stamps: Their times ``(n,)`` [s].
            positions: Position and quaternion (w, x, y, z) of base_link ``(n + 1, 7)``, beginning
                with the moment before the first.
            velocities: Its velocities ``(n + 1, 6)``, linear in the world, angular in base_link.
        """
        n = len(stamps)
        noise = self._rng.standard_normal((n, 6))
        config = self.config
        rates = mean_rates(positions, PERIOD)
        forces = specific_forces(positions, velocities, self._offset, PERIOD)
        rates = disturb(rates, self._gyro_bias, config.gyro_sigma, noise[:, :3], GYRO_RANGE)
        forces = disturb(forces, self._accel_bias, config.accel_sigma, noise[:, 3:], ACCEL_RANGE)
        attitudes = madgwick(self._attitude, rates, forces, PERIOD, config.filter_gain)
        if n:
            self._attitude = attitudes[-1]
        rows = np.empty((n, len(IMU_COLUMNS)))
        rows[:, 0] = stamps
        rows[:, 1:4], rows[:, 4] = attitudes[:, 1:], attitudes[:, 0]  # ROS puts w last
        rows[:, 5:8], rows[:, 8:11] = rates, forces
        return rows


FIRST_ROW = np.array((0.0, 0.0, 0.0, 0.0, 1.0, *(0.0,) * 6))
"""What stands for a message before the first: level, at yaw 0, still."""


def yaw_after(row: NDArray[np.float64], time: float) -> float:
    """The heading [rad] a time [s] after a message ``(11,)``, turning on as it says."""
    return yaw_of(row) + float(row[IMU_COLUMNS.index("wz")]) * time


def yaw_of(row: NDArray[np.float64]) -> float:
    """The heading [rad] that a message ``(11,)`` gives."""
    x, y, z, w = row[1:5].tolist()
    return math.atan2(2.0 * (w * z + x * y), 1.0 - 2.0 * (y * y + z * z))
