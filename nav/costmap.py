"""Turns a fine occupancy grid into a coarse one to plan on: cell states and metres of clearance.

The map is drawn at 1 cm but planned on at 5 cm. Clearance is still measured to the fine cells, so
that a 0.30 m door does not close because a coarse cell was rounded the wrong way.
"""

import copy
import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from mapping.burger import ROBOT_RADIUS
from mapping.errors import TestbedError
from mapping.grid import FREE, UNKNOWN, OccupancyGrid
from nav.costmap_kernels import Window, measure_clearance, pool_states, price


@dataclass(frozen=True, slots=True, kw_only=True)
class CostmapConfig:
    """How coarse the planning grid is, and how dear it is to pass close to things."""

    resolution: float = 0.05
    """Edge of a planning cell [m], as in Nav2's burger.yaml; never finer than the map's."""
    known_share: float = 0.4
    """A cell is free when at least this share of its fine cells is free and none is occupied."""
    lethal_clearance: float = ROBOT_RADIUS
    """The robot's centre never comes closer than this to an occupied cell [m]."""
    inflation: float = 0.30
    """Clearance from which a cell costs no more than its length [m]."""
    closeness_cost: float = 6.0
    """How many times its length more a step costs at the lethal clearance."""

    def __post_init__(self) -> None:
        """Refuse figures that make no costmap."""
        if not self.resolution > 0.0:
            raise TestbedError(f"costmap resolution: {self.resolution} m; must be above 0")
        if not 0.0 < self.lethal_clearance < self.inflation:
            raise TestbedError(
                f"costmap inflation: {self.inflation} m; must be above the lethal clearance, "
                f"{self.lethal_clearance} m"
            )


