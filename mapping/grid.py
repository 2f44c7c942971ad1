"""The occupancy grid: log odds in an array, where its cells lie in the world, their states.

Row is y, column is x, and row 0 lies at the origin: only image writers flip. The origin is the
lower-left corner of cell (0, 0), as map_server has it, so a cell's centre is
``origin + (index + 0.5) * resolution``.
"""

import logging
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from mapping.errors import TestbedError

logger = logging.getLogger(__name__)

UNKNOWN, FREE, OCCUPIED = -1, 0, 100
"""Cell states, with the values that nav_msgs/OccupancyGrid gives them."""

TILE_CELLS = 240
"""A growing grid grows by whole tiles of this many cells, so that it seldom has to; a number that
many whole numbers divide, so that coarser grids laid over it keep their cells."""

MOST_CELLS = 64_000_000
"""A growing grid has at most so many cells: 80 x 80 m at 1 cm, or 400 x 400 m at 5 cm, in 256 MB.
An odometry that jumps by a kilometre must not take all memory."""


@dataclass(frozen=True, slots=True, kw_only=True)
class GridConfig:
    """Where a grid lies and how it tells states apart."""

    resolution: float = 0.01
    """Edge of a cell [m]; the thesis's 1 cm."""
    origin: tuple[float, float] = (-2.56, -2.56)
    """Lower-left corner of cell (0, 0) in the map frame [m]."""
    rows: int = 512
    """Cells along y at the start."""
    columns: int = 512
    """Cells along x at the start."""
    grows: bool = True
    """Whether the grid grows in tiles to hold what is seen; else what lies outside is dropped."""
    most_cells: int = MOST_CELLS
    """It never grows beyond so many cells: what lies farther out is then dropped as well."""
    occupied_above: float = 3.0
    """A cell with more log odds than this is occupied (thesis 4.3.6)."""
    free_below: float = -3.0
    """A cell with less log odds than this is free (thesis 4.3.6)."""

    def __post_init__(self) -> None:
        """Refuse figures that make no grid."""
        if not (np.isfinite(self.resolution) and self.resolution > 0.0):
            raise TestbedError(f"resolution: {self.resolution} m; must be a finite number above 0")
        if not np.all(np.isfinite(self.origin)):
            raise TestbedError(f"origin: {self.origin} m; must be finite")
        whole = all(isinstance(count, int | np.integer) for count in (self.rows, self.columns))
        if not whole or self.rows < 1 or self.columns < 1:
            raise TestbedError(
                f"grid size: {self.rows} x {self.columns} cells; must be whole, at least 1"
            )
        if self.most_cells < 1:
            raise TestbedError(f"most_cells: {self.most_cells}; must be at least 1")


