"""Localises by corners from a known start: EKF localisation with unknown correspondences.

Probabilistic Robotics, table 7.3: the state is the pose, the control the motion that odometry and
gyroscope tell, and each corner of a scan measures range, bearing and direction of the landmark that
it most likely is. One Gaussian cannot say "here or there": it needs a start and finds none.
"""

import math
from dataclasses import dataclass, field, fields

import numpy as np
from numpy.typing import ArrayLike, NDArray

from mapping.errors import TestbedError
from mapping.filters import extended_kalman
from mapping.filters.gaussian import Gaussian
from mapping.geometry import Pose, compose, wrap_to_pi
from mapping.localization.hypothesis_localizer import HypothesisLocalizer
from mapping.localization.known_map import KnownMap
from mapping.localization.localizer import Hypothesis
from mapping.localization.map_corners import map_corners
from mapping.localization.scan_corners import CornerConfig, Corners, find_corners
from mapping.localization.scan_reader import ReaderConfig, Reading
from mapping.pose_covariance import turned

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True, kw_only=True)
class EkfLocalizerConfig:
    """Settings; the default is a Burger in a building."""

    corners: CornerConfig = field(default_factory=CornerConfig)
    reader: ReaderConfig = field(default_factory=ReaderConfig)
    range_sigma: float = 0.05
    """Standard deviation of a corner's range [m]: two fitted lines, and the map's own error."""
    bearing_sigma: float = 0.03
    """Of its bearing [rad]."""
    direction_sigma: float = 0.08
    """Of its direction [rad]."""
    gate: float = 3.0
    """A corner this many standard deviations from every landmark is none of them."""
    motion_factor: float = 3.0
    """How many times as much as the fusion says a motion may err: its errors are not all white."""
    lost_beyond: float = 0.5
    """With a larger standard deviation of the place than this [m] the robot is lost."""

    def __post_init__(self) -> None:
        """Refuse figures that make no localiser."""
        for each in fields(self):
            value = getattr(self, each.name)
            if isinstance(value, float) and not (math.isfinite(value) and value > 0.0):
                raise TestbedError(f"ekf {each.name}: {value}; must be finite and above 0")


