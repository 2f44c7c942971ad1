"""Numba kernel that covers the cells of a mask with few rectangles."""

from typing import Any

import numpy as np
from numba import njit
from numpy.typing import NDArray


@njit(cache=True)
def rectangles(mask: NDArray[np.bool_]) -> NDArray[np.int64]:
    """Rectangles that together hold every true cell once, and no other.

    Greedy: from the first cell left, in rows from the origin on, the run to the right grown upwards
    or the run upwards grown to the right, whichever holds more cells. A wall along either axis so
    becomes one rectangle.

    Args:
        mask: Cells ``[row, col]``.

    Returns:
        First row, row after the last, first column, column after the last ``(n, 4)``.
    """
    left = mask.copy()
    found = np.empty((64, 4), dtype=np.int64)
    count = 0
    for row in range(mask.shape[0]):
        for column in range(mask.shape[1]):
            if not left[row, column]:
                continue
            wide_row, wide_column = _grow(left, row, column)
            tall_column, tall_row = _grow(left.T, column, row)
            wide = (wide_row - row) * (wide_column - column)
            tall = (tall_row - row) * (tall_column - column)
            if wide >= tall:
                last_row, last_column = wide_row, wide_column
            else:
                last_row, last_column = tall_row, tall_column
            left[row:last_row, column:last_column] = False
            if count == len(found):
                found = np.concatenate((found, np.empty_like(found)))
            found[count] = (row, last_row, column, last_column)
            count += 1
    return found[:count].copy()


@njit(cache=True)
def _grow(left: Any, row: int, column: int) -> tuple[int, int]:
    """The row and column after the longest run along a row, grown over as many rows as hold it."""
    last_column = column + 1
    while last_column < left.shape[1] and left[row, last_column]:
        last_column += 1
    last_row = row + 1
    while last_row < left.shape[0] and np.all(left[last_row, column:last_column]):
        last_row += 1
    return last_row, last_column
