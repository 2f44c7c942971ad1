"""Notices by the accelerometer when somebody has run into the robot: its wheels do not."""

import math
from collections import deque
from collections.abc import Sequence

from mapping.messages import Imu, Odometry, accelerations

SHOVE_ACCELERATION = 3.5
"""No drive accelerates a robot so hard [m/s2]: a Burger's brakes and turns reach 3.0."""

DRIVEN_CHANGE = 0.1
"""That holds while the odometry, which lags a little behind, shows no greater change of speed
[m/s]. Nothing else is known of a robot that its navigator throws from full speed into reverse."""

MOTOR_LAG = 0.05
"""In this time [s] a motor takes up most of a change of speed: what a greater one may add to the
acceleration (``MOTOR_TIME_CONSTANT`` of the simulated motors)."""

CHANGE_TIME = 0.3
"""A jerk comes so long after the change at the latest [s], as the robot rocks on its wheels."""

SHOVE_TIME = 1.0
"""So long after such a jolt the robot may still be pushed about, and scans be bent by it [s]."""


class ShoveDetector:
    """Whether the robot may be moving in a way that its wheels do not tell."""

    def __init__(self) -> None:
        self._speeds: deque[tuple[float, float]] = deque()
        self._newest_imu = self._shoved_until = -math.inf

    @property
    def is_shoved(self) -> bool:
        """Whether it was run into within the last second; never without an IMU."""
        return self._newest_imu < self._shoved_until

    def add(self, odometry: Sequence[Odometry], imu: Sequence[Imu]) -> None:
        """Take the messages of one control period, each kind oldest first."""
        for message in odometry:
            self._note(message.stamp, message.twist.linear_x)
        rows = accelerations(imu)
        if len(rows) == 0:
            return
        self._newest_imu = float(rows[-1, 0])
        hard = rows[:, 1] ** 2 + rows[:, 2] ** 2 > self._most_driven() ** 2
        if hard.any():
            self._shoved_until = float(rows[hard, 0].max()) + SHOVE_TIME

    def _note(self, stamp: float, speed: float) -> None:
        speeds = self._speeds
        if not (math.isfinite(stamp) and math.isfinite(speed)):
            return
        if speeds and stamp < speeds[-1][0]:
            speeds.clear()  # time ran backwards
        speeds.append((stamp, speed))
        while speeds[0][0] < stamp - CHANGE_TIME:
            speeds.popleft()

    def _most_driven(self) -> float:
        """The hardest acceleration that the wheels explain [m/s2]."""
        speeds = [speed for _, speed in self._speeds]
        change = max(speeds) - min(speeds) if speeds else 0.0
        return SHOVE_ACCELERATION + max(change - DRIVEN_CHANGE, 0.0) / MOTOR_LAG
