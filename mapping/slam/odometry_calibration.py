"""Learns from matched scans how far the odometry errs each time: scale, drift, turn and offset."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from mapping.errors import TestbedError
from mapping.geometry import Pose, wrap_to_pi

SMALLEST = np.diag(np.square([5e-4, 5e-4, 2e-4]))
"""No motion is surer than this [m^2, m^2, rad^2]: scans come at odd times between messages."""

SMALLEST_WITH_GYRO = np.diag(np.square([5e-4, 5e-4, 1e-4]))
"""Nor one whose turn comes from a gyroscope: as a random walk of 5 scans a second this is as much
after 100 s as a bias of 2e-5 rad/s, which a second or two of rest leave unknown."""

LARGEST_SURPRISE = 9.0
"""A surprise beyond three standard deviations counts as one of three."""


@dataclass(frozen=True, slots=True, kw_only=True)
class CalibrationConfig:
    """How wrong the odometry may be, systematically, and how fast that changes.

    The first three errors are those of a differential drive (Borenstein and Feng 1996): of the
    wheels' mean radius, of the difference between the radii, and of the wheel base. The settings
    are assumptions that held for a Burger and for the robot of the Intel Research Lab log.
    """

    scale_sigma: float = 0.02
    """Prior standard deviation of the relative error of the way."""
    drift_sigma: float = 0.05
    """The same of the turn that is made in each metre of way [rad/m]."""
    turn_sigma: float = 0.05
    """The same of the relative error of turns."""
    offset_sigma: float = 0.05
    """The same of how far ahead of its centre the robot turns about a point, as a lidar mounted
    elsewhere than the log says makes it seem to [m]."""
    least_share: float = 0.01
    """No way or turn is surer than this share of itself, nor a heading than this for each metre."""
    turn_arm: float = 0.2
    """A turn moves a place as much as a way of this for each radian [m]."""
    first_noise: float = 100.0
    """How many times the motion model's variances to expect at first, and at most: a robot that
    nobody has measured may be ten times worse than a Burger."""
    noise_step: float = 0.05
    """How fast that is learned: relative change by a match as good, or as bad, as can be."""
    unlearned: float = 2.0
    """How many times as large as the filter says the errors left may be: it takes the errors of
    matches to be independent, but along one wall they are alike."""
    wander: float = 1e-4
    """Share of the prior variance that each match gives back, as errors change with the floor."""

    def __post_init__(self) -> None:
        """Refuse figures that are no errors."""
        for name in self.__slots__:
            value = getattr(self, name)
            if not (math.isfinite(value) and value >= 0.0):
                raise TestbedError(f"calibration {name}: {value}; must be finite and not negative")
        if self.first_noise < 1.0:
            raise TestbedError(f"calibration first_noise: {self.first_noise}; must be at least 1")


class OdometryCalibration:
    """A Kalman filter of the four systematic errors."""

    def __init__(self, config: CalibrationConfig | None = None) -> None:
        self.config = config or CalibrationConfig()
        config = self.config
        sigmas = (
            config.scale_sigma,
            config.drift_sigma,
            config.turn_sigma,
            config.offset_sigma,
        )
        self._prior = np.diag(np.square(sigmas))
        self.errors = np.zeros(4)
        """Relative error of the way, turn per metre [rad/m], relative error of turns, offset
        ahead of the point turned about [m] ``(4,)``."""
        self.ahead_noise = self.aside_noise = self.turn_noise = self.config.first_noise
        """How many times larger the variances are than the motion model says."""
        self.covariance = self._prior.copy()

    def trust_heading(self) -> None:
        """Learn of scale and offset only from now on: the turns come from a gyroscope.

        A few bad matches must not teach that a heading which hardly drifts does.
        """
        heading = [1, 2]
        self.errors[heading] = 0.0
        for covariance in (self.covariance, self._prior):
            covariance[heading, :] = 0.0
            covariance[:, heading] = 0.0

    def corrected(self, motion: ArrayLike) -> Pose:
        """A motion ``(3,)`` of the odometry, without the errors learned so far."""
        motion = np.asarray(motion, dtype=np.float64)
        scale, drift, turn, offset = self.errors
        x, y, yaw = motion
        bent = drift * x
        # the drift bends the way evenly: its end lies half of the bend off
        half = 0.5 * bent
        return np.array(
            [
                (1.0 + scale) * (x - half * y),
                (1.0 + scale) * (y + half * x) + offset * yaw,
                wrap_to_pi(yaw * (1.0 + turn) + bent),
            ]
        )

    def widened(
        self, motion: Pose, covariance: NDArray[np.float64], *, has_gyro: bool
    ) -> NDArray[np.float64]:
        """The covariance of a motion ``(3, 3)``, as much wider as the surprises so far ask for.

        Errors ahead, aside and in turning are taken to be independent: that one follows from
        another holds for a robot whose wheels never slip sideways.

        Args:
            motion: The odometry's motion ``(3,)``.
            covariance: What the motion model says ``(3, 3)``.
            has_gyro: Whether the turn comes from a gyroscope, whose model holds for any robot.
        """
        ahead, aside, turn = np.diag(covariance)
        noise = np.array([self.ahead_noise, self.aside_noise, self.turn_noise])
        way, angle = float(np.hypot(motion[0], motion[1])), abs(float(motion[2]))
        place = way + self.config.turn_arm * angle
        least = self.config.least_share * np.array([place, place, angle + way])
        smallest = SMALLEST
        if has_gyro:
            least[2], noise[2], smallest = 0.0, 1.0, SMALLEST_WITH_GYRO
        wide = noise * (np.array([ahead, max(ahead, aside), turn]) + least**2)
        return np.asarray(np.diag(wide) + smallest, dtype=np.float64)

    def left(
        self, unmatched: NDArray[np.float64], motion: Pose
    ) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """What the errors not learned yet add to the covariance of a motion without matches.

        They are the same from motion to motion, so that ways and headings go wrong in proportion
        to the way, and not to its root as by noise: what is added is the difference of squares.
        The scale is taken to err in any direction: the robot turns on its way.

        Args:
            unmatched: Way [m] and turn [rad] made since the last match ``(2,)``.
            motion: The odometry's motion that follows ``(3,)``.

        Returns:
            The covariance to add ``(3, 3)``, and way and turn after the motion ``(2,)``.
        """
        made = unmatched + (math.hypot(motion[0], motion[1]), abs(float(motion[2])))
        way, turn = made**2 - unmatched**2
        scale, drift, turning, _ = self.config.unlearned**2 * np.diag(self.covariance)
        place = scale * way
        return np.diag([place, place, drift * way + turning * turn]), made

    def learn(self, motion: Pose, matched: Pose, covariance: NDArray[np.float64]) -> None:
        """Compare a motion of the odometry with the same motion as matching gave it.

        Args:
            motion: What the odometry said ``(3,)``.
            matched: What matching gave ``(3,)``.
            covariance: Of the difference between the two but for systematic errors ``(3, 3)``.
        """
        self.covariance = self.covariance + self.config.wander * self._prior
        ahead, aside, turn = motion
        # a drift bends the way evenly, so that its end lies half of the bend aside
        rows = np.array(
            [
                [ahead, -0.5 * ahead * aside, 0.0, 0.0],
                [aside, 0.5 * ahead * ahead, 0.0, turn],
                [0.0, ahead, turn, 0.0],
            ]
        )
        seen = matched - motion
        seen[2] = wrap_to_pi(seen[2])
        spread = rows @ self.covariance @ rows.T + covariance
        surprise = seen - rows @ self.errors
        self._learn_noise(surprise, spread)
        gain = np.linalg.solve(spread, rows @ self.covariance).T
        self.errors = self.errors + gain @ surprise
        self.covariance = self.covariance - gain @ rows @ self.covariance

    def _learn_noise(self, surprise: NDArray[np.float64], spread: NDArray[np.float64]) -> None:
        """Move the noise towards what makes surprises as large as they are expected to be."""
        ratios = np.minimum(surprise**2 / np.diag(spread), LARGEST_SURPRISE)
        ahead, aside, turn = np.exp(self.config.noise_step * (ratios - 1.0)).tolist()
        most = self.config.first_noise
        self.ahead_noise = min(max(self.ahead_noise * ahead, 1.0), most)
        self.aside_noise = min(max(self.aside_noise * aside, 1.0), most)
        self.turn_noise = min(max(self.turn_noise * turn, 1.0), most)
