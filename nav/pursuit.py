"""Tells when the way to a frontier takes so long that the robot must be going to and fro.

From one place the near side of a frontier may look best, and from half a way there its far side,
by another way: one goal, and no change of mind that loyalty could damp.
"""

import math

from nav.loyalty import NEW_AREA
from nav.viewpoint import Viewpoint

BASE_TIME = 60.0
"""Every way may take so long [s]: people may be in it, and recoveries."""

LEAST_PACE = 0.07
"""And so much longer that costs are worked off at this rate [m/s]: a third of full speed."""


class Pursuit:
    """What the robot is after, since when, and when it last saw more floor."""

    def __init__(self) -> None:
        self._target: Viewpoint | None = None
        self._area = -math.inf
        self._ends = math.inf

    def take_up(self, target: Viewpoint, time: float, area: float) -> bool:
        """Go on to a target; returns whether it shows another frontier than the last.

        Args:
            target: Where the robot sets out for.
            time: Now [s].
            area: Floor known to be free [m2].
        """
        is_new = self._target is None or not target.is_near(self._target)
        self._target = target
        if is_new or area > self._area + NEW_AREA:
            self._area = area
            self._ends = time + BASE_TIME + target.cost / LEAST_PACE
        return is_new

    def is_in_vain(self, time: float) -> bool:
        """Whether the robot has been after the same frontier for too long [s]."""
        return time > self._ends
