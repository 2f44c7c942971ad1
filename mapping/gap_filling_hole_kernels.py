"""Kernels of gap filling: lines across narrow holes of straight walls, over unknown cells.

As in ``gap_filling_kernels``, neither the order of cells nor which way is up matters.
"""

import numpy as np
from numba import njit
from numpy.typing import NDArray

from mapping.gap_filling_kernels import Lines, Mask, States, cells_aside
from mapping.grid import OCCUPIED, UNKNOWN


@njit(cache=True)
def narrow_holes(states: States, reach: int, support: int, half_width: float, needed: int) -> Lines:
    """Lines across unknown cells between two pieces of one straight wall that are near each other.

    A wall must go on behind both ends of a line, and no occupied cell may lie in the circle whose
    diameter the line is (Gabriel and Sokal 1969), so that only nearest ends are joined.

    Args:
        states: UNKNOWN, FREE or OCCUPIED.
        reach: Length of the longest line in cells.
        support: How far behind an end the wall is looked at, in cells.
        half_width: Its cells lie within this of the line, in cells. As its ends may lie beside the
            wall's middle, the line may be turned by a cell over its length.
        needed: So many of the ``support`` steps behind an end must have a cell of the wall.
    """
    rows, columns = states.shape
    rim = rim_of(states)
    found = [(0, 0, 0, 0)]
    for row in range(rows):
        for column in range(columns):
            if not rim[row, column]:
                continue
            for other in range(row, min(row + reach + 1, rows)):
                for aside in range(max(column - reach, 0), min(column + reach + 1, columns)):
                    rise, run = other - row, aside - column
                    if not rim[other, aside] or (rise == 0 and run <= 0):
                        continue
                    if max(rise, abs(run)) < 2 or rise * rise + run * run > reach * reach:
                        continue
                    if not all_unknown(states, row, column, other, aside):
                        continue
                    if not has_empty_circle(states, np.array((row, column, other, aside))):
                        continue
                    if _goes_on(states, row, column, rise, run, support, half_width, needed):
                        found.append((row, column, other, aside))
    return np.array(found, dtype=np.int64)[1:]


@njit(cache=True)
def _goes_on(
    states: States,
    row: int,
    column: int,
    rise: int,
    run: int,
    support: int,
    half_width: float,
    needed: int,
) -> bool:
    """Whether a wall goes on behind both ends of a line from a cell, as it is or turned a bit."""
    double = 2 * max(abs(rise), abs(run))
    for lean in (0, -1, 1, -2, 2):
        down, across = double * rise + lean * run, double * run - lean * rise
        back = steps_of_wall(states, row, column, -down, -across, support, half_width)
        if back < needed:
            continue
        on = steps_of_wall(states, row + rise, column + run, down, across, support, half_width)
        if on >= needed:
            return True
    return False


@njit(cache=True)
def rim_of(states: States) -> Mask:
    """Occupied cells beside an unknown one, of which alone a line of unknown cells can start."""
    rows, columns = states.shape
    rim = np.zeros((rows, columns), dtype=np.bool_)
    for row in range(rows):
        for column in range(columns):
            if states[row, column] == OCCUPIED:
                around = states[max(row - 1, 0) : row + 2, max(column - 1, 0) : column + 2]
                rim[row, column] = around.min() == UNKNOWN
    return rim


@njit(cache=True)
def all_unknown(states: States, row: int, column: int, other: int, aside: int) -> bool:
    """Whether every cell between two is unknown, on the line of ``cells_between``."""
    rise, run = other - row, aside - column
    steps = max(abs(rise), abs(run))
    along_rows = abs(rise) >= abs(run)
    sign = 1 if (rise if along_rows else run) > 0 else -1
    for step in range(1, steps):
        first, last = cells_aside(run if along_rows else rise, step, steps)
        for shift in range(first, last + 1):
            down = sign * step if along_rows else shift
            if states[row + down, column + (shift if along_rows else sign * step)] != UNKNOWN:
                return False
    return True


@njit(cache=True)
def steps_of_wall(
    states: States,
    row: int,
    column: int,
    rise: float,
    run: float,
    support: int,
    half_width: float,
) -> int:
    """In how many of ``support`` steps from a cell in a direction there is an occupied cell."""
    rows, columns = states.shape
    square = rise * rise + run * run
    length = np.sqrt(square)
    met = np.zeros(support, dtype=np.bool_)
    reach = support + int(half_width) + 1
    for other in range(max(row - reach, 0), min(row + reach + 1, rows)):
        for aside in range(max(column - reach, 0), min(column + reach + 1, columns)):
            if states[other, aside] != OCCUPIED:
                continue
            along = (other - row) * rise + (aside - column) * run
            across = (other - row) * run - (aside - column) * rise
            if along >= 0 and across * across <= half_width * half_width * square:
                step = int(along / length)
                if step < support:
                    met[step] = True
    return int(met.sum())


@njit(cache=True)
def has_empty_circle(states: States, line: NDArray[np.int64]) -> bool:
    """Whether no other occupied cell lies in or on the circle whose diameter a line is."""
    rows, columns = states.shape
    reach = max(abs(line[2] - line[0]), abs(line[3] - line[1]))
    row, column = (line[0] + line[2]) // 2, (line[1] + line[3]) // 2
    for other in range(max(row - reach, 0), min(row + reach + 2, rows)):
        for aside in range(max(column - reach, 0), min(column + reach + 2, columns)):
            if states[other, aside] != OCCUPIED:
                continue
            is_start = other == line[0] and aside == line[1]
            is_end = other == line[2] and aside == line[3]
            here = (line[0] - other) * (line[2] - other) + (line[1] - aside) * (line[3] - aside)
            if here <= 0 and not is_start and not is_end:
                return False
    return True
