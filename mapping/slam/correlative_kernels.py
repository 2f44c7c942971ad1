"""Kernels of the correlative search: maxima over blocks of a field, and branch and bound on them.

After Olson, "Real-Time Correlative Scan Matching", ICRA 2009, with the bounds of Hess et al.,
"Real-Time Loop Closure in 2D LIDAR SLAM", ICRA 2016: the best of a block of translations is never
more than the sum over the readings of the field's maximum over the block.
"""

import numpy as np
from numba import njit
from numpy.typing import NDArray

FULL = 255
"""What the fields count as a sure wall: they are kept in bytes."""


def block_maxima(field: NDArray[np.uint8], levels: int) -> NDArray[np.uint8]:
    """The maxima ``(levels, rows, columns)`` over blocks of 2^level cells up and to the right.

    Blocks that stick out of the field count what lies inside. NumPy's own loops are faster here
    than compiled ones: they take 32 bytes at a time.

    Args:
        field: The field ``(rows, columns)``; level 0 is a copy of it.
        levels: How many there shall be, at least 1.
    """
    maxima = np.empty((levels, *field.shape), dtype=np.uint8)
    maxima[0] = field
    for level in range(1, levels):
        step = 1 << (level - 1)
        wide = maxima[level - 1].copy()
        np.maximum(wide[:, :-step], maxima[level - 1][:, step:], out=wide[:, :-step])
        maxima[level] = wide
        np.maximum(wide[:-step], wide[step:], out=maxima[level][:-step])
    return maxima


@njit(cache=True)
def search(
    maxima: NDArray[np.uint8],
    points: NDArray[np.float64],
    weights: NDArray[np.float64],
    center: NDArray[np.float64],
    turns: NDArray[np.float64],
    reach: int,
    pull: NDArray[np.float64],
    floor: float,
) -> tuple[float, int, int, int]:
    """The turn and shift of whole cells that lay the most weight of a scan on known walls.

    Args:
        maxima: Block maxima of the field ``(levels, rows, columns)``.
        points: Readings in the scan's frame, in cells ``(n, 2)``.
        weights: How much each reading tells ``(n,)``; they add up to 1.
        center: Pose about which to search, in cells: x, y from the corner, yaw [rad] ``(3,)``.
        turns: Turns to try ``(m,)`` [rad], added to the centre's yaw.
        reach: Shifts to try: from -reach to reach cells along both axes.
        pull: What a shift costs per cell squared, and a turn per radian squared ``(2,)``.
        floor: Only a better score than this is looked for.

    Returns:
        The score (at most 1; ``floor`` when none is better), the index of the turn, and the shift
        along x and y in cells.
    """
    levels = len(maxima)
    top = levels - 1
    stride = 1 << top
    across = (2 * reach) // stride + 1
    count = len(weights)
    columns_at = np.empty((len(turns), count), dtype=np.int32)
    rows_at = np.empty((len(turns), count), dtype=np.int32)
    shares = (weights / FULL).astype(np.float32)
    bounds = np.empty(len(turns) * across * across, dtype=np.float32)
    for turn in range(len(turns)):
        cos, sin = np.cos(center[2] + turns[turn]), np.sin(center[2] + turns[turn])
        for i in range(count):
            x, y = points[i, 0], points[i, 1]
            columns_at[turn, i] = int(np.floor(center[0] + cos * x - sin * y))
            rows_at[turn, i] = int(np.floor(center[1] + sin * x + cos * y))
        cost = pull[1] * turns[turn] ** 2
        for k in range(across * across):
            shift_y, shift_x = k // across * stride - reach, k % across * stride - reach
            bounds[turn * across * across + k] = (
                _score(maxima[top], rows_at[turn], columns_at[turn], shares, shift_x, shift_y, top)
                - cost
            )
    best, best_turn, best_x, best_y = floor, -1, 0, 0
    stack = np.empty((4 * levels + 4, 4), dtype=np.int64)
    stack_bounds = np.empty(4 * levels + 4)
    for place in np.argsort(-bounds):
        if bounds[place] <= best:
            break
        turn, k = place // (across * across), place % (across * across)
        cost = pull[1] * turns[turn] ** 2
        stack[0, 0], stack[0, 1] = top, k % across * stride - reach
        stack[0, 2] = k // across * stride - reach
        stack_bounds[0] = bounds[place]
        depth = 1
        while depth > 0:
            depth -= 1
            if stack_bounds[depth] <= best:
                continue
            level, shift_x, shift_y = stack[depth, 0], stack[depth, 1], stack[depth, 2]
            if level == 0:
                if abs(shift_x) > reach or abs(shift_y) > reach:
                    continue
                score = stack_bounds[depth] - pull[0] * (shift_x**2 + shift_y**2)
                if score > best:
                    best, best_turn, best_x, best_y = score, turn, shift_x, shift_y
                continue
            half = 1 << (level - 1)
            first = depth
            for child in range(4):
                child_x, child_y = shift_x + (child & 1) * half, shift_y + (child >> 1) * half
                bound = (
                    _score(
                        maxima[level - 1],
                        rows_at[turn],
                        columns_at[turn],
                        shares,
                        child_x,
                        child_y,
                        level - 1,
                    )
                    - cost
                )
                if bound <= best:
                    continue
                place_in = depth
                while place_in > first and stack_bounds[place_in - 1] > bound:
                    for part in range(3):
                        stack[place_in, part] = stack[place_in - 1, part]
                    stack_bounds[place_in] = stack_bounds[place_in - 1]
                    place_in -= 1
                stack[place_in, 0], stack[place_in, 1] = level - 1, child_x
                stack[place_in, 2] = child_y
                stack_bounds[place_in] = bound
                depth += 1
    return best, best_turn, best_x, best_y


@njit(cache=True)
def _score(
    field: NDArray[np.uint8],
    rows_at: NDArray[np.int32],
    columns_at: NDArray[np.int32],
    shares: NDArray[np.float32],
    shift_x: int,
    shift_y: int,
    level: int,
) -> float:
    """The weight that lies on walls after a shift; at higher levels, the most that a block can."""
    rows, columns = field.shape
    lowest = -(1 << level)
    total = np.float32(0.0)
    for i in range(len(shares)):
        row, column = rows_at[i] + shift_y, columns_at[i] + shift_x
        if row > lowest and column > lowest and row < rows and column < columns:
            total += shares[i] * field[max(row, 0), max(column, 0)]
    return float(total)
