"""Turns ways of the odometry and turns of the gyroscope into a pose with its covariance.

An extended Kalman filter (Thrun, Burgard and Fox, Probabilistic Robotics, 3.3) of the pose, the
gyroscope's bias and the relative errors of the odometry's ways and turns. It moves once a message:
by the odometry's way, and by the gyroscope's turn or, without one, by the odometry's.
"""

import math

import numpy as np
from numpy.typing import NDArray

from mapping.pose_covariance import turned
from mapping.slam.fusion_config import FusionConfig
from mapping.slam.fusion_kernels import BIAS, STATES, TURN_SCALE, WAY_SCALE, YAW, correct, move

Motion = tuple[float, float, float]
"""Ahead, to the left [m] and turn [rad], in the frame of the pose before."""

Gyro = tuple[float, float, float, bool]
"""What the gyroscope turned, as ``fusion_kernels.turn_between`` gives it."""


class FusionFilter:
    """The Gaussian belief; ``state`` and ``covariance`` as ``fusion_kernels`` orders them.

    The covariance of the pose is that of the motion since ``mark``.
    """

    def __init__(self, config: FusionConfig) -> None:
        self.config = config
        self.state = np.zeros(STATES)
        self.covariance = np.zeros((STATES, STATES))
        self.covariance[BIAS, BIAS] = config.gyro_bias**2
        self.covariance[TURN_SCALE, TURN_SCALE] = config.turn_scale**2
        self.covariance[WAY_SCALE, WAY_SCALE] = config.way_scale**2
        self._marked_yaw = 0.0

    @property
    def bias(self) -> float:
        """The gyroscope's bias as measured [rad/s]."""
        return float(self.state[BIAS])

    @property
    def likely_bias(self) -> float:
        """The bias to expect [rad/s], given that it may have been calibrated away."""
        return likely_bias(self.bias, float(self.covariance[BIAS, BIAS]), self.config)

    def begin(self, x: float, y: float, yaw: float) -> None:
        """Stand at a pose, exactly."""
        self.state[: YAW + 1] = (x, y, yaw)
        self._marked_yaw = yaw

    def mark(self) -> None:
        """Let the covariance of the pose count from here."""
        self.covariance[: YAW + 1, :] = 0.0
        self.covariance[:, : YAW + 1] = 0.0
        self._marked_yaw = float(self.state[YAW])

    def motion_covariance(self) -> NDArray[np.float64]:
        """Covariance ``(3, 3)`` of the motion since the mark, in the marked frame."""
        return turned(self.covariance[: YAW + 1, : YAW + 1], -self._marked_yaw)

    def stand(self, motion: Motion, duration: float, gyro: Gyro) -> None:
        """Take it that the robot does not turn: what the gyroscope reads is its bias."""
        angle, squares, _, _ = gyro
        self._move((motion[0], motion[1], 0.0), (0.0, 0.0), (0.0, 0.0, 0.0), duration)
        correct(
            self.state,
            self.covariance,
            angle - duration * self.bias,
            np.array([0.0, 0.0, 0.0, duration, 0.0, 0.0]),
            np.zeros(STATES),
            self.config.gyro_noise**2 * squares,
            np.inf,
        )

    def drive(
        self, motion: Motion, duration: float, gyro: Gyro, *, wheels_tell_turns: bool
    ) -> None:
        """Move by the odometry's way and the best turn there is.

        Args:
            motion: The odometry's.
            duration: How long it took [s].
            gyro: The gyroscope's turn in that time.
            wheels_tell_turns: Whether the odometry's turn is one of the encoders, which tells the
                bias from the rate.
        """
        config = self.config
        way, turn_odom, is_covered = math.hypot(motion[0], motion[1]), motion[2], gyro[3]
        wheel_variance = config.turn_per_way**2 * way + config.turn_per_turn**2 * abs(turn_odom)
        scale = 1.0 + float(self.state[TURN_SCALE])
        if is_covered:
            turn, turn_variance, gains = self._gyro_turn(duration, gyro)
        else:
            turn, turn_variance = turn_odom / scale, wheel_variance
            gains = (0.0, -turn / scale)
        way_variance = config.way_per_way**2 * way + config.way_per_turn**2 * abs(turn)
        variances = (way_variance, turn_variance, 0.0)
        across, along = self._move(_bent(motion, turn), gains, variances, duration)
        if not (is_covered and wheels_tell_turns):
            return
        turn = gyro[0] - duration * self.bias  # surprises are those of the bias as measured
        shared = scale * turn_variance  # the gyroscope's noise is in the pose and in the prediction
        correct(
            self.state,
            self.covariance,
            turn_odom - scale * turn,
            np.array([0.0, 0.0, 0.0, -scale * duration, turn, 0.0]),
            np.array([-0.5 * along * shared, 0.5 * across * shared, shared, 0.0, 0.0, 0.0]),
            wheel_variance + config.turn_step**2 + scale**2 * turn_variance,
            config.slip_gate,
        )

    def coast(self, speed: float, rate: float, duration: float, gyro: Gyro) -> None:
        """Go on at a speed [m/s] and, without a gyroscope, at a turn rate [rad/s].

        This is for want of a believable message: anything that is allowed may have happened.
        """
        config = self.config
        if gyro[3]:
            turn, turn_variance, gains = self._gyro_turn(duration, gyro)
        else:
            turn, gains = rate * duration, (0.0, 0.0)
            turn_variance = min(config.max_turn_rate * duration, math.pi) ** 2 / 3.0
        place_variance = (config.max_speed * duration) ** 2 / 3.0
        ahead = _bent((speed * duration, 0.0, 0.0), turn)
        self._move(ahead, gains, (0.0, turn_variance, place_variance), duration)

    def _gyro_turn(self, duration: float, gyro: Gyro) -> tuple[float, float, tuple[float, float]]:
        """The unbiased turn [rad], its variance, and what bias and turn scale add to it."""
        angle, squares, _, _ = gyro
        variance = self.config.gyro_noise**2 * squares
        return angle - duration * self.likely_bias, variance, (-duration, 0.0)

    def _move(
        self,
        motion: Motion,
        gains: tuple[float, float],
        variances: tuple[float, float, float],
        duration: float,
    ) -> tuple[float, float]:
        walk = self.config.gyro_bias_walk**2 * duration
        displacement: tuple[float, float] = move(
            self.state, self.covariance, motion, gains, (*variances, walk)
        )
        return displacement


