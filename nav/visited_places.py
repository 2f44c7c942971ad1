"""Remembers where the robot has looked from: what could be seen from there, it has seen.

A ray cast may promise a view that the lidar does not give, because a beam's width, a thin leg or a
hole in a wall is below the planning cells. A place that has been stood on keeps no such promise.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from nav.cell_memory import CellMemory
from nav.costmap import Costmap
from nav.frontier_kernels import mark_disc


@dataclass(frozen=True, slots=True, kw_only=True)
class VisitedPlacesConfig:
    """How far from a place another one counts as the same."""

    radius: float = 0.2
    """[m]; from there an edge hides hardly more or less."""


class VisitedPlaces:
    """The planning cells near which a scan was taken."""

    def __init__(self, config: VisitedPlacesConfig | None = None) -> None:
        self.config = config or VisitedPlacesConfig()
        self._memory = CellMemory()

    def note(self, costmap: Costmap, place: ArrayLike) -> None:
        """Remember a place (x, y) [m] where a scan was taken; outside the map it is ignored."""
        if costmap.states.size == 0:
            return
        self._memory.follow(costmap)
        row, column = (int(index) for index in costmap.world_to_cell(place))
        mark_disc(self._memory.marks, row, column, self.config.radius / costmap.resolution)

    def on(self, costmap: Costmap) -> NDArray[np.bool_]:
        """The visited cells as a mask ``[row, col]`` over the costmap."""
        self._memory.follow(costmap)
        return self._memory.marks
