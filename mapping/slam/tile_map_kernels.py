"""Kernels of the tile maps: which tiles a scan crosses, making them a particle's own, drawing.

A tile has TILE_CELLS x TILE_CELLS cells ``[row = y, col = x]``. Of each cell the pool keeps in how
many beams it was seen (``visits``), how many of them ended in it (``hits``), and where in it they
ended on average (``means``, x and y in cells from its lower-left corner). One bit per cell, in a
word per row (``full``), tells whether hits make up more than a given share: matching looks at these
bits first, and a whole map of them fits the processor's nearest cache.

Positions are in cells from the corner of the particle's table of tiles.
"""

import numpy as np
from numba import njit
from numpy.typing import NDArray

TILE_SHIFT = 5
"""Cell index >> TILE_SHIFT is the tile's index."""

TILE_CELLS = 1 << TILE_SHIFT
"""Cells along the edge of a tile: the bits of a ``full`` word."""

IN_TILE = TILE_CELLS - 1
"""Cell index & IN_TILE is the place in the tile."""

MOST_VISITS = 65535
"""What uint16 holds; a cell that reaches it forgets half of what it saw and keeps its share."""

Table = NDArray[np.int32]
Counts = NDArray[np.uint16]
Means = NDArray[np.float32]
Words = NDArray[np.uint32]
Beams = NDArray[np.int32]


@njit(cache=True)
def beam_cells(
    pose: NDArray[np.float64], origins: NDArray[np.float64], ends: NDArray[np.float64]
) -> Beams:
    """The first and last cell of every beam ``(n, 4)``: column, row, column, row.

    Args:
        pose: Pose of base_footprint, x and y in cells ``(3,)``.
        origins: Where the beams start in base_footprint, in cells ``(n, 2)``.
        ends: Where they end, likewise.
    """
    cells = np.empty((len(ends), 4), dtype=np.int32)
    cos, sin = np.cos(pose[2]), np.sin(pose[2])
    for i in range(len(ends)):
        cells[i, 0] = np.floor(pose[0] + cos * origins[i, 0] - sin * origins[i, 1])
        cells[i, 1] = np.floor(pose[1] + sin * origins[i, 0] + cos * origins[i, 1])
        cells[i, 2] = np.floor(pose[0] + cos * ends[i, 0] - sin * ends[i, 1])
        cells[i, 3] = np.floor(pose[1] + sin * ends[i, 0] + cos * ends[i, 1])
    return cells


@njit(cache=True)
def mark_tiles(cells: Beams, crossed: NDArray[np.bool_]) -> None:
    """Mark in ``crossed`` ``(tile rows, tile columns)`` the tiles of all cells of the beams.

    Walks the same lines as ``write_beams``.
    """
    for i in range(len(cells)):
        column, row = int(cells[i, 0]), int(cells[i, 1])
        last_column, last_row = int(cells[i, 2]), int(cells[i, 3])
        wide, high = abs(last_column - column), abs(last_row - row)
        step_x = 1 if last_column >= column else -1
        step_y = 1 if last_row >= row else -1
        error = wide - high
        crossed[row >> TILE_SHIFT, column >> TILE_SHIFT] = True
        for _ in range(max(wide, high)):
            doubled = 2 * error
            if doubled > -high:
                error -= high
                column += step_x
            if doubled < wide:
                error += wide
                row += step_y
            crossed[row >> TILE_SHIFT, column >> TILE_SHIFT] = True


@njit(cache=True)
def own_tiles(
    table: Table,
    crossed: NDArray[np.bool_],
    references: NDArray[np.int32],
    free_tiles: NDArray[np.int32],
    free_count: int,
    hits: Counts,
    visits: Counts,
    means: Means,
    full: Words,
) -> int:
    """Make the crossed tiles a particle's own: new ones where it has none, copies of shared ones.

    Args:
        table: The particle's tiles ``(tile rows, tile columns)``, changed in place; 0 = none yet.
        crossed: Which of them will be written.
        references: In how many tables each tile of the pool stands, changed in place.
        free_tiles: A stack of unused tiles, ``free_count`` of them; enough for all crossed ones.
        free_count: How many there are.
        hits: Of the pool ``(tiles, TILE_CELLS, TILE_CELLS)``, as the next ones.
        visits: Likewise.
        means: ``(tiles, TILE_CELLS, TILE_CELLS, 2)``.
        full: ``(tiles, TILE_CELLS)``.

    Returns:
        How many unused tiles are left.
    """
    for row in range(table.shape[0]):
        for column in range(table.shape[1]):
            if not crossed[row, column]:
                continue
            old = table[row, column]
            if old != 0 and references[old] == 1:
                continue
            free_count -= 1
            new = free_tiles[free_count]
            _copy_tile(old, new, hits, visits, means, full)  # tile 0 is empty
            if old != 0:
                references[old] -= 1
            references[new] = 1
            table[row, column] = new
    return free_count


