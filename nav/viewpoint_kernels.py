"""The viewpoints' inner loops: finding places that see a frontier, casting for their gain."""

import numpy as np
from numba import njit
from numpy.typing import NDArray

from mapping.grid import FREE, OCCUPIED, UNKNOWN
from nav.frontier_kernels import touches_occupied


@njit(cache=True)
def sees(states: NDArray[np.int8], i0: int, j0: int, i1: int, j1: int) -> bool:
    """Whether the straight line between two cells' centres crosses free cells only.

    Sampled every half cell; the two ends themselves are not asked.
    """
    steps = 2 * max(abs(i1 - i0), abs(j1 - j0))
    for k in range(1, steps):
        t = k / steps
        i = int(np.floor(i0 + t * (i1 - i0) + 0.5))
        j = int(np.floor(j0 + t * (j1 - j0) + 0.5))
        if (i, j) != (i0, j0) and (i, j) != (i1, j1) and states[i, j] != FREE:
            return False
    return True


@njit(cache=True)
def cheapest_view(
    cost_to_come: NDArray[np.float32],
    states: NDArray[np.int8],
    clearance: NDArray[np.float32],
    visited: NDArray[np.bool_],
    row: int,
    column: int,
    reach: float,
    min_clearance: np.float32,
) -> tuple[int, int]:
    """The cheapest cell to come to that sees the given one within ``reach`` cells.

    It keeps ``min_clearance`` and was not visited.
    Returns (-1, -1) when there is none.
    """
    rows, columns = states.shape
    span = int(np.ceil(reach))
    best, best_row, best_column = np.float32(np.inf), -1, -1
    for i in range(max(row - span, 0), min(row + span + 1, rows)):
        for j in range(max(column - span, 0), min(column + span + 1, columns)):
            if cost_to_come[i, j] >= best or clearance[i, j] < min_clearance or visited[i, j]:
                continue
            if np.hypot(i - row, j - column) > reach or not sees(states, i, j, row, column):
                continue
            best, best_row, best_column = cost_to_come[i, j], i, j
    return best_row, best_column


@njit(cache=True)
def view_square_on(
    cost_to_come: NDArray[np.float32],
    states: NDArray[np.int8],
    clearance: NDArray[np.float32],
    visited: NDArray[np.bool_],
    cells: NDArray[np.int64],
    row: int,
    column: int,
    reach: float,
    min_clearance: np.float32,
) -> tuple[int, int]:
    """The farthest cell within ``reach`` cells that looks at a frontier's middle square on.

    That is away from the unknown beside its ``cells`` ``(n, 2)``, over free cells only. It can be
    come to, keeps ``min_clearance`` and was not visited. Returns (-1, -1) when there is none.
    """
    rows, columns = states.shape
    away_y, away_x = 0, 0
    for k in range(len(cells)):
        i, j = cells[k]
        for di, dj in ((1, 0), (-1, 0), (0, 1), (0, -1)):
            if 0 <= i + di < rows and 0 <= j + dj < columns and states[i + di, j + dj] == UNKNOWN:
                away_y, away_x = away_y - di, away_x - dj
    length = np.hypot(away_y, away_x)
    best_row, best_column = -1, -1
    if length == 0.0:
        return best_row, best_column
    for step in range(1, int(reach) + 1):
        i = int(np.floor(row + 0.5 + step * away_y / length))
        j = int(np.floor(column + 0.5 + step * away_x / length))
        if not (0 <= i < rows and 0 <= j < columns) or states[i, j] != FREE:
            break
        is_clear = clearance[i, j] >= min_clearance and not visited[i, j]
        if is_clear and np.isfinite(cost_to_come[i, j]):
            best_row, best_column = i, j
    return best_row, best_column


@njit(cache=True)
def expected_gain(
    states: NDArray[np.int8],
    row: int,
    column: int,
    reach: float,
    depth: float,
    beams: int,
    through_holes: bool,
) -> int:
    """How many unknown cells a lidar in a cell would see, each counted once.

    A beam ends at an occupied cell, at ``reach`` cells, ``depth`` cells into the unknown, or where
    it would enter the unknown beside an occupied cell, unless ``through_holes``: most likely that
    is a hole in a wall seen from afar.
    """
    rows, columns = states.shape
    span = int(np.ceil(reach)) + 1
    seen = np.zeros((2 * span + 1, 2 * span + 1), dtype=np.bool_)
    count = 0
    for beam in range(beams):
        angle = 2.0 * np.pi * beam / beams
        dy, dx = np.sin(angle), np.cos(angle)
        into = 0.0
        for step in range(1, int(reach) + 1):
            i, j = int(np.floor(row + 0.5 + step * dy)), int(np.floor(column + 0.5 + step * dx))
            inside = 0 <= i < rows and 0 <= j < columns
            state = states[i, j] if inside else UNKNOWN
            if state == OCCUPIED or into >= depth:
                break
            if state == UNKNOWN:
                is_first = into == 0.0 and inside and not through_holes
                if is_first and touches_occupied(states, i, j):
                    break
                into += 1.0
                if not seen[i - row + span, j - column + span]:
                    seen[i - row + span, j - column + span] = True
                    count += 1
    return count
