"""Kernel of the search for the cheapest ways from one cell to all others (Dijkstra 1959)."""

import math

import numpy as np
from numba import njit
from numpy.typing import NDArray

from mapping.grid import OCCUPIED

SQRT2 = math.sqrt(2.0)

NEIGHBOURS = 8
"""In this order: three of the row before, left to right, two beside, three of the row after."""


@njit(cache=True)
def spread_cost(
    cost: NDArray[np.float32],
    states: NDArray[np.int8],
    start_row: int,
    start_column: int,
    resolution: float,
    max_cost: float,
    escape_radius: float,
    escape_cost: float,
    dearest: float,
) -> tuple[NDArray[np.float32], NDArray[np.int32]]:
    """The cost to come to each cell, and the flat index of the cell that it is come to from.

    A step to one of eight neighbours costs its length times the mean cost of its ends. Open cells
    wait in buckets as wide as the cheapest step (Dial 1969; with that width no cell of a bucket can
    make another of it cheaper, so the result is exact). One that has become cheaper waits a second
    time, in an earlier bucket or ahead in its own; the entry left behind is passed over. A rim of
    closed cells spares the question whether a neighbour lies on the map.

    The loop is in one piece because kernels of their own for its steps made it slower.

    Args:
        cost: Cost per metre of each cell ``[row, col]``; inf where none may go.
        states: Their states.
        start_row: Where to start; outside the map nothing is reached.
        start_column: The same.
        resolution: Edge of a cell [m].
        max_cost: Stop when every cheaper cell is settled.
        escape_radius: Within this distance of the start [m] cells of infinite cost that are not
            occupied may be crossed.
        escape_cost: What these cost per metre.
        dearest: The largest cost per metre that is not infinite.

    Returns:
        Cost to come [m, dearer near things], inf where no way leads; parents, -1 at the start and
        where no way leads.
    """
    rows, columns = cost.shape
    if not (0 <= start_row < rows and 0 <= start_column < columns):
        return (
            np.full((rows, columns), np.inf, dtype=np.float32),
            np.full((rows, columns), -1, dtype=np.int32),
        )
    width = columns + 2
    price = _rimmed(cost)
    toll = price.copy()
    _open_escape(
        toll, cost, states, start_row, start_column, escape_radius / resolution, escape_cost
    )
    offsets = _offsets(width)
    halves = np.empty(NEIGHBOURS)
    for k in range(NEIGHBOURS):
        halves[k] = resolution * np.float32(SQRT2 if k in (0, 2, 5, 7) else 1.0) * 0.5
    to_come = np.full(len(price), np.inf, dtype=np.float32)
    steps = np.full(len(price), -1, dtype=np.int8)
    slots = np.full(len(price), -1, dtype=np.int16)
    ring = 1  # a power of two: its remainders are quick
    while ring < int(SQRT2 * max(escape_cost, dearest)) + 3:
        ring *= 2
    heads = np.full(ring, -1, dtype=np.int32)
    cell_of = np.empty(NEIGHBOURS * cost.size + 1, dtype=np.int32)  # as many as can ever wait
    after = np.empty_like(cell_of)
    start = (start_row + 1) * width + start_column + 1
    to_come[start], slots[start] = 0.0, 0
    cell_of[0], after[0], heads[0] = start, -1, 0
    made, spare = 1, -1
    waiting, bucket = 1, 0
    while waiting > 0 and bucket * resolution <= max_cost:
        slot = bucket & (ring - 1)
        entry = heads[slot]
        if entry < 0:
            bucket += 1
            continue
        heads[slot], after[entry], spare = after[entry], spare, entry
        waiting -= 1
        cell = cell_of[entry]
        if slots[cell] != slot:
            continue  # it was settled since
        slots[cell] = -1
        is_open = price[cell] != np.inf
        here = min(price[cell], np.float32(escape_cost))
        for k in range(NEIGHBOURS):
            other = cell + offsets[k]
            if toll[other] == np.inf:
                continue
            total = np.float32(to_come[cell] + halves[k] * (here + toll[other]))
            if total >= to_come[other]:
                continue
            if is_open and price[other] != np.inf and k in (0, 2, 5, 7):
                beside, beyond = (1, 3 if k == 0 else 4) if k < 3 else (6, 3 if k == 5 else 4)
                if (
                    price[cell + offsets[beside]] == np.inf
                    or price[cell + offsets[beyond]] == np.inf
                ):
                    continue  # a diagonal step must not cut the corner of a closed cell
            to_come[other], steps[other] = total, k
            into = max(int(total / resolution), bucket) & (ring - 1)
            if spare >= 0:
                entry, spare = spare, after[spare]
            else:
                entry, made = made, made + 1
            cell_of[entry], after[entry], heads[into] = other, heads[into], entry
            slots[other] = into
            waiting += 1
    return _without_rim(to_come, cost.shape), _parents(steps, cost.shape)


@njit(cache=True)
def _offsets(width: int) -> NDArray[np.int64]:
    """From a cell to its neighbours, in cells of a grid with rows so wide."""
    return np.array([-width - 1, -width, -width + 1, -1, 1, width - 1, width, width + 1])


@njit(cache=True)
def _rimmed(cost: NDArray[np.float32]) -> NDArray[np.float32]:
    """The costs row by row, with a rim of infinite ones."""
    rows, columns = cost.shape
    rimmed = np.full((rows + 2, columns + 2), np.inf, dtype=np.float32)
    rimmed[1:-1, 1:-1] = cost
    return rimmed.reshape(-1)


@njit(cache=True)
def _without_rim(rimmed: NDArray[np.float32], shape: tuple[int, int]) -> NDArray[np.float32]:
    """The opposite."""
    return rimmed.reshape((shape[0] + 2, shape[1] + 2))[1:-1, 1:-1].copy()


@njit(cache=True)
def _open_escape(
    toll: NDArray[np.float32],
    cost: NDArray[np.float32],
    states: NDArray[np.int8],
    start_row: int,
    start_column: int,
    radius: float,
    escape_cost: float,
) -> None:
    """Let what is closed but not occupied, within ``radius`` cells of the start, be crossed."""
    rows, columns = cost.shape
    reach = int(radius) + 1
    for i in range(max(start_row - reach, 0), min(start_row + reach + 1, rows)):
        for j in range(max(start_column - reach, 0), min(start_column + reach + 1, columns)):
            is_near = math.hypot(i - start_row, j - start_column) <= radius
            if is_near and cost[i, j] == np.inf and states[i, j] != OCCUPIED:
                toll[(i + 1) * (columns + 2) + j + 1] = escape_cost


@njit(cache=True)
def _parents(steps: NDArray[np.int8], shape: tuple[int, int]) -> NDArray[np.int32]:
    """The cell that each is come to from, by the last step to it, -1 for none."""
    rows, columns = shape
    offsets = _offsets(columns)
    parents = np.full((rows, columns), -1, dtype=np.int32)
    for row in range(rows):
        for column in range(columns):
            step = steps[(row + 1) * (columns + 2) + column + 1]
            if step >= 0:
                parents[row, column] = row * columns + column - offsets[step]
    return parents