@njit(cache=True)
def _copy_tile(old: int, new: int, hits: Counts, visits: Counts, means: Means, full: Words) -> None:
    """Copy a tile of the pool, cell by cell: numba takes seconds to compile copies of slices."""
    for row in range(TILE_CELLS):
        full[new, row] = full[old, row]
        for column in range(TILE_CELLS):
            hits[new, row, column] = hits[old, row, column]
            visits[new, row, column] = visits[old, row, column]
            means[new, row, column, 0] = means[old, row, column, 0]
            means[new, row, column, 1] = means[old, row, column, 1]


@njit(cache=True)
def write_beams(
    table: Table,
    cells: Beams,
    in_last: NDArray[np.float64],
    is_hit: NDArray[np.bool_],
    threshold: float,
    hits: Counts,
    visits: Counts,
    means: Means,
    full: Words,
) -> None:
    """Count the beams' cells in the pool; the particle must own every tile they cross.

    A beam's cells are those of Bresenham's line. Every cell before the last is seen free once, the
    last one is hit, or left alone when the beam met nothing.

    Args:
        table: The particle's tiles.
        cells: First and last cells, from ``beam_cells``.
        in_last: Where in the last cell each beam ends, in cells from its corner ``(n, 2)``.
        is_hit: Whether it met something there ``(n,)``.
        threshold: A cell is full when hits make up more than this share of its visits.
        hits: Of the pool, changed in place, as the next ones.
        visits: Likewise.
        means: Likewise.
        full: Likewise.
    """
    for i in range(len(cells)):
        column, row = int(cells[i, 0]), int(cells[i, 1])
        last_column, last_row = int(cells[i, 2]), int(cells[i, 3])
        wide, high = abs(last_column - column), abs(last_row - row)
        step_x = 1 if last_column >= column else -1
        step_y = 1 if last_row >= row else -1
        error = wide - high
        for step in range(max(wide, high) + 1):
            ends = step == max(wide, high)
            if ends and not is_hit[i]:
                break
            tile = table[row >> TILE_SHIFT, column >> TILE_SHIFT]
            y, x = row & IN_TILE, column & IN_TILE
            was_hit = hits[tile, y, x] > 0
            if visits[tile, y, x] == MOST_VISITS:
                visits[tile, y, x] >>= 1
                hits[tile, y, x] >>= 1
            visits[tile, y, x] += 1
            if ends:
                hits[tile, y, x] += 1
                share = np.float32(1.0 / hits[tile, y, x])
                means[tile, y, x, 0] += share * (np.float32(in_last[i, 0]) - means[tile, y, x, 0])
                means[tile, y, x, 1] += share * (np.float32(in_last[i, 1]) - means[tile, y, x, 1])
            if ends or was_hit:
                bit = np.uint32(1) << np.uint32(x)
                if hits[tile, y, x] > threshold * visits[tile, y, x]:
                    full[tile, y] |= bit
                else:
                    full[tile, y] &= ~bit
            doubled = 2 * error
            if doubled > -high:
                error -= high
                column += step_x
            if doubled < wide:
                error += wide
                row += step_y


@njit(cache=True)
def draw_tiles(
    log_odds: NDArray[np.float32],
    corner: NDArray[np.int64],
    table: Table,
    wanted: NDArray[np.bool_],
    hits: Counts,
    visits: Counts,
    occupied_share: float,
    occupied: np.float32,
    free: np.float32,
) -> None:
    """Write the wanted tiles' cells into a grid of log odds; what lies outside it is left out.

    Args:
        log_odds: The grid ``(rows, columns)``, changed in place.
        corner: The grid's row and column at which the table's first cell lies ``(2,)``.
        table: The particle's tiles.
        wanted: Which of them are drawn ``(tile rows, tile columns)``.
        hits: Of the pool.
        visits: Of the pool.
        occupied_share: A cell is occupied when hits make up more than this share of its visits.
        occupied: The log odds written for an occupied cell.
        free: The log odds written for a free cell; a cell never visited gets 0.
    """
    for tile_row in range(table.shape[0]):
        for tile_column in range(table.shape[1]):
            tile = table[tile_row, tile_column]
            if not wanted[tile_row, tile_column] or tile == 0:
                continue
            first_row = corner[0] + tile_row * TILE_CELLS
            first_column = corner[1] + tile_column * TILE_CELLS
            for y in range(max(0, -first_row), min(TILE_CELLS, log_odds.shape[0] - first_row)):
                for x in range(
                    max(0, -first_column), min(TILE_CELLS, log_odds.shape[1] - first_column)
                ):
                    seen, met = visits[tile, y, x], hits[tile, y, x]
                    value = np.float32(0.0)
                    if seen > 0:
                        value = occupied if met > occupied_share * seen else free
                    log_odds[first_row + y, first_column + x] = value
