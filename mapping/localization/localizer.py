"""What every localiser does: take messages, say where on the map the robot is and how sure."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from mapping.geometry import Pose
from mapping.messages import Imu, LaserScan, Odometry

AMBIGUOUS_BELOW = 0.9
"""With less of the belief than this in the best hypothesis there is more than one place."""

LOST_BELOW = 0.5
"""With less than this no place is likelier than all others together."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Hypothesis:
    """A place where the robot may be."""

    pose: Pose
    """Pose of base_footprint in the map frame ``(3,)``."""
    covariance: NDArray[np.float64]
    """How sure it is if it is the right one ``(3, 3)`` [m2, m2, rad2]."""
    weight: float
    """Probability that it is the right one, 0..1."""


class Localizer(Protocol):
    """Finds the robot on a map; sees sensor messages only, never the truth."""

    @property
    def pose_map(self) -> Pose:
        """The best guess now ``(3,)``: that of the likeliest hypothesis, moved on by odometry."""

    @property
    def covariance(self) -> NDArray[np.float64]:
        """Its covariance ``(3, 3)`` if the likeliest hypothesis is the right one."""

    @property
    def hypotheses(self) -> Sequence[Hypothesis]:
        """The places where the robot may be, likeliest first; weights sum to 1 at most."""

    @property
    def is_ambiguous(self) -> bool:
        """Whether places other than the likeliest are still believed possible."""

    @property
    def is_lost(self) -> bool:
        """Whether no place is likelier than all others together."""

    @property
    def updates(self) -> int:
        """How many scans were used."""

    @property
    def size(self) -> int:
        """How much the newest scan was compared with: particles, cells, or landmarks."""

    @property
    def sample(self) -> Pose:
        """Poses ``(n, 3)`` that stand for the belief, for drawing."""

    def update(
        self, scan: LaserScan | None, odometry: Sequence[Odometry], imu: Sequence[Imu] = ()
    ) -> None:
        """Take the messages of one control period, as ``Mapper.update`` does."""


def is_ambiguous(hypotheses: Sequence[Hypothesis]) -> bool:
    """Whether the likeliest hypothesis leaves room for others."""
    return not hypotheses or hypotheses[0].weight < AMBIGUOUS_BELOW


def is_lost(hypotheses: Sequence[Hypothesis]) -> bool:
    """Whether the likeliest hypothesis is less likely than all others together."""
    return not hypotheses or hypotheses[0].weight < LOST_BELOW