class OccupancyGrid:
    """Log odds of occupancy ``[row = y, col = x]``, float32, 0 where nothing is known."""

    def __init__(self, config: GridConfig | None = None) -> None:
        self.config = config or GridConfig()
        self.resolution = self.config.resolution
        self.origin = np.array(self.config.origin, dtype=np.float64)
        self._is_full = False
        self.redraws = 0
        """How often a mapper has drawn the whole map anew; after that, everything may differ."""
        self.log_odds: NDArray[np.float32] = np.zeros(
            (self.config.rows, self.config.columns), dtype=np.float32
        )

    @property
    def shape(self) -> tuple[int, int]:
        """Rows and columns."""
        rows, columns = self.log_odds.shape
        return rows, columns

    @property
    def extent(self) -> tuple[float, float, float, float]:
        """Edges of the grid in the map frame: left, right, bottom, top [m]."""
        rows, columns = self.shape
        left, bottom = self.origin
        return (
            float(left),
            float(left + columns * self.resolution),
            float(bottom),
            float(bottom + rows * self.resolution),
        )

    def world_to_cell(self, points: ArrayLike) -> NDArray[np.int64]:
        """The cells ``(..., 2)`` as (row, column) that hold points ``(..., 2)`` as (x, y) [m].

        Cells outside the grid come back as they are (negative, or beyond the shape).
        """
        points = np.asarray(points, dtype=np.float64)
        return np.floor((points - self.origin) / self.resolution).astype(np.int64)[..., ::-1]

    def cell_to_world(self, cells: ArrayLike) -> NDArray[np.float64]:
        """The centres ``(..., 2)`` as (x, y) [m] of cells ``(..., 2)`` as (row, column)."""
        cells = np.asarray(cells, dtype=np.float64)
        return self.origin + (cells[..., ::-1] + 0.5) * self.resolution

    def contains(self, cells: ArrayLike) -> NDArray[np.bool_]:
        """Whether cells ``(..., 2)`` as (row, column) lie in the grid."""
        cells = np.asarray(cells)
        return np.asarray(np.all((cells >= 0) & (cells < self.shape), axis=-1))

    def states(self) -> NDArray[np.int8]:
        """The state of every cell: UNKNOWN, FREE or OCCUPIED."""
        states = np.full(self.shape, UNKNOWN, dtype=np.int8)
        states[self.log_odds < self.config.free_below] = FREE
        states[self.log_odds > self.config.occupied_above] = OCCUPIED
        return states

    def cover(self, left: float, right: float, bottom: float, top: float) -> None:
        """Grow by whole tiles until the box [m] lies inside; a grid of fixed size stays as it is.

        Cells keep their places in the world exactly: the origin moves by whole cells. A box that
        would take more than ``most_cells`` is refused: the grid stays as it is, and what lies
        outside of it is not drawn. That is told once, as a warning.
        """
        west, east, south, north = self.extent
        inside = west <= left and right < east and south <= bottom and top < north
        if inside or not self.config.grows:
            return
        if not np.all(np.isfinite([left, right, bottom, top])):
            raise TestbedError(f"grid box: {left, right, bottom, top}; must be finite")
        rows, columns = self.shape
        before, below = self._tiles_beyond(-np.floor(self._in_cells([left, bottom])))
        after, above = self._tiles_beyond(
            np.floor(self._in_cells([right, top])) + 1.0 - np.array([columns, rows])
        )
        if (rows + below + above) * (columns + before + after) > self.config.most_cells:
            self._refuse(left, right, bottom, top)
            return
        widths = ((int(below), int(above)), (int(before), int(after)))
        self.log_odds = np.pad(self.log_odds, widths)
        self.origin = self.origin - np.array([before, below]) * self.resolution

    def copy(self) -> "OccupancyGrid":
        """A grid of its own with the same cells, for drawing while mapping goes on."""
        twin = OccupancyGrid.__new__(OccupancyGrid)
        twin.config, twin.resolution = self.config, self.resolution
        twin.redraws, twin._is_full = self.redraws, self._is_full
        twin.origin, twin.log_odds = self.origin.copy(), self.log_odds.copy()
        return twin

    def _in_cells(self, points: ArrayLike) -> NDArray[np.float64]:
        """Points ``(..., 2)`` as (x, y) [m] in cells from the grid's corner, however far away."""
        with np.errstate(over="ignore"):
            return np.asarray((np.asarray(points) - self.origin) / self.resolution)

    def _tiles_beyond(self, cells: NDArray[np.float64]) -> list[float]:
        """How many cells to add, in whole tiles, to gain at least ``cells`` ``(2,)`` of them.

        Numbers that no grid has cannot be whole numbers; they come back as they are.
        """
        tiles: list[float] = (np.ceil(np.maximum(cells, 0.0) / TILE_CELLS) * TILE_CELLS).tolist()
        return tiles

    def _refuse(self, left: float, right: float, bottom: float, top: float) -> None:
        """Warn, the first time, that the grid will not grow to hold a box [m]."""
        if not self._is_full:
            self._is_full = True
            logger.warning(
                "x %.6g to %.6g m, y %.6g to %.6g m would take more than %d cells of %g m: "
                "what lies outside the map is not drawn",
                left,
                right,
                bottom,
                top,
                self.config.most_cells,
                self.resolution,
            )
