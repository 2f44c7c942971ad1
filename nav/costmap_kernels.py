"""The costmap's inner loops: pooling fine cells, measuring clearance, pricing cells.

A window is (first row, end row, first column, end column) in planning cells; the kernels write
nothing outside it.
"""

import numpy as np
from numba import njit
from numpy.typing import NDArray

from mapping.grid import FREE, OCCUPIED, UNKNOWN

Window = tuple[int, int, int, int]


@njit(cache=True)
def pool_states(
    log_odds: NDArray[np.float32],
    free_below: np.float32,
    occupied_above: np.float32,
    factor: int,
    min_free: int,
    window: Window,
    states: NDArray[np.int8],
) -> None:
    """State of each planning cell from its ``factor`` x ``factor`` fine cells.

    Occupied when any fine cell is; else free when at least ``min_free`` of them are free.
    """
    rows, columns = log_odds.shape
    first = window[2] * factor
    width = min(window[3] * factor, columns) - first
    free = np.empty((window[3] - window[2]) * factor, dtype=np.int32)
    occupied = np.empty_like(free)
    for row in range(window[0], window[1]):
        free[:], occupied[:] = 0, 0
        for i in range(row * factor, min((row + 1) * factor, rows)):
            line = log_odds[i, first : first + width]
            for j in range(width):  # counted by columns first: this loop runs on whole registers
                free[j] += line[j] < free_below
                occupied[j] += line[j] > occupied_above
        for column in range(window[2], window[3]):
            begin = (column - window[2]) * factor
            if occupied[begin : begin + factor].sum() > 0:
                states[row, column] = OCCUPIED
            elif free[begin : begin + factor].sum() >= min_free:
                states[row, column] = FREE
            else:
                states[row, column] = UNKNOWN


@njit(cache=True)
def measure_clearance(
    log_odds: NDArray[np.float32],
    occupied_above: np.float32,
    factor: int,
    resolution: np.float32,
    limit: np.float32,
    window: Window,
    states: NDArray[np.int8],
    clearance: NDArray[np.float32],
) -> None:
    """Distance from each planning cell's centre to the nearest occupied fine cell's centre [m].

    Distances beyond ``limit`` are not looked for and come out as ``limit``. Only the border cells
    of what is occupied are looked at, so the clearance of an occupied planning cell means nothing.
    """
    rows, columns = states.shape
    first_row, end_row, first_column, end_column = window
    reach = int(np.ceil(limit / resolution)) + 1
    limit_cells = limit / resolution
    squared = np.full(
        (end_row - first_row, end_column - first_column),
        np.float32(limit_cells * limit_cells),
        dtype=np.float32,
    )
    across = np.empty(2 * reach + 1, dtype=np.float32)
    for row in range(max(first_row - reach, 0), min(end_row + reach, rows)):
        for column in range(max(first_column - reach, 0), min(end_column + reach, columns)):
            if states[row, column] == OCCUPIED:
                _spread_from_cell(
                    log_odds, occupied_above, factor, reach, row, column, window, across, squared
                )
    for row in range(first_row, end_row):
        for column in range(first_column, end_column):
            cells = np.sqrt(squared[row - first_row, column - first_column])
            clearance[row, column] = resolution * cells


@njit(cache=True)
def _spread_from_cell(
    log_odds: NDArray[np.float32],
    occupied_above: np.float32,
    factor: int,
    reach: int,
    row: int,
    column: int,
    window: Window,
    across: NDArray[np.float32],
    squared: NDArray[np.float32],
) -> None:
    """Lower the squared clearance [cells2] around a planning cell by its bordering fine cells.

    Those of one fine row first make up the squared distances along the row, in ``across``, and then
    go into every row of planning cells together.
    """
    fine_rows, fine_columns = log_odds.shape
    first_row, end_row, first_column, end_column = window
    bottom, top = max(row - reach, first_row), min(row + reach + 1, end_row)
    left, right = max(column - reach, first_column), min(column + reach + 1, end_column)
    if bottom >= top or left >= right:
        return
    across = across[: right - left]
    for i in range(row * factor, min((row + 1) * factor, fine_rows)):
        across[:] = np.inf
        is_border = False
        for j in range(column * factor, min((column + 1) * factor, fine_columns)):
            if log_odds[i, j] <= occupied_above or _is_inside(log_odds, occupied_above, i, j):
                continue
            is_border = True
            x = np.float32((j + 0.5) / factor - 0.5)
            for c in range(len(across)):
                dx = np.float32(left + c) - x
                across[c] = min(across[c], dx * dx)
        if not is_border:
            continue
        y = np.float32((i + 0.5) / factor - 0.5)
        for r in range(bottom, top):
            dy = np.float32(r) - y
            line = squared[r - first_row, left - first_column : right - first_column]
            for c in range(len(line)):
                line[c] = min(line[c], across[c] + dy * dy)


@njit(cache=True)
def _is_inside(log_odds: NDArray[np.float32], occupied_above: np.float32, i: int, j: int) -> bool:
    """Whether all four neighbours of a fine cell are occupied: it can be nobody's nearest."""
    rows, columns = log_odds.shape
    if i == 0 or j == 0 or i == rows - 1 or j == columns - 1:
        return False
    return bool(
        log_odds[i - 1, j] > occupied_above
        and log_odds[i + 1, j] > occupied_above
        and log_odds[i, j - 1] > occupied_above
        and log_odds[i, j + 1] > occupied_above
    )


@njit(cache=True)
def price(
    states: NDArray[np.int8],
    clearance: NDArray[np.float32],
    lethal: np.float32,
    inflation: np.float32,
    closeness_cost: np.float32,
    window: Window,
    cost: NDArray[np.float32],
) -> None:
    """Cost per metre of each cell: 1 in the open, dearer near things, inf where none may go."""
    for row in range(window[0], window[1]):
        for column in range(window[2], window[3]):
            near = clearance[row, column]
            if states[row, column] != FREE or near < lethal:
                cost[row, column] = np.inf
            else:
                closeness = max(np.float32(0.0), (inflation - near) / (inflation - lethal))
                cost[row, column] = np.float32(1.0) + closeness_cost * closeness * closeness
