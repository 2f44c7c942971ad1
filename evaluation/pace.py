"""Makes simulated time pass as fast as wall time, or a given number of times faster."""

import math
from collections import deque
from collections.abc import Callable
from time import monotonic

from mapping.errors import TestbedError

SLOWEST, FASTEST = 0.1, 100.0
"""Speeds that can be asked for."""

MOST_LAG = 0.5
"""Wall time [s] that is made up for by hurrying; what is lost beyond stays lost."""

WATCHED = 20
"""The newest control periods, by which a machine is judged."""

TOO_SLOW = 0.9
"""Below this share of the speed asked for, the machine is too slow."""


class Pace:
    """Says how long to wait in each control period; waiting is the caller's.

    Args:
        period: Simulated time of a control period [s].
        speed: How many times faster than real time.
        clock: Wall time [s].

    Raises:
        TestbedError: If nobody can drive so slowly or fast.
    """

    def __init__(
        self, period: float, speed: float = 1.0, clock: Callable[[], float] = monotonic
    ) -> None:
        if not (math.isfinite(speed) and SLOWEST <= speed <= FASTEST):
            raise TestbedError(f"speed: {speed}; must be {SLOWEST:g} to {FASTEST:g}")
        self._period, self._speed, self._clock = period, speed, clock
        self._due: float | None = None
        self._begun: deque[float] = deque(maxlen=WATCHED + 1)

    @property
    def speed(self) -> float:
        """How many times faster than real time the newest periods were."""
        if len(self._begun) < 2:
            return self._speed
        took = self._begun[-1] - self._begun[0]
        return (len(self._begun) - 1) * self._period / max(took, 1e-9)

    @property
    def is_too_slow(self) -> bool:
        """Whether the machine does not keep up."""
        return self.speed < TOO_SLOW * self._speed

    def left(self) -> float:
        """Wall time until the next period is due [s]; 0 when it is, and before the first."""
        return 0.0 if self._due is None else max(self._due - self._clock(), 0.0)

    def begin(self) -> None:
        """Begin the next period now."""
        now = self._clock()
        self._begun.append(now)
        planned = now if self._due is None else max(self._due, now - MOST_LAG)
        self._due = planned + self._period / self._speed

    def restart(self) -> None:
        """Take the next period for the first, as after a pause that was asked for."""
        self._due = None
        self._begun.clear()
