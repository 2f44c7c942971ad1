"""Grows loyal to a goal each time the robot turns back and forth without seeing anything new.

A tour found by local search need not be the best one, and half a second later, from half a metre
farther on, another one may look better, and then the first again.
"""

from nav.viewpoint import Viewpoint

GROWTH = 2.0
"""Each change of mind makes the robot this many times as loyal."""
MOST = 64.0
"""No more than that."""
NEW_AREA = 0.5
"""The robot has got on when it knows so much more floor than when it last got on [m2]."""


class Loyalty:
    """Counts changes of mind since the robot last got on."""

    def __init__(self) -> None:
        self.times = 1.0
        """How many times as loyal as usual."""
        self._area = 0.0

    def note(self, current: Viewpoint | None, chosen: Viewpoint | None, area: float) -> None:
        """Take note of a decision, and of the area [m2] known to be free when it was taken."""
        if area > self._area + NEW_AREA:
            self.times, self._area = 1.0, area
        if current is not None and chosen is not None and not chosen.is_near(current):
            self.times = min(GROWTH * self.times, MOST)
