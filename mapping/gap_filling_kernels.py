"""Kernels of gap filling: lines of cells, and those that the thesis closes holes of walls with.

Cells are (row, column), lines are rows ``(row, column, row, column)`` of two cells. Nothing here
depends on the order in which cells are looked at, or on which way is up: a map turned by 90 degrees
gives the same lines, turned.
"""

import numpy as np
from numba import njit
from numpy.typing import NDArray

Lines = NDArray[np.int64]
Mask = NDArray[np.bool_]
States = NDArray[np.int8]


@njit(cache=True)
def cells_between(line: NDArray[np.int64]) -> NDArray[np.int64]:
    """The cells ``(n, 2)`` between the two cells of a line, without these, on Bresenham's line.

    Where the line runs along the edge of two cells, both belong to it, so that it does not matter
    from which end, or after which turn, it is drawn.
    """
    rise, run = line[2] - line[0], line[3] - line[1]
    steps = max(abs(rise), abs(run))
    along_rows = abs(rise) >= abs(run)
    sign = 1 if (rise if along_rows else run) > 0 else -1
    cells = np.empty((max(2 * (steps - 1), 0), 2), dtype=np.int64)
    count = 0
    for step in range(1, steps):
        first, last = cells_aside(run if along_rows else rise, step, steps)
        for aside in range(first, last + 1):
            cells[count, 0] = line[0] + (sign * step if along_rows else aside)
            cells[count, 1] = line[1] + (aside if along_rows else sign * step)
            count += 1
    return cells[:count]


@njit(cache=True)
def cells_aside(minor: int, step: int, steps: int) -> tuple[int, int]:
    """First and last cell aside, as a line of ``steps`` steps goes ``minor`` cells aside."""
    whole, rest = minor * step // steps, minor * step % steps
    return whole if 2 * rest <= steps else whole + 1, whole if 2 * rest < steps else whole + 1


@njit(cache=True)
def draw_lines(lines: Lines, drawn: Mask) -> None:
    """Mark the cells between the two of each line ``(n, 4)``; all must lie in ``drawn``."""
    for index in range(len(lines)):
        for cell in cells_between(lines[index]):
            drawn[cell[0], cell[1]] = True


@njit(cache=True)
def near_lines(occupied: Mask, reach: int) -> Lines:
    """The thesis's lines to occupied cells near by, but not in the same row or column (5.1).

    Every occupied cell is joined to each other one up to ``reach`` rows and columns away, if the
    cell diagonally before that one is not occupied.
    """
    rows, columns = occupied.shape
    found = [(0, 0, 0, 0)]
    for row in range(rows):
        for column in range(columns):
            if not occupied[row, column]:
                continue
            for other in range(max(row - reach, 0), min(row + reach + 1, rows)):
                for aside in range(max(column - reach, 0), min(column + reach + 1, columns)):
                    if other == row or aside == column or not occupied[other, aside]:
                        continue
                    before = other + (1 if other < row else -1)
                    if not occupied[before, aside + (1 if aside < column else -1)]:
                        found.append((row, column, other, aside))
    return np.array(found, dtype=np.int64)[1:]


@njit(cache=True)
def gaps_along_rows(occupied: Mask, reach: int) -> Lines:
    """Lines between neighbouring occupied cells of a row, 2 to ``reach`` columns apart."""
    rows, columns = occupied.shape
    found = [(0, 0, 0, 0)]
    for row in range(rows):
        last = -reach - 1
        for column in range(columns):
            if occupied[row, column]:
                if 1 < column - last <= reach:
                    found.append((row, last, row, column))
                last = column
    return np.array(found, dtype=np.int64)[1:]
