"""Keeps count of how long the robot has given way in about one place."""

import math

import numpy as np
from numpy.typing import NDArray

LONGEST_SILENCE = 1.0
"""Time that passed without a note counts as so much at most [s]."""


class Patience:
    """Runs out when giving way gets the robot nowhere.

    Args:
        reach: Farther from where the count began, the robot has got on and it begins anew [m].
        limit: So long the robot may give way before that [s].
    """

    def __init__(self, *, reach: float, limit: float) -> None:
        self._reach, self._limit = reach, limit
        self._begin = np.full(2, np.nan)
        self._spent, self._newest = 0.0, -math.inf

    @property
    def is_out(self) -> bool:
        """Whether the robot has given way for longer than it may."""
        return self._spent > self._limit

    def note(self, place: NDArray[np.float64], time: float, *, gives_way: bool) -> None:
        """Note where the robot is ``(2,)`` [m], when [s], and whether it gave way since the last.

        Where time has run backwards or nothing was noted yet, nothing is spent.
        """
        if not math.hypot(*(place - self._begin)) <= self._reach:
            self._begin, self._spent = place.copy(), 0.0
        since = time - self._newest
        if gives_way and 0.0 < since < math.inf:
            self._spent += min(since, LONGEST_SILENCE)
        self._newest = time
