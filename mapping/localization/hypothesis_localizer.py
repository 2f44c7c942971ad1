"""What all localisers share: turns scans into hypotheses, and these into a pose and its doubt."""

from abc import ABC, abstractmethod
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from mapping.geometry import Pose, compose
from mapping.localization import localizer
from mapping.localization.hypothesis_tracker import HypothesisTracker
from mapping.localization.localizer import Hypothesis
from mapping.localization.scan_reader import ReaderConfig, Reading, ScanReader
from mapping.messages import Imu, LaserScan, Odometry


class HypothesisLocalizer(ABC):
    """A ``Localizer`` whose filter says after every reading where the robot may be.

    A filter keeps a belief of its own and fills in ``_hypotheses``, likeliest first.
    """

    def __init__(self, reader: ReaderConfig, tracker: HypothesisTracker | None = None) -> None:
        """Begin without a reading.

        Args:
            reader: The lidar.
            tracker: Follows the likeliest hypothesis, where the belief is coarser than a match.
        """
        self.updates = 0
        self._reader = ScanReader(reader)
        self._tracker = tracker
        self._hypotheses: list[Hypothesis] = []

    @property
    def pose_map(self) -> Pose:
        """The best guess now ``(3,)``."""
        return compose(self._pose_then(), self._reader.motion_since())

    @property
    def covariance(self) -> NDArray[np.float64]:
        """Its covariance ``(3, 3)`` if the likeliest hypothesis is the right one."""
        if self._tracker is not None and self._tracker.pose is not None:
            return self._tracker.covariance
        if self._hypotheses:
            return self._hypotheses[0].covariance
        return np.asarray(np.cov(self.sample.T))

    @property
    def hypotheses(self) -> Sequence[Hypothesis]:
        """The places where the robot may be, likeliest first."""
        return tuple(self._hypotheses)

    @property
    def is_ambiguous(self) -> bool:
        """Whether other places than the likeliest are still believed possible."""
        return localizer.is_ambiguous(self._hypotheses)

    @property
    def is_lost(self) -> bool:
        """Whether no place is likelier than all others together."""
        return localizer.is_lost(self._hypotheses)

    @property
    @abstractmethod
    def size(self) -> int:
        """How much the newest scan was compared with."""

    @property
    @abstractmethod
    def sample(self) -> Pose:
        """Poses ``(n, 3)`` that stand for the belief."""

    def update(
        self, scan: LaserScan | None, odometry: Sequence[Odometry], imu: Sequence[Imu] = ()
    ) -> None:
        """Take the messages of one control period."""
        self._reader.add(odometry, imu)
        reading = self._reader.read(scan)
        if reading is None:
            return
        self._believe(reading)
        if self._tracker is not None:
            self._tracker.follow(reading, self._hypotheses[0] if self._hypotheses else None)

    @abstractmethod
    def _believe(self, reading: Reading) -> None:
        """Move the belief and weigh it by a reading; tell the hypotheses."""

    @abstractmethod
    def _likeliest_pose(self) -> Pose:
        """The pose ``(3,)`` that the belief holds for likeliest, where there is no hypothesis."""

    def _pose_then(self) -> Pose:
        """The best guess at the newest reading."""
        if self._tracker is not None and self._tracker.pose is not None:
            return self._tracker.pose
        if self._hypotheses:
            return self._hypotheses[0].pose
        return self._likeliest_pose()
