"""What the explorer remembers by place; forgotten as a whole when the map has moved too far."""

import numpy as np
from numpy.typing import NDArray

from mapping.grid import OccupancyGrid
from nav.closed_gaps import ClosedGaps
from nav.costmap import Costmap
from nav.former_walls import FormerWalls, FormerWallsConfig
from nav.returns import Returns
from nav.scan_points import ScanView
from nav.visited_places import VisitedPlaces, VisitedPlacesConfig


class PlaceMemory:
    """Where it has looked from, where walls were, where scans met something, what is too narrow."""

    def __init__(self, visited: VisitedPlacesConfig, former_walls: FormerWallsConfig) -> None:
        self._configs = visited, former_walls
        self._is_redrawn = False
        self.forget()

    def forget(self) -> None:
        """Begin anew."""
        visited, former_walls = self._configs
        self.visited = VisitedPlaces(visited)
        self.former_walls = FormerWalls(former_walls)
        self.returns = Returns()
        self.gaps = ClosedGaps()

    def note_redraw(self) -> None:
        """Take note that the map is drawn anew: it will tell by itself what scans met."""
        self._is_redrawn = True

    def note_scan(
        self, costmap: Costmap, robot: NDArray[np.float64], view: ScanView | None
    ) -> None:
        """Take in what a scan saw, and from where ``(2,)``."""
        self.visited.note(costmap, robot)
        if view is not None:
            self.returns.note(costmap, view)

    def mark(self, costmap: Costmap, grid: OccupancyGrid, robot: NDArray[np.float64]) -> None:
        """Put all of it on a costmap of a map, just refreshed around the robot ``(2,)``."""
        if self._is_redrawn:
            self.returns.take_over(costmap, grid)
            self._is_redrawn = False
        self.former_walls.note(costmap, robot)
        self.returns.mark(costmap)  # after that: they are no walls that drift could move
        self.gaps.mark(costmap)

    def mark_sure(self, costmap: Costmap) -> None:
        """Put on it only what surely is a wall."""
        self.returns.mark(costmap, sure=True)
