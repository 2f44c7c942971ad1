"""Kernel that finds the cells of a map around a place."""

import numpy as np
from numba import njit


@njit(cache=True)
def cells_around(
    shape: tuple[int, int], lattice: tuple[float, float, float], x: float, y: float, reach: float
) -> tuple[int, int, int, int]:
    """First and one past the last row, then column, of a square around (x, y) within the map.

    Args:
        shape: Rows and columns of the map.
        lattice: Its origin x, y and its resolution [m].
        x: Middle of the square [m].
        y: The same.
        reach: Half its side [m].
    """
    left, bottom, resolution = lattice
    rows, columns = shape
    first_row = max(int(np.floor((y - reach - bottom) / resolution)), 0)
    end_row = min(int(np.floor((y + reach - bottom) / resolution)) + 1, rows)
    first_column = max(int(np.floor((x - reach - left) / resolution)), 0)
    end_column = min(int(np.floor((x + reach - left) / resolution)) + 1, columns)
    return first_row, max(end_row, first_row), first_column, max(end_column, first_column)
