"""The frontier's inner loops: marking borders, finding places that see them, casting for gain."""

import numpy as np
from numba import njit
from numpy.typing import NDArray

from mapping.grid import FREE, OCCUPIED, UNKNOWN


@njit(cache=True)
def mark_frontier(states: NDArray[np.int8]) -> NDArray[np.int8]:
    """1 for every free cell with an unknown neighbour of four and no occupied one of eight, else 0.

    Where a wall was seen from afar its returns lie apart: the holes between them are no frontier.
    """
    rows, columns = states.shape
    marked = np.zeros((rows, columns), dtype=np.int8)
    for i in range(rows):
        for j in range(columns):
            if states[i, j] == FREE and (
                (i > 0 and states[i - 1, j] == UNKNOWN)
                or (i < rows - 1 and states[i + 1, j] == UNKNOWN)
                or (j > 0 and states[i, j - 1] == UNKNOWN)
                or (j < columns - 1 and states[i, j + 1] == UNKNOWN)
            ):
                marked[i, j] = not touches_occupied(states, i, j)
    return marked


@njit(cache=True)
def touches_occupied(states: NDArray[np.int8], row: int, column: int) -> bool:
    """Whether one of a cell's eight neighbours is occupied."""
    rows, columns = states.shape
    for i in range(max(row - 1, 0), min(row + 2, rows)):
        for j in range(max(column - 1, 0), min(column + 2, columns)):
            if states[i, j] == OCCUPIED:
                return True
    return False


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
    row: int,
    column: int,
    reach: float,
    min_clearance: np.float32,
) -> tuple[int, int]:
    """The reachable cell that is cheapest to come to and sees the given one within ``reach`` cells.

    Returns (-1, -1) when there is none.
    """
    rows, columns = states.shape
    span = int(np.ceil(reach))
    best, best_row, best_column = np.float32(np.inf), -1, -1
    for i in range(max(row - span, 0), min(row + span + 1, rows)):
        for j in range(max(column - span, 0), min(column + span + 1, columns)):
            if cost_to_come[i, j] >= best or clearance[i, j] < min_clearance:
                continue
            if np.hypot(i - row, j - column) > reach or not sees(states, i, j, row, column):
                continue
            best, best_row, best_column = cost_to_come[i, j], i, j
    return best_row, best_column


@njit(cache=True)
def expected_gain(
    states: NDArray[np.int8], row: int, column: int, reach: float, depth: float, beams: int
) -> int:
    """How many unknown cells a lidar in a cell would see, each counted once.

    A beam ends at an occupied cell, at ``reach`` cells, ``depth`` cells into the unknown, or where
    it would enter the unknown beside an occupied cell: that is a hole in a wall seen from afar.
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
                if into == 0.0 and inside and touches_occupied(states, i, j):
                    break
                into += 1.0
                if not seen[i - row + span, j - column + span]:
                    seen[i - row + span, j - column + span] = True
                    count += 1
    return count


@njit(cache=True)
def note_walls(
    states: NDArray[np.int8], row: int, column: int, reach: float, walls: NDArray[np.bool_]
) -> None:
    """Mark the occupied cells within ``reach`` cells of a cell as walls."""
    rows, columns = states.shape
    span = int(np.ceil(reach))
    for i in range(max(row - span, 0), min(row + span + 1, rows)):
        for j in range(max(column - span, 0), min(column + span + 1, columns)):
            if states[i, j] == OCCUPIED and np.hypot(i - row, j - column) <= reach:
                walls[i, j] = True


@njit(cache=True)
def unmark_near_former_walls(
    marked: NDArray[np.int8], walls: NDArray[np.bool_], states: NDArray[np.int8], reach: int
) -> None:
    """Unmark every cell with a wall that is occupied no more within ``reach`` cells."""
    rows, columns = marked.shape
    for i in range(rows):
        for j in range(columns):
            if marked[i, j] and _former_wall_near(walls, states, i, j, reach):
                marked[i, j] = 0


@njit(cache=True)
def _former_wall_near(
    walls: NDArray[np.bool_], states: NDArray[np.int8], row: int, column: int, reach: int
) -> bool:
    rows, columns = walls.shape
    for i in range(max(row - reach, 0), min(row + reach + 1, rows)):
        for j in range(max(column - reach, 0), min(column + reach + 1, columns)):
            if walls[i, j] and states[i, j] != OCCUPIED:
                return True
    return False