class Costmap:
    """The planning grid ``[row = y, col = x]``: states, clearance [m] and cost per metre."""

    def __init__(self, config: CostmapConfig | None = None) -> None:
        self.config = config or CostmapConfig()
        self.resolution = self.config.resolution
        self.origin = np.zeros(2)
        self.states: NDArray[np.int8] = np.full((0, 0), UNKNOWN, dtype=np.int8)
        """As the map has them where it was looked at last, and as others have marked them."""
        self._pooled = self.states.copy()
        self.clearance: NDArray[np.float32] = np.zeros((0, 0), dtype=np.float32)
        self.cost: NDArray[np.float32] = np.zeros((0, 0), dtype=np.float32)
        self._redraws = 0

    @property
    def free_area(self) -> float:
        """Area of the cells known to be free [m2]."""
        return float(np.count_nonzero(self.states == FREE) * self.resolution**2)

    def glance(
        self,
        grid: OccupancyGrid,
        center: ArrayLike,
        reach: float,
        place: ArrayLike,
        around: float,
    ) -> None:
        """Take over the states alone, and only around a place: enough to see what is known there.

        Clearance and cost stay as they were until the next ``refresh``, which must cover as much.

        Args:
            grid: The map.
            center: Where it changed, as for ``refresh``.
            reach: The same.
            place: What is looked at ``(2,)`` [m].
            around: How far around it [m].
        """
        if not self._fits(grid):
            self.refresh(grid)
            return
        top, bottom, left, right = self._window(np.asarray(center, dtype=np.float64), reach)
        first, last, begin, end = self._window(np.asarray(place, dtype=np.float64), around)
        window = max(top, first), min(bottom, last), max(left, begin), min(right, end)
        if window[0] < window[1] and window[2] < window[3]:
            self._pool(grid, window)

    def without_marks(self) -> "Costmap":
        """The same with the map's own states, whatever was marked on this one's.

        Clearance and cost are shared, not copied.
        """
        other = copy.copy(self)
        other.states = self._pooled.copy()
        return other

    def refresh(
        self, grid: OccupancyGrid, center: ArrayLike | None = None, reach: float = np.inf
    ) -> None:
        """Take over what changed in the map within ``reach`` [m] of ``center`` (x, y).

        Without a centre, or when the map has grown or was drawn anew since, everything is.
        """
        rows, columns = self._shape_over(grid)
        window = (0, rows, 0, columns)
        if not self._fits(grid):
            self._lay_over(grid)
        elif center is not None and np.isfinite(reach):
            window = self._window(np.asarray(center, dtype=np.float64), reach)
        self._pool(grid, window)
        self._measure(grid, window)

    def world_to_cell(self, points: ArrayLike) -> NDArray[np.int64]:
        """The cells ``(..., 2)`` as (row, column) that hold points ``(..., 2)`` as (x, y) [m]."""
        points = np.asarray(points, dtype=np.float64)
        return np.floor((points - self.origin) / self.resolution).astype(np.int64)[..., ::-1]

    def cell_to_world(self, cells: ArrayLike) -> NDArray[np.float64]:
        """The centres ``(..., 2)`` as (x, y) [m] of cells ``(..., 2)`` as (row, column)."""
        cells = np.asarray(cells, dtype=np.float64)
        return self.origin + (cells[..., ::-1] + 0.5) * self.resolution

    def clearance_at(self, point: tuple[float, float]) -> float:
        """Clearance [m] of the cell that holds a point; 0 outside the map."""
        x, y = point
        row = math.floor((y - self.origin[1]) / self.resolution)
        column = math.floor((x - self.origin[0]) / self.resolution)
        rows, columns = self.states.shape
        if 0 <= row < rows and 0 <= column < columns:
            return float(self.clearance[row, column])
        return 0.0

    def _factor(self, grid: OccupancyGrid) -> int:
        """Fine cells along the edge of a planning cell."""
        return max(1, round(self.config.resolution / grid.resolution))

    def _shape_over(self, grid: OccupancyGrid) -> tuple[int, int]:
        rows, columns = grid.shape
        factor = self._factor(grid)
        return -(-rows // factor), -(-columns // factor)

    def _fits(self, grid: OccupancyGrid) -> bool:
        """Whether the planning grid still lies over the map: not grown, not drawn anew since."""
        same_shape = self.states.shape == self._shape_over(grid)
        same_map = self._redraws == grid.redraws
        return same_map and same_shape and np.array_equal(self.origin, grid.origin)

    def _lay_over(self, grid: OccupancyGrid) -> None:
        shape = self._shape_over(grid)
        self.resolution = self._factor(grid) * grid.resolution
        self.origin = grid.origin.copy()
        self._redraws = grid.redraws
        self.states = np.full(shape, UNKNOWN, dtype=np.int8)
        self._pooled = self.states.copy()
        self.clearance = np.full(shape, self.config.inflation, dtype=np.float32)
        self.cost = np.full(shape, np.inf, dtype=np.float32)

    def _window(self, center: NDArray[np.float64], reach: float) -> Window:
        (top, left), (bottom, right) = self.world_to_cell([center - reach, center + reach])
        rows, columns = self.states.shape
        return (
            int(np.clip(top, 0, rows)),
            int(np.clip(bottom + 1, 0, rows)),
            int(np.clip(left, 0, columns)),
            int(np.clip(right + 1, 0, columns)),
        )

    def _pool(self, grid: OccupancyGrid, window: Window) -> None:
        factor = self._factor(grid)
        pool_states(
            grid.log_odds,
            np.float32(grid.config.free_below),
            np.float32(grid.config.occupied_above),
            factor,
            int(np.ceil(self.config.known_share * factor**2)),
            window,
            self._pooled,
        )
        top, bottom, left, right = window
        self.states[top:bottom, left:right] = self._pooled[top:bottom, left:right]

    def _measure(self, grid: OccupancyGrid, window: Window) -> None:
        """Clearance and cost of the window and of what lies within its reach."""
        config = self.config
        margin = int(np.ceil(config.inflation / self.resolution)) + 1
        rows, columns = self.states.shape
        top, bottom, left, right = window
        widened = (
            max(top - margin, 0),
            min(bottom + margin, rows),
            max(left - margin, 0),
            min(right + margin, columns),
        )
        measure_clearance(
            grid.log_odds,
            np.float32(grid.config.occupied_above),
            self._factor(grid),
            np.float32(self.resolution),
            np.float32(config.inflation),
            widened,
            self.states,
            self.clearance,
        )
        price(
            self.states,
            self.clearance,
            np.float32(config.lethal_clearance),
            np.float32(config.inflation),
            np.float32(config.closeness_cost),
            widened,
            self.cost,
        )
