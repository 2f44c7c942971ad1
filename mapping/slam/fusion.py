"""Turns odometry and gyroscope readings into one track, better than either.

The way comes from the odometry, the turn from the gyroscope, whose bias is learned while the robot
stands and, if the odometry's heading comes from the wheels, from the difference of the two turns
while it drives.

An odometry that takes its heading from the IMU, as the firmware's does, repeats the gyroscope, bias
and all, and corrects nothing (see ``FusionConfig.heading_from``). Without an IMU the track is the
odometry's, with the covariance of its motion model. A scale error of the gyroscope is not
estimated: headings turn by that share too far. An odometry without any error gains nothing; it is
made as good as the gyroscope.
"""

import math
from collections import deque
from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from mapping.deskew import forget_old, poses_on
from mapping.geometry import Pose
from mapping.messages import Imu, Odometry, turn_rates
from mapping.slam.fusion_config import FusionConfig
from mapping.slam.fusion_filter import FusionFilter, Gyro, Motion
from mapping.slam.fusion_kernels import BIAS, keep_rates, turn_between

QUIET_MESSAGES = 5
"""So many messages of a standing robot without any turn prove that wheels make the heading."""

NO_MOTION = 1e-7
"""Below this a motion is rounding [m, rad]; the noise of an IMU's heading is 20 times as large."""

MOST_RATES = 4096
"""Readings of the gyroscope held while no odometry comes: 40 s of a Burger's."""

Row = tuple[float, ...]
"""Stamp, x, y, yaw, forward speed, turn rate, as ``messages.ODOMETRY_COLUMNS``."""


class FusedTrack:
    """The fused poses of the last moments, in the odometry's frame.

    A message that is not usable, or no newer than the newest, is ignored. A jump, a motion faster
    than the settings allow, is not believed and counted in ``jumps``: the robot is taken to go on
    as before, anywhere within what the allowed speeds reach.
    """

    def __init__(self, config: FusionConfig | None = None) -> None:
        self.config = config or FusionConfig()
        self.jumps = 0
        self._filter = FusionFilter(self.config)
        self._rows: deque[Row] = deque()
        self._odometry: Row | None = None
        self._rates: NDArray[np.float64] = np.zeros((0, 2))
        self._still_time = 0.0
        self._quiet_messages = 0
        self._heading_moves_at_rest = False

    @property
    def newest(self) -> Pose | None:
        """The newest pose ``(3,)``, or None before the first message."""
        return np.array(self._rows[-1][1:4]) if self._rows else None

    @property
    def newest_turn_rate(self) -> float:
        """The newest turn rate [rad/s], 0 before the first message."""
        return self._rows[-1][5] if self._rows else 0.0

    @property
    def gyro_bias(self) -> tuple[float, float]:
        """The gyroscope's bias as measured, and its standard deviation [rad/s]."""
        return self._filter.bias, math.sqrt(self._filter.covariance[BIAS, BIAS])

    @property
    def wheels_tell_turns(self) -> bool:
        """Whether the odometry's heading is known to come from the encoders."""
        if self.config.heading_from == "detect":
            return self._quiet_messages >= QUIET_MESSAGES and not self._heading_moves_at_rest
        return self.config.heading_from == "encoders"

    def add(self, odometry: Sequence[Odometry], imu: Sequence[Imu] = ()) -> None:
        """Take new messages of both kinds, each kind oldest first."""
        if len(imu):
            since = self._odometry[0] if self._odometry else -np.inf
            self._rates = keep_rates(
                self._rates, turn_rates(imu), since, self.config.max_turn_rate, MOST_RATES
            )
        for message in odometry:
            if not message.is_usable:
                continue
            row = message.row
            if self._odometry is None:
                self._odometry = row
                self._filter.begin(row[1], row[2], row[3])
                self._rows.append(row)
            elif row[0] > self._odometry[0]:
                self._rows.append(self._taken(self._odometry, row))
                self._odometry = row
        forget_old(self._rows)

    def poses_at(self, stamps: ArrayLike) -> Pose | None:
        """The poses ``(n, 3)`` at moments ``(n,)`` [s], as ``OdometryTrack.poses_at``."""
        return poses_on(self._rows, stamps)

    def mark(self) -> None:
        """Let ``motion_covariance`` count from the newest pose."""
        self._filter.mark()

    def motion_covariance(self) -> NDArray[np.float64]:
        """Covariance ``(3, 3)`` [m, m, rad] of the motion since the mark, in the marked frame.

        Of x ahead, y to the left and yaw, as ``between(marked pose, newest pose)`` gives them;
        all zero right after a mark. Before any mark it counts from the first message.
        """
        return self._filter.motion_covariance()

    def _taken(self, last: Row, row: Row) -> Row:
        """The fused row after the motion from one odometry message to the next."""
        config = self.config
        duration = row[0] - last[0]
        motion = _between(last, row)
        gyro = turn_between(self._rates, last[0], row[0], config.gyro_window, config.gyro_gap)
        speed, rate = row[4:6]
        if self._is_still(motion, gyro):
            self._still_time += duration
        else:
            self._still_time = 0.0
        if (
            math.hypot(motion[0], motion[1]) > config.max_speed * duration + config.late_way
            or abs(motion[2]) > config.max_turn_rate * duration + config.late_turn
        ):
            self.jumps += 1
            speed, rate = self._rows[-1][4:6]
            self._filter.coast(speed, rate, duration, gyro)
        elif self._still_time > config.settling_time:
            self._note_heading(motion)
            self._filter.stand(motion, duration, gyro)
        else:
            self._filter.drive(motion, duration, gyro, wheels_tell_turns=self.wheels_tell_turns)
        if gyro[3]:
            rate = float(self._rates[-1, 1]) - self._filter.likely_bias
        x, y, yaw = self._filter.state[:3].tolist()
        return (row[0], x, y, math.remainder(yaw, 2.0 * math.pi), speed, rate)

    def _is_still(self, motion: Motion, gyro: Gyro) -> bool:
        """Whether wheels and gyroscope agree that the robot hardly moves."""
        _, _, fastest, is_covered = gyro
        config = self.config
        return (
            is_covered
            and fastest <= config.standing_rate
            and math.hypot(motion[0], motion[1]) <= config.standing_way
            and abs(motion[2]) <= config.standing_turn
        )

    def _note_heading(self, motion: Motion) -> None:
        """Learn from a motion at rest whether wheels or an IMU make the odometry's heading.

        A wheel that ticks moves the place as well as the heading.
        """
        if math.hypot(motion[0], motion[1]) > NO_MOTION:
            return
        if abs(motion[2]) > NO_MOTION:
            self._heading_moves_at_rest = True
        else:
            self._quiet_messages += 1


def _between(last: Row, row: Row) -> Motion:
    """The motion from one odometry pose to the next, in the frame of the first."""
    across, along = row[1] - last[1], row[2] - last[2]
    cos, sin = math.cos(last[3]), math.sin(last[3])
    turn = math.remainder(row[3] - last[3], 2.0 * math.pi)
    return cos * across + sin * along, cos * along - sin * across, turn
