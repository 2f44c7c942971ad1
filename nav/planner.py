"""Turns a costmap and a place into the cheapest ways from there to everywhere (Dijkstra 1959)."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from nav.costmap import Costmap
from nav.dijkstra_kernel import spread_cost
from nav.planner_kernels import costs_along_tree, descend, shortcut_in_sight, shorten

ESCAPE_COST = 20.0
"""Cost per metre of leaving a place too close to things; dear, so that it is left at once."""


@dataclass(frozen=True, slots=True, kw_only=True)
class CostField:
    """What it costs to come from one place to every cell of a costmap."""

    costmap: Costmap
    cost_to_come: NDArray[np.float32]
    """Cost ``[row, col]`` from the start [m, dearer near things]; inf where no way is known."""
    parents: NDArray[np.int32]
    """Flat index of the cell each cell is reached from; -1 at the start and where none leads."""

    @classmethod
    def around(
        cls,
        costmap: Costmap,
        start: ArrayLike,
        *,
        max_cost: float = np.inf,
        escape_radius: float = 0.25,
    ) -> "CostField":
        """Spread cost from ``start`` (x, y) [m] over the 8-connected costmap (Dijkstra 1959).

        Args:
            costmap: Where to spread.
            start: The place to come from; outside the map nothing is reachable.
            max_cost: Stop when every cheaper cell is settled.
            escape_radius: Within this distance of the start [m], cells that are too close to
                things but not occupied may be crossed dearly: the robot stands there already.
        """
        row, column = (int(index) for index in costmap.world_to_cell(start))
        cost_to_come, parents = spread_cost(
            costmap.cost,
            costmap.states,
            row,
            column,
            costmap.resolution,
            max_cost,
            escape_radius,
            ESCAPE_COST,
            1.0 + costmap.config.closeness_cost,
        )
        return cls(costmap=costmap, cost_to_come=cost_to_come, parents=parents)

    def reaches(self, point: ArrayLike) -> bool:
        """Whether a way to the point (x, y) is known."""
        return bool(np.isfinite(self.cost_at(point)))

    @property
    def reached_area(self) -> float:
        """Area of the cells that a way is known to [m2]."""
        return float(np.isfinite(self.cost_to_come).sum() * self.costmap.resolution**2)

    def nearest_reached(self, point: ArrayLike, within: float) -> NDArray[np.float64] | None:
        """The place nearest to a point (x, y) that a way is known to; None if none is so near [m].

        The point itself if it is reached, else the middle of a cell.
        """
        point = np.asarray(point, dtype=np.float64)[:2]
        if self.reaches(point):
            return point
        places = self.costmap.cell_to_world(np.argwhere(np.isfinite(self.cost_to_come)))
        if len(places) == 0:
            return None
        gaps = np.hypot(*(places - point).T)
        nearest = int(np.argmin(gaps))
        return np.asarray(places[nearest]) if gaps[nearest] <= within else None

    def cost_at(self, point: ArrayLike) -> float:
        """Cost to come to the point (x, y); inf outside the map."""
        row, column = self.costmap.world_to_cell(point)
        rows, columns = self.cost_to_come.shape
        if 0 <= row < rows and 0 <= column < columns:
            return float(self.cost_to_come[row, column])
        return float(np.inf)

    def costs_between(self, points: ArrayLike) -> NDArray[np.float64]:
        """Cost of the way between reachable points ``(n, 2)``, as ``(n, n)``; never too low.

        By way of this field's own tree, or straight where that is open: exact enough to put places
        in order, and a thousand times cheaper than a search from each.
        """
        cells = self.costmap.world_to_cell(points)
        costs = costs_along_tree(self.parents, self.cost_to_come, cells)
        shortcut_in_sight(cells, self.costmap.cost, self.costmap.resolution, costs)
        between: NDArray[np.float64] = costs
        return between

    def path_to(self, point: ArrayLike) -> NDArray[np.float64]:
        """The cheapest path ``(n, 2)`` from the start to the point, both included, pulled taut.

        Raises:
            ValueError: If no way is known; ask ``reaches`` first.
        """
        if not self.reaches(point):
            raise ValueError(f"no known way to {point!r}")
        row, column = (int(index) for index in self.costmap.world_to_cell(point))
        cells = descend(self.parents, row, column)
        return self.costmap.cell_to_world(shorten(cells, self.costmap.cost))