def likely_bias(believed: float, variance: float, config: FusionConfig) -> float:
    """The bias [rad/s] to expect of a gyroscope that was calibrated well, or was not.

    A second at rest measures a bias three times worse than a good calibration leaves it; taken at
    its word it would turn the map by a degree in ten minutes. Both kinds are taken as Gaussian;
    the answer is the posterior mean (Bishop 2006, 2.3.3 and 2.3.9).

    Args:
        believed: The mean of a filter that began with ``gyro_bias`` [rad/s].
        variance: Its variance [rad2/s2].
        config: What is known of gyroscopes.
    """
    prior = config.gyro_bias**2
    if not 0.0 < variance < prior:
        return believed  # known exactly, or not measured yet
    # what was measured, without the prior that the filter began with
    noise = 1.0 / (1.0 / variance - 1.0 / prior)
    measured = believed * noise / variance
    kinds = (
        (config.calibrated, config.calibrated_bias**2),
        (1.0 - config.calibrated, prior),
    )
    mean, evidence = 0.0, 0.0
    for share, bias in kinds:
        spread = bias + noise
        likelihood = share * math.exp(-0.5 * measured**2 / spread) / math.sqrt(spread)
        mean += likelihood * measured * bias / spread
        evidence += likelihood
    return mean / evidence if evidence > 0.0 else believed


def _bent(motion: Motion, turn: float) -> Motion:
    """The motion with another turn: its way points half of the difference aside."""
    ahead, left, turn_before = motion
    aside = 0.5 * (turn - turn_before)
    cos, sin = math.cos(aside), math.sin(aside)
    return cos * ahead - sin * left, sin * ahead + cos * left, turn
