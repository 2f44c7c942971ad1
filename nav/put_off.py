"""Turns viewpoints into those that matter now: small frontiers wait until the large ones are done.

What most of the floor needs to be seen is few large views; the many small ones, behind a chair or
in a corner, cost most of the way. What stays small together can wait, and is picked up at the end.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mapping.errors import TestbedError
from nav.viewpoint import SAME_FRONTIER, Viewpoint


@dataclass(frozen=True, slots=True, kw_only=True)
class PutOffConfig:
    """How much may wait."""

    share: float = 0.03
    """The frontiers that wait show this share of the known floor together, at most; 0 for none."""
    most: float = 1.0
    """One that shows more never waits [m2]: behind it may lie a room."""
    grown: float = 1.5
    """A frontier that shows this many times what it did when it was put off waits no longer."""

    def __post_init__(self) -> None:
        """Refuse figures that are no share or no growth."""
        if not 0.0 <= self.share <= 1.0:
            raise TestbedError(f"put off share: {self.share}; must be from 0 to 1")
        if not self.most >= 0.0:
            raise TestbedError(f"put off most: {self.most}; must be 0 or more")
        if not self.grown >= 1.0:
            raise TestbedError(f"put off grown: {self.grown}; must be at least 1")


class PutOff:
    """Remembers what was put off, so that no frontier is put off and taken up by turns."""

    def __init__(self, config: PutOffConfig | None = None) -> None:
        self.config = config or PutOffConfig()
        self._waiting: list[tuple[NDArray[np.float64], float]] = []
        self.is_over = False
        """Whether nothing waits any longer: what was put off is all that is left."""

    def worth_now(self, viewpoints: Sequence[Viewpoint], floor: float) -> list[Viewpoint]:
        """The viewpoints of frontiers that do not wait; all of them once no other is left.

        Args:
            viewpoints: Candidates, any number of a frontier.
            floor: Area known to be free [m2].
        """
        if self.is_over:
            return list(viewpoints)
        waiting = self._choose(viewpoints, self.config.share * floor)
        now = [item for item in viewpoints if id(item.frontier) not in waiting]
        if not now:
            self.is_over = True
            return list(viewpoints)
        return now

    def _choose(self, viewpoints: Sequence[Viewpoint], left: float) -> set[int]:
        """The ids of the frontiers that wait: those put off before, then the smallest."""
        largest: dict[int, Viewpoint] = {}
        for item in viewpoints:
            known = largest.get(id(item.frontier))
            if known is None or item.gain > known.gain:
                largest[id(item.frontier)] = item
        waiting = {key for key, item in largest.items() if self._waits(item)}
        left -= sum(largest[key].gain for key in waiting)
        for key, item in sorted(largest.items(), key=lambda entry: entry[1].gain):
            if key in waiting:
                continue
            left -= item.gain
            if left < 0.0 or item.gain > self.config.most:
                break
            waiting.add(key)
            self._waiting.append((item.frontier.middle, item.gain))
        return waiting

    def _waits(self, item: Viewpoint) -> bool:
        """Whether a frontier was put off before and has not grown much since."""
        return any(
            item.frontier.distance_to(middle) < SAME_FRONTIER
            and item.gain <= self.config.grown * gain
            for middle, gain in self._waiting
        )
