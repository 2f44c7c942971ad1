"""The reference tour's inner loops: which blocks of floor are seen from a cell, and how many.

Cells and blocks are those of `evaluation.reference_tour.way_kernels`.
"""

import numpy as np
from numba import njit
from numpy.typing import NDArray

Mask = NDArray[np.bool_]


@njit(cache=True)
def see_blocks(
    blocked: Mask, free: Mask, width: int, side: int, cell: int, reach: float, beams: int
) -> NDArray[np.int32]:
    """The blocks seen from a fine cell, as runs along rows ``(n, 2)``: first, one past the last.

    A block is seen when a beam crosses its middle, half as wide as itself: one that grazes its rim
    shows less than half of it. Beams step from block edge to block edge (Amanatides and Woo, 1987),
    and through blocks that are not ``free`` as a whole from cell edge to cell edge, until
    something stops them.
    """
    columns = width // side
    half = int(reach) // side + 2
    size = 2 * half + 1
    corner = (cell // width // side - half) * columns + cell % width // side - half
    own_y, own_x = cell // width % side + 0.5, cell % width % side + 0.5
    seen = np.zeros(size * size, dtype=np.bool_)
    seen[half * size + half] = True
    for beam in range(beams):
        angle = 2.0 * np.pi * beam / beams
        cos, sin = np.cos(angle), np.sin(angle)
        step_column, step_row = (1 if cos > 0.0 else -1), (1 if sin > 0.0 else -1)
        per_column = side / abs(cos) if cos != 0.0 else np.inf
        per_row = side / abs(sin) if sin != 0.0 else np.inf
        next_column = (side - own_x if cos > 0.0 else own_x) * per_column / side
        next_row = (side - own_y if sin > 0.0 else own_y) * per_row / side
        # How far a block's middle lies beside the beam, and how much it may for being crossed.
        beside = (0.5 * side - own_y) * cos - (0.5 * side - own_x) * sin
        half_middle = 0.25 * side * (abs(cos) + abs(sin))
        row, column, way = half, half, 0.0
        while way <= reach:
            end = min(next_column, next_row, reach)
            block = corner + row * columns + column
            if not free[block]:
                y, x = own_y - (row - half) * side, own_x - (column - half) * side
                first = (block // columns * width + block % columns) * side
                end = _stop_in_block(blocked, first, width, side, y, x, sin, cos, way, end)
            middle = (row - half + 0.5) * side - own_y, (column - half + 0.5) * side - own_x
            if abs(beside) <= half_middle and middle[0] * sin + middle[1] * cos <= end:
                seen[row * size + column] = True
            if end < min(next_column, next_row):
                break
            if next_column < next_row:
                way = next_column
                column += step_column
                next_column += per_column
                beside -= step_column * side * sin
            else:
                way = next_row
                row += step_row
                next_row += per_row
                beside += step_row * side * cos
    runs: NDArray[np.int32] = _runs(seen, size, corner, columns)
    return runs


@njit(cache=True)
def _stop_in_block(
    blocked: Mask,
    first: int,
    width: int,
    side: int,
    y: float,
    x: float,
    sin: float,
    cos: float,
    way: float,
    end: float,
) -> float:
    """How far a beam gets that crosses a block between two lengths of way.

    ``first`` is the block's first cell; the beam starts at y, x, counted in cells from its corner.
    """
    middle = 0.5 * (way + end)
    inside = min(way + 1e-6, middle)  # past the edge, so that rounding finds the cell behind it
    row = min(max(int(np.floor(y + inside * sin)), 0), side - 1)
    column = min(max(int(np.floor(x + inside * cos)), 0), side - 1)
    step_column, step_row = (1 if cos > 0.0 else -1), (1 if sin > 0.0 else -1)
    per_column = 1.0 / abs(cos) if cos != 0.0 else np.inf
    per_row = 1.0 / abs(sin) if sin != 0.0 else np.inf
    next_column = abs(column + (cos > 0.0) - x) * per_column
    next_row = abs(row + (sin > 0.0) - y) * per_row
    while True:
        if blocked[first + row * width + column]:
            return way
        way = min(next_column, next_row)
        if way >= end:
            return end
        if next_column < next_row:
            column += step_column
            next_column += per_column
        else:
            row += step_row
            next_row += per_row
        if not (0 <= row < side and 0 <= column < side):
            return end


@njit(cache=True)
def _runs(seen: Mask, size: int, corner: int, columns: int) -> NDArray[np.int32]:
    """The marked cells of a square window as runs along its rows."""
    runs = np.empty((size * (size + 1) // 2, 2), dtype=np.int32)
    count = 0
    for i in range(size):
        j = 0
        while j < size:
            if seen[i * size + j]:
                runs[count, 0] = corner + i * columns + j
                while j < size and seen[i * size + j]:
                    j += 1
                runs[count, 1] = corner + i * columns + j
                count += 1
            j += 1
    return runs[:count].copy()


@njit(cache=True)
def unseen_weight(
    runs: NDArray[np.int32], weights: NDArray[np.int32], views: NDArray[np.int32]
) -> int:
    """The weight of the blocks in some runs that no view has."""
    total = 0
    for k in range(len(runs)):
        for block in range(runs[k, 0], runs[k, 1]):
            total += weights[block] if views[block] == 0 else 0
    return total


@njit(cache=True)
def count_views(
    runs: NDArray[np.int32], weights: NDArray[np.int32], views: NDArray[np.int32], change: int
) -> int:
    """Add 1 or -1 to the number of views that have each block of some runs, in place.

    Returns the weight that is seen for the first time, or by nobody any more.
    """
    total = 0
    for k in range(len(runs)):
        for block in range(runs[k, 0], runs[k, 1]):
            before = views[block]
            views[block] = before + change
            if before == 0 or before + change == 0:
                total += weights[block]
    return total
