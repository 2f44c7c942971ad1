"""The frontier's inner loops: marking borders, and unmarking those that drift has made."""

import numpy as np
from numba import njit
from numpy.typing import NDArray

from mapping.grid import FREE, OCCUPIED, UNKNOWN


@njit(cache=True)
def mark_frontier(states: NDArray[np.int8], beside_walls: bool) -> NDArray[np.int8]:
    """1 for every free cell with an unknown neighbour of four and no occupied one of eight, else 0.

    Where a wall was seen from afar its returns lie apart: the holes between them are no frontier,
    unless ``beside_walls``.
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
                marked[i, j] = beside_walls or not touches_occupied(states, i, j)
    return marked


@njit(cache=True)
def take_pieces(marked: NDArray[np.int8]) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """The marked cells, sorted into pieces that hang together by eight neighbours; unmarks them.

    Returns:
        The cells ``(n, 2)`` as (row, column), piece by piece, the pieces in the order of their
        first cells row by row, as are a piece's own; and where each piece begins ``(pieces + 1,)``.
    """
    rows, columns = marked.shape
    found = np.empty(np.count_nonzero(marked), dtype=np.int64)
    starts = np.zeros(len(found) + 1, dtype=np.int64)
    count = pieces = 0
    for row in range(rows):
        for column in range(columns):
            if not marked[row, column]:
                continue
            marked[row, column] = 0
            found[count] = row * columns + column
            first, looked_at, count = count, count, count + 1
            while looked_at < count:
                here_row, here_column = found[looked_at] // columns, found[looked_at] % columns
                looked_at += 1
                for i in range(max(here_row - 1, 0), min(here_row + 2, rows)):
                    for j in range(max(here_column - 1, 0), min(here_column + 2, columns)):
                        if marked[i, j]:
                            marked[i, j] = 0
                            found[count] = i * columns + j
                            count += 1
            found[first:count].sort()
            pieces += 1
            starts[pieces] = count
    cells = np.empty((count, 2), dtype=np.int64)
    for k in range(count):
        cells[k, 0], cells[k, 1] = found[k] // columns, found[k] % columns
    return cells, starts[: pieces + 1]


@njit(cache=True)
def any_near(marked: NDArray[np.bool_], cells: NDArray[np.int64], reach: int) -> bool:
    """Whether a marked cell lies within ``reach`` rows and columns of one of ``(n, 2)`` cells."""
    rows, columns = marked.shape
    for k in range(len(cells)):
        row, column = cells[k, 0], cells[k, 1]
        for i in range(max(row - reach, 0), min(row + reach + 1, rows)):
            for j in range(max(column - reach, 0), min(column + reach + 1, columns)):
                if marked[i, j]:
                    return True
    return False


@njit(cache=True)
def touches_occupied(states: NDArray[np.int8], row: int, column: int) -> bool:
    """Whether a cell or one of its eight neighbours is occupied."""
    rows, columns = states.shape
    for i in range(max(row - 1, 0), min(row + 2, rows)):
        for j in range(max(column - 1, 0), min(column + 2, columns)):
            if states[i, j] == OCCUPIED:
                return True
    return False


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
    """Unmark every cell with a wall that is occupied no more within ``reach`` cells.

    One that still touches an occupied cell has not moved: it has only been drawn thinner since.
    """
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
            if walls[i, j] and not touches_occupied(states, i, j):
                return True
    return False


@njit(cache=True)
def mark_disc(marks: NDArray[np.bool_], row: int, column: int, radius: float) -> None:
    """Mark every cell within ``radius`` cells of a cell."""
    rows, columns = marks.shape
    span = int(np.ceil(radius))
    for i in range(max(row - span, 0), min(row + span + 1, rows)):
        for j in range(max(column - span, 0), min(column + span + 1, columns)):
            if np.hypot(i - row, j - column) <= radius:
                marks[i, j] = True
