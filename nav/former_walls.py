"""Remembers walls seen from nearby, to tell new space from walls that drift has moved.

When odometry drifts, a wall is drawn again beside itself and the strip between looks like newly
found free space, with a border to the unknown that no visit ever settles. Space that opens where a
wall was known from nearby is therefore no frontier.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from nav.cell_memory import CellMemory
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
        self._memory = CellMemory()

    def note(self, costmap: Costmap, place: ArrayLike) -> None:
        """Remember the occupied cells around the robot at ``place`` (x, y) [m]."""
        self._memory.follow(costmap)
        row, column = (int(index) for index in costmap.world_to_cell(place))
        reach = self.config.trusted_range / costmap.resolution
        note_walls(costmap.states, row, column, reach, self._memory.marks)

    def unmark(self, costmap: Costmap, marked: NDArray[np.int8]) -> None:
        """Set marked cells that lie beside a former wall to 0, in place."""
        self._memory.follow(costmap)
        reach = int(np.ceil(self.config.drift / costmap.resolution))
        unmark_near_former_walls(marked, self._memory.marks, costmap.states, reach)
