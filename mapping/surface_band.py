"""Turns a map into the band of cells along its walls where surfaces are looked for."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

from mapping.grid import OCCUPIED, UNKNOWN, OccupancyGrid

TILE = 32
"""Edge in cells of the tiles: a lidar that sees 3.5 m at 1 cm passes over few others."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class SurfaceBand:
    """Cells near walls."""

    cells: NDArray[np.int32]
    """The cells ``(m, 2)`` as (row, column), tile by tile."""
    starts: NDArray[np.int64]
    """Where each tile's cells begin ``(tiles + 1,)``, row by row of tiles."""
    tile_shape: tuple[int, int]
    """Rows and columns of tiles."""
    sums: NDArray[np.float32]
    """How many scans told of each cell, and the sums of their weights and of weights times
    distances before a surface [cells] ``(m, 3)``."""

    def __len__(self) -> int:
        return len(self.cells)


def band_along(grid: OccupancyGrid, width: int) -> SurfaceBand:
    """The cells within ``width`` cells of an occupied one, and those that are undecided.

    Undecided is what beams have crossed or hit, but not as often the one as the other that it were
    free or occupied.
    """
    known = grid.log_odds != 0.0
    rows, columns = _span(known.any(axis=1), width), _span(known.any(axis=0), width)
    states = grid.states()[rows, columns]
    near = ndimage.maximum_filter(states == OCCUPIED, size=2 * width + 1, mode="constant")
    undecided = (states == UNKNOWN) & known[rows, columns]
    cells = np.argwhere(near | undecided).astype(np.int32)
    cells += np.array([rows.start, columns.start], dtype=np.int32)
    tile_shape = (-(-grid.shape[0] // TILE), -(-grid.shape[1] // TILE))
    tiles = cells[:, 0] // TILE * tile_shape[1] + cells[:, 1] // TILE
    order = np.argsort(tiles, kind="stable")
    return SurfaceBand(
        cells=np.ascontiguousarray(cells[order]),
        starts=np.searchsorted(tiles[order], np.arange(tile_shape[0] * tile_shape[1] + 1)),
        tile_shape=tile_shape,
        sums=np.zeros((len(cells), 3), dtype=np.float32),
    )


def _span(known: NDArray[np.bool_], margin: int) -> slice:
    """From the first known row, or column, to the last, and a margin."""
    places = np.flatnonzero(known)
    if places.size == 0:
        return slice(0, 0)
    return slice(max(int(places[0]) - margin, 0), int(places[-1]) + 1 + margin)
