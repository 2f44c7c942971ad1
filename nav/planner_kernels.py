"""The planner's inner loops: walking back along a search, pulling a path taut."""

import numpy as np
from numba import njit
from numpy.typing import NDArray

FORBIDDEN_COST = 1.0e4
"""Stands for infinity where costs are added up and subtracted again."""
ROUNDING = 1e-3
"""Share by which a straight line may look dearer than the same way cell by cell: sampling."""
TAUT_CELLS = 80
"""Longest straight piece that is looked for, 4 m at 5 cm: longer ones gain next to nothing."""


@njit(cache=True)
def descend(parents: NDArray[np.int32], row: int, column: int) -> NDArray[np.int64]:
    """The cells ``(n, 2)`` from the start of a search to one cell, both included."""
    columns = parents.shape[1]
    count = 1
    index = row * columns + column
    while parents[index // columns, index % columns] >= 0:
        index = parents[index // columns, index % columns]
        count += 1
    cells = np.empty((count, 2), dtype=np.int64)
    index = row * columns + column
    for k in range(count - 1, -1, -1):
        cells[k, 0], cells[k, 1] = index // columns, index % columns
        index = parents[index // columns, index % columns]
    return cells


@njit(cache=True)
def shorten(cells: NDArray[np.int64], cost: NDArray[np.float32]) -> NDArray[np.int64]:
    """Drop corners of a path as long as the straight line is not dearer than the way round it."""
    count = len(cells)
    keep = np.empty(count, dtype=np.int64)
    keep[0] = 0
    kept = 1
    anchor = 0
    along = np.zeros(count)
    for k in range(1, count):
        along[k] = along[k - 1] + line_cost(cells[k - 1], cells[k], cost)
    while anchor < count - 1:
        best = anchor + 1
        for k in range(anchor + 2, min(anchor + TAUT_CELLS, count)):
            way_round = along[k] - along[anchor]
            if line_cost(cells[anchor], cells[k], cost) <= way_round * (1.0 + ROUNDING):
                best = k
        keep[kept] = best
        kept += 1
        anchor = best
    return cells[keep[:kept]]


@njit(cache=True)
def line_cost(a: NDArray[np.int64], b: NDArray[np.int64], cost: NDArray[np.float32]) -> float:
    """Cost of the straight line between two cells' centres, in cells; sampled every half cell."""
    dy, dx = float(b[0] - a[0]), float(b[1] - a[1])
    length = np.hypot(dy, dx)
    steps = max(1, int(np.ceil(2.0 * length)))
    total = 0.0
    for k in range(steps):
        t = (k + 0.5) / steps
        row, column = int(np.floor(a[0] + t * dy + 0.5)), int(np.floor(a[1] + t * dx + 0.5))
        total += min(float(cost[row, column]), FORBIDDEN_COST)
    return float(total * length / steps)


@njit(cache=True)
def costs_along_tree(
    parents: NDArray[np.int32], cost_to_come: NDArray[np.float32], cells: NDArray[np.int64]
) -> NDArray[np.float64]:
    """Cost between cells ``(n, n)`` by way of the tree that a search has grown.

    Two cells are joined at their last common ancestor, so this is never less than the cheapest way
    and is it wherever the way forks only once, as between rooms on a corridor.
    """
    count = len(cells)
    columns = parents.shape[1]
    costs = np.zeros((count, count))
    on_way = np.zeros(parents.size, dtype=np.bool_)
    for a in range(count):
        _mark_way(parents, cells[a, 0] * columns + cells[a, 1], on_way, True)
        for b in range(count):
            index = cells[b, 0] * columns + cells[b, 1]
            while not on_way[index]:
                index = parents[index // columns, index % columns]
            shared = cost_to_come[index // columns, index % columns]
            to_a = cost_to_come[cells[a, 0], cells[a, 1]]
            to_b = cost_to_come[cells[b, 0], cells[b, 1]]
            costs[a, b] = to_a + to_b - 2.0 * shared
        _mark_way(parents, cells[a, 0] * columns + cells[a, 1], on_way, False)
    return costs


@njit(cache=True)
def _mark_way(
    parents: NDArray[np.int32], index: int, on_way: NDArray[np.bool_], value: bool
) -> None:
    """Set a mark on every cell from one back to the start of the search."""
    columns = parents.shape[1]
    while index >= 0:
        on_way[index] = value
        index = parents[index // columns, index % columns]


@njit(cache=True)
def shortcut_in_sight(
    cells: NDArray[np.int64],
    cost: NDArray[np.float32],
    resolution: float,
    costs: NDArray[np.float64],
) -> None:
    """Lower the cost between two cells to that of the straight line where it is open, in place."""
    for a in range(len(cells)):
        for b in range(a):
            straight = resolution * line_cost(cells[a], cells[b], cost)
            if straight < costs[a, b]:
                costs[a, b] = costs[b, a] = straight
