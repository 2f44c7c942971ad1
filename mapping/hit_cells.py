"""Kernels for the cells that a scan saw occupied: which they are, and raising them."""

import numpy as np
from numba import njit
from numpy.typing import NDArray


@njit(cache=True)
def hit_cells(
    ends: NDArray[np.float64],
    gains: NDArray[np.float64],
    longest_link: float,
    shape: tuple[int, int],
) -> tuple[NDArray[np.int64], NDArray[np.float32]]:
    """The cells ``(k, 2)`` as (row, column) where beams ended, and what each gains ``(k,)``.

    Two ends in turn that are near one another belong to one wall: the cells of the line between
    them, in steps of at most a cell, gain what the less certain of the two does. A cell may come
    more than once.

    Args:
        ends: Where beams ended, x and y in cells from the grid's corner ``(n, 2)``.
        gains: Log odds that each end is worth ``(n,)``.
        longest_link: Ends at most this many cells apart belong to one wall.
        shape: Rows and columns of the grid; cells outside are left out.
    """
    count = len(gains)
    steps = np.zeros(count, dtype=np.int64)
    for i in range(count):
        j = (i + 1) % count
        apart_x, apart_y = abs(ends[j, 0] - ends[i, 0]), abs(ends[j, 1] - ends[i, 1])
        if np.hypot(apart_x, apart_y) <= longest_link:
            steps[i] = max(int(np.ceil(max(apart_x, apart_y))) - 1, 0)
    cells = np.empty((count + steps.sum(), 2), dtype=np.int64)
    worth = np.empty(len(cells), dtype=np.float32)
    made = 0
    for i in range(count):
        j = (i + 1) % count
        for step in range(steps[i] + 1):
            share = step / (steps[i] + 1)
            column = int(np.floor(ends[i, 0] + share * (ends[j, 0] - ends[i, 0])))
            row = int(np.floor(ends[i, 1] + share * (ends[j, 1] - ends[i, 1])))
            if 0 <= row < shape[0] and 0 <= column < shape[1]:
                cells[made, 0], cells[made, 1] = row, column
                worth[made] = gains[i] if step == 0 else min(gains[i], gains[j])
                made += 1
    return cells[:made], worth[:made]


@njit(cache=True)
def raised_values(
    log_odds: NDArray[np.float32],
    cells: NDArray[np.int64],
    gains: NDArray[np.float32],
    highest: np.float32,
) -> NDArray[np.float32]:
    """The log odds of cells ``(k, 2)`` with their gains ``(k,)`` added, ``highest`` at most."""
    values = np.empty(len(cells), dtype=np.float32)
    for k in range(len(cells)):
        values[k] = min(log_odds[cells[k, 0], cells[k, 1]] + gains[k], highest)
    return values


@njit(cache=True)
def raise_to(
    log_odds: NDArray[np.float32], cells: NDArray[np.int64], values: NDArray[np.float32]
) -> None:
    """Let no cell of ``cells`` ``(k, 2)`` be below its value ``(k,)``, whatever it is now."""
    for k in range(len(cells)):
        row, column = cells[k, 0], cells[k, 1]
        log_odds[row, column] = max(log_odds[row, column], values[k])
