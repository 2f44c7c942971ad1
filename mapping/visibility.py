"""Tells which cells of a raster lie near an obstacle, and which can be seen."""

import numpy as np
from numba import njit
from numpy.typing import NDArray
from scipy import ndimage

Mask = NDArray[np.bool_]


def near_obstacle(blocked: Mask, radius_cells: float) -> Mask:
    """Cells whose centre is nearer than ``radius_cells`` to the edge of a blocked cell.

    Exact: the blocked square nearest to a point need not be the one with the nearest centre, so a
    distance transform of centres would not do.

    Args:
        blocked: Whether a cell is blocked ``(rows, columns)``.
        radius_cells: The distance in cells.
    """
    reach = int(np.ceil(radius_cells + 0.5))
    across = np.maximum(np.arange(reach + 1) - 0.5, 0.0)
    along = np.hypot(across[:, np.newaxis], across[np.newaxis, :]) < radius_cells
    half_widths = along.sum(axis=1) - 1
    return np.asarray(_dilate(np.ascontiguousarray(blocked), half_widths.astype(np.int64)))


def see_from(seers: Mask, blocked: Mask, range_cells: float) -> Mask:
    """Cells that a beam from the centre of some seer crosses before it meets a blocked cell.

    A beam that leaves the seers for good passes their rim, so beams start from rim cells only and
    end where they come back to a seer.

    Args:
        seers: Cells that look around ``(rows, columns)``; none of them is blocked.
        blocked: Cells that end a beam ``(rows, columns)``.
        range_cells: How far a beam goes, in cells; beams lie one cell apart there.
    """
    directions = int(np.ceil(2.0 * np.pi * max(range_cells, 1.0)))
    stops = np.pad(seers | blocked, 1, constant_values=True)
    seen = np.pad(seers, 1)
    rim = seers & ndimage.binary_dilation(~(seers | blocked), np.ones((3, 3), np.bool_))
    starts = np.flatnonzero(np.pad(rim, 1))
    _cast_fans(starts, stops.ravel(), stops.shape[1], float(range_cells), directions, seen.ravel())
    return seen[1:-1, 1:-1].copy()


@njit(cache=True)
def _dilate(blocked: Mask, half_widths: NDArray[np.int64]) -> Mask:
    """Blocked cells grown by a figure that is ``half_widths[j]`` wide to each side, j rows off."""
    rows, columns = blocked.shape
    reach = len(half_widths) - 1
    grown = np.zeros((rows, columns), dtype=np.bool_)
    for row in range(rows):
        column = 0
        while column < columns:
            if not blocked[row, column]:
                column += 1
                continue
            first = column
            while column < columns and blocked[row, column]:
                column += 1
            for other in range(max(row - reach, 0), min(row + reach + 1, rows)):
                half = half_widths[abs(other - row)]
                if half >= 0:
                    grown[other, max(first - half, 0) : min(column + half, columns)] = True
    return grown


@njit(cache=True)
def _cast_fans(
    starts: NDArray[np.int64],
    stops: Mask,
    width: int,
    range_cells: float,
    directions: int,
    seen: Mask,
) -> None:
    """Mark in ``seen`` what a full fan of beams from every start crosses.

    The rasters are flat, ``width`` cells a row, and framed by stops, so no step looks for an edge.
    """
    for beam in range(directions):
        angle = 2.0 * np.pi * beam / directions
        cos, sin = np.cos(angle), np.sin(angle)
        for start in starts:
            _cast(start, stops, width, cos, sin, range_cells, seen)


@njit(cache=True)
def _cast(
    cell: int, stops: Mask, width: int, cos: float, sin: float, range_cells: float, seen: Mask
) -> None:
    """Mark the cells of one beam, from a cell's centre until something stops it.

    Steps from cell edge to cell edge (Amanatides and Woo, 1987).
    """
    step_column, step_row = (1 if cos > 0.0 else -1), (width if sin > 0.0 else -width)
    per_column = 1.0 / abs(cos) if cos != 0.0 else np.inf
    per_row = 1.0 / abs(sin) if sin != 0.0 else np.inf
    next_column, next_row = 0.5 * per_column, 0.5 * per_row
    while True:
        if next_column < next_row:
            if next_column > range_cells:
                return
            cell += step_column
            next_column += per_column
        else:
            if next_row > range_cells:
                return
            cell += step_row
            next_row += per_row
        if stops[cell]:
            return
        seen[cell] = True