class EkfLocalizer(HypothesisLocalizer):
    """The Gaussian belief of the pose, and the landmarks of the map."""

    def __init__(
        self,
        known: KnownMap,
        config: EkfLocalizerConfig | None = None,
        *,
        start: ArrayLike | None,
        start_sigmas: tuple[float, float, float] = (0.1, 0.1, 0.1),
    ) -> None:
        """Begin at a pose.

        Args:
            known: The map.
            config: Settings.
            start: The start pose ``(3,)``.
            start_sigmas: How sure it is [m, m, rad].

        Raises:
            TestbedError: There is no start.
        """
        if start is None:
            raise TestbedError(
                "start: uniform; the extended Kalman filter needs a known one, a Gaussian cannot "
                "stand for all poses"
            )
        self.config = config or EkfLocalizerConfig()
        super().__init__(self.config.reader)
        self.landmarks: Corners = map_corners(known, self.config.corners)
        self._belief = Gaussian(
            mean=np.array(start, dtype=np.float64), covariance=np.diag(np.square(start_sigmas))
        )
        self._hypotheses = self._one_place()

    @property
    def is_lost(self) -> bool:
        """Whether the place is less sure than ``lost_beyond``."""
        largest = max(self._belief.covariance[0, 0], self._belief.covariance[1, 1])
        return bool(math.sqrt(largest) > self.config.lost_beyond)

    @property
    def size(self) -> int:
        """How many landmarks the map has."""
        return len(self.landmarks)

    @property
    def sample(self) -> Pose:
        """The mean ``(1, 3)``."""
        return self._belief.mean[None, :]

    def _believe(self, reading: Reading) -> None:
        if not reading.is_first:
            self._predict(reading)
        corners = find_corners(reading.cloud.points, self.config.corners)
        for i in range(len(corners)):
            self._correct(corners, i)
        self._belief.mean[2] = wrap_to_pi(self._belief.mean[2])
        self._hypotheses = self._one_place()
        self.updates += 1

    def _likeliest_pose(self) -> Pose:
        return self._belief.mean

    def _one_place(self) -> list[Hypothesis]:
        """The one place that a Gaussian knows."""
        belief = self._belief
        return [Hypothesis(pose=belief.mean, covariance=belief.covariance, weight=1.0)]

    def _predict(self, reading: Reading) -> None:
        """Lines 2 to 5: move by what odometry and gyroscope say."""
        spread = self.config.motion_factor**2 * reading.spread
        noise = turned(spread, float(self._belief.mean[2]))
        self._belief = extended_kalman.predict(self._belief, _motion(reading.motion), noise)

    def _correct(self, corners: Corners, index: int) -> None:
        """Lines 9 to 20: find the likeliest landmark of a corner and measure it."""
        config = self.config
        x, y = corners.places[index]
        seen = np.array([math.hypot(x, y), math.atan2(y, x), corners.directions[index]])
        noise = np.diag(
            np.square([config.range_sigma, config.bearing_sigma, config.direction_sigma])
        )
        best, nearest = None, config.gate**2
        for k in self._near(corners, index):
            sensor = _sensor(self.landmarks, k)
            expected, jacobian = sensor(self._belief.mean)
            apart = _difference(seen, expected)
            distance = extended_kalman.squared_distance(self._belief, jacobian, apart, noise)
            if distance < nearest:
                best, nearest = sensor, distance
        if best is not None:
            self._belief = extended_kalman.correct(
                self._belief, best, seen, noise, difference=_difference
            )

    def _near(self, corners: Corners, index: int) -> NDArray[np.intp]:
        """Landmarks of a corner's kind near to where it seems to be."""
        place = compose(self._belief.mean, np.append(corners.places[index], 0.0))[:2]
        largest = math.sqrt(float(np.linalg.eigvalsh(self._belief.covariance[:2, :2])[-1]))
        away = np.hypot(*(self.landmarks.places - place).T)
        reach = self.config.gate * (largest + self.config.range_sigma) + SIDEWAYS
        same = self.landmarks.hollow == corners.hollow[index]
        return np.flatnonzero(same & (away <= reach))


SIDEWAYS = 0.3
"""What an error of the heading may shift a corner at the end of a beam [m]."""


def _motion(motion: Pose) -> extended_kalman.Model:
    """g of a motion in the frame of the pose before, and its Jacobian."""

    def move(pose: Array) -> tuple[Array, Array]:
        moved = compose(pose, motion)
        moved[2] = pose[2] + motion[2]
        jacobian = np.eye(3)
        jacobian[0, 2], jacobian[1, 2] = pose[1] - moved[1], moved[0] - pose[0]
        return moved, jacobian

    return move


def _sensor(landmarks: Corners, index: int) -> extended_kalman.Model:
    """h of a landmark: its range, bearing and direction from a pose, and the Jacobian."""
    place, direction = landmarks.places[index], float(landmarks.directions[index])

    def look(pose: Array) -> tuple[Array, Array]:
        dx, dy = place - pose[:2]
        square = float(dx * dx + dy * dy)
        distance = math.sqrt(square)
        expected = np.array([distance, math.atan2(dy, dx) - pose[2], direction - pose[2]])
        jacobian = np.array(
            [
                [-dx / distance, -dy / distance, 0.0],
                [dy / square, -dx / square, -1.0],
                [0.0, 0.0, -1.0],
            ]
        )
        return expected, jacobian

    return look


def _difference(first: Array, second: Array) -> Array:
    """One measurement less another, angles the short way round."""
    apart = first - second
    apart[1:] = wrap_to_pi(apart[1:])
    return np.asarray(apart)
