"""Keeps to one way round while turning on the spot; tries the other when that is blocked."""

import math

STALLED_RATE = 0.05
"""A robot that turns slower than this although it wants to is blocked [rad/s]."""
PATIENCE = 0.6
"""Time blocked after which the other way round is tried [s]; three scans."""


class SpotTurn:
    """One turn at a time: begun with a direction, asked each period, ended."""

    def __init__(self) -> None:
        self.direction = 0.0
        """+1 counter-clockwise, -1 clockwise, 0 when no turn is going on."""
        self._yaw = 0.0
        self._blocked = 0.0

    def begin(self, direction: float, yaw: float) -> None:
        """Start to turn, from heading ``yaw`` [rad]."""
        self.direction, self._yaw, self._blocked = direction, yaw, 0.0

    def end(self) -> None:
        """The heading is reached, or no longer wanted."""
        self.direction = 0.0

    def update(self, yaw: float, period: float) -> float:
        """Take the heading of this period; the direction to turn on in."""
        turned = abs(math.remainder(yaw - self._yaw, 2.0 * math.pi))
        self._yaw = yaw
        self._blocked = self._blocked + period if turned < STALLED_RATE * period else 0.0
        if self._blocked > PATIENCE:
            self.direction, self._blocked = -self.direction, 0.0
        return self.direction
