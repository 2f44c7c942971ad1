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
    for row in range(window[0], window[1]):
        for column in range(window[2], window[3]):
            free = 0
            occupied = False
            fine_rows = min((row + 1) * factor, rows)
            fine_columns = min((column + 1) * factor, columns)
            for i in range(row * factor, fine_rows):
                for j in range(column * factor, fine_columns):
                    value = log_odds[i, j]
                    occupied |= value > occupied_above
                    free += value < free_below
            if occupied:
                states[row, column] = OCCUPIED
            elif free >= min_free:
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
    reach = int(np.ceil(limit / resolution)) + 1
    for row in range(window[0], window[1]):
        for column in range(window[2], window[3]):
            clearance[row, column] = limit
    for row in range(max(window[0] - reach, 0), min(window[1] + reach, rows)):
        for column in range(max(window[2] - reach, 0), min(window[3] + reach, columns)):
            if states[row, column] != OCCUPIED:
                continue
            _spread_from_cell(
                log_odds, occupied_above, factor, resolution, reach, row, column, window, clearance
            )


@njit(cache=True)
def _spread_from_cell(
    log_odds: NDArray[np.float32],
    occupied_above: np.float32,
    factor: int,
    resolution: np.float32,
    reach: int,
    row: int,
    column: int,
    window: Window,
    clearance: NDArray[np.float32],
) -> None:
    """Lower the clearance around one occupied planning cell by each of its bordering fine cells."""
    fine_rows, fine_columns = log_odds.shape
    fine = resolution / factor
    for i in range(row * factor, min((row + 1) * factor, fine_rows)):
        for j in range(column * factor, min((column + 1) * factor, fine_columns)):
            if log_odds[i, j] <= occupied_above or _is_inside(log_odds, occupied_above, i, j):
                continue
            x, y = (j + 0.5) * fine, (i + 0.5) * fine
            for r in range(max(row - reach, window[0]), min(row + reach + 1, window[1])):
                dy = (r + 0.5) * resolution - y
                for c in range(max(column - reach, window[2]), min(column + reach + 1, window[3])):
                    dx = (c + 0.5) * resolution - x
                    distance = np.sqrt(dx * dx + dy * dy)
                    if distance < clearance[r, c]:
                        clearance[r, c] = distance


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
