"""Turns a fine occupancy grid into a coarse one to plan on: cell states and metres of clearance.

The map is drawn at 1 cm but planned on at 5 cm. Clearance is still measured to the fine cells, so
that a 0.30 m door does not close because a coarse cell was rounded the wrong way.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from mapping.burger import ROBOT_RADIUS
from mapping.errors import TestbedError
from mapping.grid import OccupancyGrid
from nav.costmap_kernels import measure_clearance, pool_states, price


@dataclass(frozen=True, slots=True, kw_only=True)
class CostmapConfig:
    """How coarse the planning grid is, and how dear it is to pass close to things."""

    resolution: float = 0.05
    """Edge of a planning cell [m], as in Nav2's burger.yaml; never finer than the map's."""
    known_share: float = 0.4
    """A cell is free when at least this share of its fine cells is free and none is occupied."""
    lethal_clearance: float = ROBOT_RADIUS
    """The robot's centre never comes closer than this to an occupied cell [m]."""
    inflation: float = 0.35
    """Clearance from which a cell costs no more than its length [m]."""
    closeness_cost: float = 4.0
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
        self.states: NDArray[np.int8] = np.full((0, 0), -1, dtype=np.int8)
        self.clearance: NDArray[np.float32] = np.zeros((0, 0), dtype=np.float32)
        self.cost: NDArray[np.float32] = np.zeros((0, 0), dtype=np.float32)

    def refresh(
        self, grid: OccupancyGrid, center: ArrayLike | None = None, reach: float = np.inf
    ) -> None:
        """Take over what changed in the map within ``reach`` [m] of ``center`` (x, y).

        Without a centre, or when the map has grown since, everything is taken over.
        """
        factor = max(1, round(self.config.resolution / grid.resolution))
        shape = (-(-grid.shape[0] // factor), -(-grid.shape[1] // factor))
        moved = shape != self.states.shape or not np.array_equal(self.origin, grid.origin)
        if moved:
            self.resolution = factor * grid.resolution
            self.origin = grid.origin.copy()
            self.states = np.full(shape, -1, dtype=np.int8)
            self.clearance = np.full(shape, self.config.inflation, dtype=np.float32)
            self.cost = np.full(shape, np.inf, dtype=np.float32)
        if moved or center is None or not np.isfinite(reach):
            window = (0, shape[0], 0, shape[1])
        else:
            window = self._window(np.asarray(center, dtype=np.float64), reach)
        self._take_over(grid, factor, window)

    def world_to_cell(self, points: ArrayLike) -> NDArray[np.int64]:
        """The cells ``(..., 2)`` as (row, column) that hold points ``(..., 2)`` as (x, y) [m]."""
        points = np.asarray(points, dtype=np.float64)
        return np.floor((points - self.origin) / self.resolution).astype(np.int64)[..., ::-1]

    def cell_to_world(self, cells: ArrayLike) -> NDArray[np.float64]:
        """The centres ``(..., 2)`` as (x, y) [m] of cells ``(..., 2)`` as (row, column)."""
        cells = np.asarray(cells, dtype=np.float64)
        return self.origin + (cells[..., ::-1] + 0.5) * self.resolution

    def clearance_at(self, point: ArrayLike) -> float:
        """Clearance [m] of the cell that holds a point; 0 outside the map."""
        row, column = self.world_to_cell(point)
        rows, columns = self.states.shape
        if 0 <= row < rows and 0 <= column < columns:
            return float(self.clearance[row, column])
        return 0.0

    def _window(self, center: NDArray[np.float64], reach: float) -> tuple[int, int, int, int]:
        (top, left), (bottom, right) = self.world_to_cell([center - reach, center + reach])
        rows, columns = self.states.shape
        return (
            int(np.clip(top, 0, rows)),
            int(np.clip(bottom + 1, 0, rows)),
            int(np.clip(left, 0, columns)),
            int(np.clip(right + 1, 0, columns)),
        )

    def _take_over(
        self, grid: OccupancyGrid, factor: int, window: tuple[int, int, int, int]
    ) -> None:
        config = self.config
        pool_states(
            grid.log_odds,
            np.float32(grid.config.free_below),
            np.float32(grid.config.occupied_above),
            factor,
            int(np.ceil(config.known_share * factor**2)),
            window,
            self.states,
        )
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
            factor,
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
