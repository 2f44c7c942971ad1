"""Keeps the gaps in which the robot got nowhere closed, so that it looks for another way.

The planner trusts the map to a cell, the safety layer keeps a margin: now and then there is a gap
that the one leads through and the other does not let the robot pass. Without a memory of it the
robot would be sent into it again from each frontier behind.
"""

import numpy as np
from numpy.typing import NDArray

from nav.costmap import Costmap

RADIUS = 0.15
"""How far around its place a gap is closed [m]: those that are in question are narrower than 0.3 m,
in wider ones the safety layer leaves the robot 6 cm on both sides."""


class ClosedGaps:
    """The places at which the robot got nowhere."""

    def __init__(self) -> None:
        self._places: list[NDArray[np.float64]] = []

    def close(self, place: NDArray[np.float64]) -> None:
        """Close the gap at a place ``(2,)`` [m]."""
        self._places.append(np.array(place, dtype=np.float64))

    def reopen(self) -> bool:
        """Open all again; False if none was closed. The costmap must be refreshed after it."""
        was_closed = bool(self._places)
        self._places.clear()
        return was_closed

    def mark(self, costmap: Costmap) -> None:
        """Let no way lead through them."""
        rows, columns = costmap.cost.shape
        span = int(np.ceil(RADIUS / costmap.resolution))
        for place in self._places:
            row, column = costmap.world_to_cell(place).tolist()
            top, left = max(row - span, 0), max(column - span, 0)
            bottom, right = min(row + span + 1, rows), min(column + span + 1, columns)
            window = np.ogrid[top : max(bottom, top), left : max(right, left)]
            y = costmap.origin[1] + (window[0] + 0.5) * costmap.resolution - place[1]
            x = costmap.origin[0] + (window[1] + 0.5) * costmap.resolution - place[0]
            costmap.cost[top:bottom, left:right][np.hypot(x, y) <= RADIUS] = np.inf
