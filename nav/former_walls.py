"""Remembers walls seen from nearby, to tell new space from walls that drift has moved.

When odometry drifts, a wall is drawn again beside itself and the strip between looks like newly
found free space, with a border to the unknown that no visit ever settles. Space that opens where a
wall was known from nearby is therefore no frontier.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from nav.costmap import Costmap
from nav.frontier_kernels import note_walls, unmark_near_former_walls


@dataclass(frozen=True, slots=True, kw_only=True)
class FormerWallsConfig:
    """From where a wall is trusted, and how far drift may move it."""

    trusted_range: float = 2.0
    """Walls within this distance of the robot are remembered [m]: the lidar errs by 2 cm there."""
    drift: float = 0.2
    """Frontier cells this close to where a wall was are not believed [m]."""


class FormerWalls:
    """The planning cells that were ever seen occupied from nearby."""

    def __init__(self, config: FormerWallsConfig | None = None) -> None:
        self.config = config or FormerWallsConfig()
        self._walls: NDArray[np.bool_] = np.zeros((0, 0), dtype=np.bool_)
        self._origin = np.zeros(2)

    def note(self, costmap: Costmap, place: ArrayLike) -> None:
        """Remember the occupied cells around the robot at ``place`` (x, y) [m]."""
        self._follow(costmap)
        row, column = (int(index) for index in costmap.world_to_cell(place))
        note_walls(
            costmap.states,
            row,
            column,
            self.config.trusted_range / costmap.resolution,
            self._walls,
        )

    def unmark(self, costmap: Costmap, marked: NDArray[np.int8]) -> None:
        """Set marked cells that lie beside a former wall to 0, in place."""
        self._follow(costmap)
        reach = int(np.ceil(self.config.drift / costmap.resolution))
        unmark_near_former_walls(marked, self._walls, costmap.states, reach)

    def _follow(self, costmap: Costmap) -> None:
        """Move what is remembered onto the costmap's cells when the map has grown."""
        shape = costmap.states.shape
        if shape == self._walls.shape and np.array_equal(self._origin, costmap.origin):
            return
        walls, origin = self._walls, self._origin
        self._walls = np.zeros(shape, dtype=np.bool_)
        self._origin = costmap.origin.copy()
        cells = np.argwhere(walls)
        if len(cells):
            column_shift, row_shift = np.round((origin - self._origin) / costmap.resolution)
            cells = cells + np.array([row_shift, column_shift], dtype=np.int64)
            inside = np.all((cells >= 0) & (cells < shape), axis=1)
            self._walls[cells[inside, 0], cells[inside, 1]] = True
