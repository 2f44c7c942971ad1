"""Notices that a robot which wants to move does not: no new place, no new heading."""

from dataclasses import dataclass

import numpy as np

from mapping.geometry import Pose, wrap_to_pi


@dataclass(frozen=True, slots=True, kw_only=True)
class HeadwayConfig:
    """What counts as headway."""

    patience: float = 4.0
    """Time without headway after which it is lost [s]."""
    distance: float = 0.06
    """Moving this far is headway [m]."""
    turn: float = 0.4
    """Turning this far is headway [rad]."""
    turning_patience: float = 15.0
    """Time without moving, however much it turns, after which headway is lost [s]."""


class Headway:
    """Remembers where the robot last got on."""

    def __init__(self, config: HeadwayConfig | None = None) -> None:
        self.config = config or HeadwayConfig()
        self.restart()

    def restart(self) -> None:
        """Begin anew, with full patience."""
        self._moved: Pose | None = None
        self._turned: Pose | None = None
        self._since_moved = self._since_turned = 0.0

    def is_lost(self, pose: Pose, period: float) -> bool:
        """Take the pose of this period; whether headway is lost by now."""
        if self._moved is None or np.hypot(*(pose - self._moved)[:2]) > self.config.distance:
            self._moved = self._turned = pose.copy()
            self._since_moved = self._since_turned = 0.0
            return False
        self._since_moved += period
        self._since_turned += period
        if self._turned is None or abs(wrap_to_pi(pose[2] - self._turned[2])) > self.config.turn:
            self._turned, self._since_turned = pose.copy(), 0.0
        return (
            self._since_turned > self.config.patience
            or self._since_moved > self.config.turning_patience
        )
