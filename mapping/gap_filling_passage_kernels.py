"""Kernel that tells whether a line across a map would close a passage of the robot's."""

import numpy as np
from numba import njit
from numpy.typing import NDArray

from mapping.gap_filling_kernels import Lines, Mask, cells_between


@njit(cache=True)
def closing_lines(
    lines: Lines, fits: Mask, places: Mask, radius: float, depth: float
) -> NDArray[np.bool_]:
    """Which of the lines ``(n, 4)`` part places that the robot's centre can go between.

    Only what lies between a line's ends, up to ``depth`` before and behind it, is looked at: a way
    around the ends does not make up for one that is lost.

    Args:
        lines: The lines.
        fits: Where the robot's centre fits, among what stands there without them.
        places: Where it is known to fit: these must not be parted.
        radius: Radius of the robot in cells.
        depth: How far to both sides a way across a line is looked at, in cells.
    """
    closes = np.zeros(len(lines), dtype=np.bool_)
    for index in range(len(lines)):
        cells = cells_between(lines[index])
        crossed = False
        for cell in cells:
            crossed |= fits[cell[0], cell[1]]
        if crossed:
            closes[index] = _parts(lines[index], cells, fits, places, radius, depth)
    return closes


@njit(cache=True)
def _parts(
    line: NDArray[np.int64],
    cells: NDArray[np.int64],
    fits: Mask,
    places: Mask,
    radius: float,
    depth: float,
) -> bool:
    """Whether two places that were connected before and behind a line no longer are."""
    reach = int(depth) + 1
    top, left = min(line[0], line[2]) - reach, min(line[1], line[3]) - reach
    rows = abs(line[2] - line[0]) + 2 * reach + 1
    columns = abs(line[3] - line[1]) + 2 * reach + 1
    before = np.zeros((rows, columns), dtype=np.bool_)
    rise, run = line[2] - line[0], line[3] - line[1]
    square = rise * rise + run * run
    for row in range(max(top, 0), min(top + rows, fits.shape[0])):
        for column in range(max(left, 0), min(left + columns, fits.shape[1])):
            down, across = row - line[0], column - line[1]
            along = down * rise + across * run
            aside = down * run - across * rise
            if 0 <= along <= square and aside * aside <= depth * depth * square:
                before[row - top, column - left] = fits[row, column]
    after = before.copy()
    for cell in cells:
        _block(after, cell[0] - top, cell[1] - left, radius)
    old, new = _labelled(before), _labelled(after)
    became = np.zeros(old.max() + 1, dtype=np.int64)
    for row in range(rows):
        for column in range(columns):
            if after[row, column] and places[row + top, column + left]:
                piece = old[row, column]
                if became[piece] not in (0, new[row, column]):
                    return True
                became[piece] = new[row, column]
    return False


@njit(cache=True)
def _block(fits: Mask, row: int, column: int, radius: float) -> None:
    """Clear the cells whose centre is nearer than ``radius`` to the edge of a cell."""
    reach = int(radius + 1.0)
    for other in range(max(row - reach, 0), min(row + reach + 1, fits.shape[0])):
        for aside in range(max(column - reach, 0), min(column + reach + 1, fits.shape[1])):
            down, across = max(abs(other - row) - 0.5, 0.0), max(abs(aside - column) - 0.5, 0.0)
            if down * down + across * across < radius * radius or (down == 0.0 and across == 0.0):
                fits[other, aside] = False


@njit(cache=True)
def _labelled(mask: Mask) -> NDArray[np.int64]:
    """Pieces of a mask, connected by edges, numbered from 1."""
    rows, columns = mask.shape
    labels = np.zeros((rows, columns), dtype=np.int64)
    stack = np.empty((rows * columns, 2), dtype=np.int64)
    pieces = 0
    for row in range(rows):
        for column in range(columns):
            if not mask[row, column] or labels[row, column]:
                continue
            pieces += 1
            labels[row, column] = pieces
            stack[0, 0], stack[0, 1] = row, column
            height = 1
            while height:
                height -= 1
                down, across = stack[height, 0], stack[height, 1]
                for step in range(4):
                    other = down + (1 if step == 0 else -1 if step == 1 else 0)
                    aside = across + (1 if step == 2 else -1 if step == 3 else 0)
                    if not (0 <= other < rows and 0 <= aside < columns):
                        continue
                    if mask[other, aside] and not labels[other, aside]:
                        labels[other, aside] = pieces
                        stack[height, 0], stack[height, 1] = other, aside
                        height += 1
    return labels
