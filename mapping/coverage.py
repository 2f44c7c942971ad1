"""Measures how much of the visible free space a growing map knows to be free, often and cheaply."""

import numpy as np
from numba import njit
from numpy.typing import NDArray

from mapping.grid import OccupancyGrid
from mapping.truth import TruthMap

TILE = 64
"""Edge in cells of the tiles that are counted as wholes."""

ROUNDING = 1e-6
"""Part of a cell by which a centre may miss its cell through rounding."""


class CoverageMeter:
    """Counts the truth's visible free cells that a map calls free, tile by tile."""

    def __init__(self, truth: TruthMap) -> None:
        self._truth = truth
        rows, columns = truth.shape
        padded = np.pad(truth.visible_free, ((0, -rows % TILE), (0, -columns % TILE)))
        tiles = padded.reshape(padded.shape[0] // TILE, TILE, padded.shape[1] // TILE, TILE)
        self._visible_free = tiles.sum(axis=(1, 3))
        self._total = int(self._visible_free.sum())
        self._known_free = np.zeros((-(-rows // TILE), -(-columns // TILE)), dtype=np.int64)
        self._redraws = 0

    def measure(
        self, grid: OccupancyGrid, window: tuple[float, float, float, float] | None = None
    ) -> float:
        """The share 0..1 of the truth's visible free cells that the map calls free.

        The map is read at the centre of each truth cell. A truth without visible free cells counts
        as not covered, 0.

        Args:
            grid: The map so far.
            window: Left, right, bottom and top [m] of what may have changed since the last call,
                such as the robot's position +- the sensor's range; None counts everything anew,
                and so does a map that was drawn anew since.
        """
        if self._total == 0:
            return 0.0
        rows = nearest_cells(self._truth, grid, axis=1)
        columns = nearest_cells(self._truth, grid, axis=0)
        tiles = self._tiles(window if grid.redraws == self._redraws else None)
        self._redraws = grid.redraws
        free_below = np.float32(grid.config.free_below)
        _count(
            self._truth.visible_free,
            grid.log_odds,
            rows,
            columns,
            tiles,
            free_below,
            self._visible_free,
            self._known_free,
        )
        return float(self._known_free.sum() / self._total)

    def _tiles(self, window: tuple[float, float, float, float] | None) -> tuple[int, int, int, int]:
        """First and one past the last tile row, then column, that a window touches."""
        tile_rows, tile_columns = self._known_free.shape
        if window is None:
            return 0, tile_rows, 0, tile_columns
        left, right, bottom, top = window
        edge = TILE * self._truth.resolution
        x, y = self._truth.origin
        low = np.floor([(bottom - y) / edge, (left - x) / edge]).astype(int)
        high = np.floor([(top - y) / edge, (right - x) / edge]).astype(int) + 1
        return (
            max(int(low[0]), 0),
            min(int(high[0]), tile_rows),
            max(int(low[1]), 0),
            min(int(high[1]), tile_columns),
        )


def nearest_cells(truth: TruthMap, grid: OccupancyGrid, *, axis: int) -> NDArray[np.int64]:
    """The map's column (axis 0) or row (axis 1) at the centre of each truth cell; -1 outside."""
    count, cells = truth.shape[1 - axis], grid.shape[1 - axis]
    centres = truth.origin[axis] + (np.arange(count) + 0.5) * truth.resolution
    places = np.floor((centres - grid.origin[axis]) / grid.resolution + ROUNDING).astype(np.int64)
    return np.where((places >= 0) & (places < cells), places, -1)


@njit(cache=True)
def _count(
    visible_free: NDArray[np.bool_],
    log_odds: NDArray[np.float32],
    map_rows: NDArray[np.int64],
    map_columns: NDArray[np.int64],
    tiles: tuple[int, int, int, int],
    free_below: np.float32,
    most: NDArray[np.int64],
    known_free: NDArray[np.int64],
) -> None:
    """Count anew, for some tiles, the visible free cells that the map calls free, ``most`` each."""
    rows, columns = visible_free.shape
    first_row, last_row, first_column, last_column = tiles
    known_free[first_row:last_row, first_column:last_column] = 0
    for row in range(first_row * TILE, min(last_row * TILE, rows)):
        map_row = map_rows[row]
        if map_row < 0:
            continue
        for tile in range(first_column, last_column):
            if most[row // TILE, tile] == 0:
                continue
            first, last = tile * TILE, min((tile + 1) * TILE, columns)
            if map_columns[first] >= 0 and map_columns[last - 1] - map_columns[first] == (
                last - 1 - first
            ):  # equal cells side by side, the usual case: this loop runs on whole registers
                begin = map_columns[first]
                line = log_odds[map_row, begin : begin + last - first]
                wanted = visible_free[row, first:last]
                count = 0
                for k in range(last - first):
                    count += wanted[k] & (line[k] < free_below)
                known_free[row // TILE, tile] += count
                continue
            for column in range(first, last):
                map_column = map_columns[column]
                is_wanted = visible_free[row, column] and map_column >= 0
                if is_wanted and log_odds[map_row, map_column] < free_below:
                    known_free[row // TILE, tile] += 1
