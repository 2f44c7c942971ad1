"""Kernel that lowers the log odds of every cell inside an outline, each cell once."""

import numpy as np
from numba import njit
from numpy.typing import NDArray


@njit(cache=True)
def lower_inside(
    log_odds: NDArray[np.float32],
    edges: NDArray[np.float64],
    amount: np.float32,
    lowest: np.float32,
) -> None:
    """Take ``amount`` from every cell whose centre the edges wind around, down to ``lowest``.

    A scan line goes through the centres of each row; between two of its crossings with the edges
    the winding number is the same, and not zero inside.

    Args:
        log_odds: The grid ``(rows, columns)``, changed in place; what lies outside is left out.
        edges: Directed edges ``(m, 4)`` x0, y0, x1, y1 in cells from the grid's corner; closed.
        amount: Log odds to take, a positive number.
        lowest: Cells go no lower than this.
    """
    rows, columns = log_odds.shape
    starts, at, turns = _crossings(edges, rows)
    for row in range(rows):
        first, last = starts[row], starts[row + 1]
        if first < last:
            _sort(at[first:last], turns[first:last])
            winding = 0
            for k in range(first, last - 1):
                winding += turns[k]
                if winding != 0:
                    begin = min(max(_first_centre(at[k]), 0), columns)
                    end = min(max(_first_centre(at[k + 1]), 0), columns)
                    line = log_odds[row, begin:end]
                    for column in range(len(line)):  # this loop runs on whole registers
                        line[column] = max(line[column] - amount, lowest)


@njit(cache=True)
def _crossings(
    edges: NDArray[np.float64], rows: int
) -> tuple[NDArray[np.int64], NDArray[np.float64], NDArray[np.int64]]:
    """Where the edges cross the rows' centre lines, row by row.

    Returns:
        For each row the place of its first crossing ``(rows + 1,)``; x of every crossing ``(k,)``;
        +1 where its edge goes down, which an outline does at its left side, else -1 ``(k,)``.
    """
    starts = np.zeros(rows + 1, dtype=np.int64)
    for edge in range(len(edges)):
        low, high = _rows_crossed(edges[edge], rows)
        for row in range(low, high):
            starts[row + 1] += 1
    starts = np.cumsum(starts)
    at = np.empty(starts[rows])
    turns = np.empty(starts[rows], dtype=np.int64)
    filled = starts[:-1].copy()
    for edge in range(len(edges)):
        x0, y0, x1, y1 = edges[edge]
        low, high = _rows_crossed(edges[edge], rows)
        if low < high:
            slope = (x1 - x0) / (y1 - y0)
            for row in range(low, high):
                at[filled[row]] = x0 + (row + 0.5 - y0) * slope
                turns[filled[row]] = 1 if y1 < y0 else -1
                filled[row] += 1
    return starts, at, turns


@njit(cache=True)
def _rows_crossed(edge: NDArray[np.float64], rows: int) -> tuple[int, int]:
    """The rows, first and one past the last, whose centre line an edge crosses."""
    low, high = min(edge[1], edge[3]), max(edge[1], edge[3])
    return min(max(_first_centre(low), 0), rows), min(max(_first_centre(high), 0), rows)


@njit(cache=True)
def _first_centre(position: float) -> int:
    """The first cell whose centre lies at ``position`` or after it."""
    return int(np.ceil(position - 0.5))


@njit(cache=True)
def _sort(at: NDArray[np.float64], turns: NDArray[np.int64]) -> None:
    """Sort the few crossings of a row by place, both arrays together (insertion sort)."""
    for k in range(1, len(at)):
        place, turn = at[k], turns[k]
        j = k
        while j > 0 and at[j - 1] > place:
            at[j], turns[j] = at[j - 1], turns[j - 1]
            j -= 1
        at[j], turns[j] = place, turn
