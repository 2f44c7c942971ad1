"""Notices that a robot which wants to move does not: no new place, no new heading."""

import math
from dataclasses import dataclass

from mapping.geometry import Pose


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
        self._place: tuple[float, float] | None = None
        self._yaw = 0.0
        self._since_moved = self._since_turned = 0.0

    def is_lost(self, pose: Pose, period: float) -> bool:
        """Take the pose of this period; whether headway is lost by now."""
        x, y, yaw = pose.tolist()
        config = self.config
        if self._place is None or math.dist(self._place, (x, y)) > config.distance:
            self._place, self._yaw = (x, y), yaw
            self._since_moved = self._since_turned = 0.0
            return False
        self._since_moved += period
        self._since_turned += period
        if abs(math.remainder(yaw - self._yaw, 2.0 * math.pi)) > config.turn:
            self._yaw, self._since_turned = yaw, 0.0
        return self._since_turned > config.patience or self._since_moved > config.turning_patience
