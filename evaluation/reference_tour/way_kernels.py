"""The reference tour's inner loops: the shortest ways between blocks of floor.

Fine cells are those of the truth, given as flat rasters ``width`` cells wide; a block is a square
of ``side`` times ``side`` of them. A frame of blocked blocks saves every look for an edge.
"""

import numpy as np
from numba import njit
from numpy.typing import NDArray

Mask = NDArray[np.bool_]

NEIGHBOURS = np.array(
    [(0, 1), (1, 2), (1, 1), (2, 1), (1, 0), (2, -1), (1, -1), (1, -2)], dtype=np.int64
)
"""Half of the 16 neighbours of a block, as rows and columns off; the others lie opposite."""

BUCKET = 1.0
"""Width of a bucket of the search, in blocks: the usual length of a step."""


@njit(cache=True)
def stand_points(reachable: Mask, width: int, side: int) -> NDArray[np.int32]:
    """The reachable fine cell nearest to each block's centre ``(blocks,)``; -1 where none is."""
    columns = width // side
    points = np.full(len(reachable) // (side * side), -1, dtype=np.int32)
    for block in range(len(points)):
        corner = (block // columns) * side * width + (block % columns) * side
        nearest = np.inf
        for i in range(side):
            for j in range(side):
                if reachable[corner + i * width + j]:
                    away = (i - 0.5 * (side - 1)) ** 2 + (j - 0.5 * (side - 1)) ** 2
                    if away < nearest:
                        nearest = away
                        points[block] = corner + i * width + j
    return points


@njit(cache=True)
def is_clear(cells: Mask, width: int, a: int, b: int) -> bool:
    """Whether the straight line between two fine cells' centres crosses marked cells only.

    Steps from cell edge to cell edge (Amanatides and Woo, 1987); a line through the corner of four
    cells touches all of them.
    """
    rows, columns = b // width - a // width, b % width - a % width
    step_row, step_column = (width if rows > 0 else -width), (1 if columns > 0 else -1)
    rows, columns = abs(rows), abs(columns)
    cell, row, column = a, 0, 0
    while cell != b:
        # The next edge between rows is crossed at (2 row + 1) / (2 rows) of the line.
        order = (2 * row + 1) * columns - (2 * column + 1) * rows
        if order == 0:
            if not (cells[cell + step_row] and cells[cell + step_column]):
                return False
            cell += step_row + step_column
            row += 1
            column += 1
        elif order < 0:
            cell += step_row
            row += 1
        else:
            cell += step_column
            column += 1
        if not cells[cell]:
            return False
    return True


@njit(cache=True)
def link_blocks(
    points: NDArray[np.int32], reachable: Mask, width: int, side: int
) -> NDArray[np.uint16]:
    """Which of its 16 neighbours each block has a clear straight way to, a bit each."""
    columns = width // side
    links = np.zeros(len(points), dtype=np.uint16)
    for block in range(len(points)):
        if points[block] < 0:
            continue
        for k in range(len(NEIGHBOURS)):
            other = block + NEIGHBOURS[k, 0] * columns + NEIGHBOURS[k, 1]
            if points[other] >= 0 and is_clear(reachable, width, points[block], points[other]):
                links[block] |= np.uint16(1 << k)
                links[other] |= np.uint16(1 << (k + 8))
    return links


@njit(cache=True)
def spread(
    links: NDArray[np.uint16],
    points: NDArray[np.int32],
    width: int,
    side: int,
    start: int,
    target: int,
    reach: float,
) -> tuple[NDArray[np.float32], NDArray[np.int32]]:
    """Lengths in fine cells of the shortest ways from one block, and the block before each.

    Blocks wait in buckets of equal width; a block that another of its bucket makes cheaper is
    looked at again (delta-stepping, Meyer and Sanders 2003), so that the result is exact. It stops
    when the bucket of ``target`` (-1: none), or of the length ``reach``, is done.
    """
    columns = width // side
    lengths = np.full(len(points), np.inf, dtype=np.float32)
    before = np.full(len(points), -1, dtype=np.int32)
    waiting = np.zeros(len(points), dtype=np.bool_)
    now, later = np.empty(len(points), dtype=np.int32), np.empty(len(points), dtype=np.int32)
    lengths[start] = 0.0
    later[0] = start
    count_later, limit = 1, 0.0
    while count_later > 0 and limit <= reach and not (target >= 0 and lengths[target] < limit):
        limit += BUCKET * side
        count_now, kept = 0, 0
        for k in range(count_later):
            if lengths[later[k]] < limit:
                now[count_now] = later[k]
                count_now += 1
            else:
                later[kept] = later[k]
                kept += 1
        count_later = kept
        while count_now > 0:
            count_now -= 1
            block = now[count_now]
            waiting[block] = False
            row, column = points[block] // width, points[block] % width
            for k in range(16):
                if not (links[block] >> k) & 1:
                    continue
                sign = 1 if k < 8 else -1
                other = block + sign * (NEIGHBOURS[k % 8, 0] * columns + NEIGHBOURS[k % 8, 1])
                step = np.hypot(points[other] // width - row, points[other] % width - column)
                length = np.float32(lengths[block] + step)
                if length >= lengths[other]:
                    continue
                was_later = waiting[other] and lengths[other] >= limit
                lengths[other] = length
                before[other] = block
                if waiting[other] and not (was_later and length < limit):
                    continue
                if length < limit and not was_later:
                    now[count_now] = other
                    count_now += 1
                elif length >= limit:
                    later[count_later] = other
                    count_later += 1
                waiting[other] = True
    return lengths, before


@njit(cache=True)
def pull_taut(cells: NDArray[np.int64], reachable: Mask, width: int) -> NDArray[np.int64]:
    """Drop the corners of a way along fine cells ``(n,)`` that straight clear lines can skip."""
    kept = np.empty(len(cells), dtype=np.int64)
    kept[0] = cells[0]
    count, anchor = 1, 0
    while anchor < len(cells) - 1:
        best = anchor + 1
        while best + 1 < len(cells) and is_clear(reachable, width, cells[anchor], cells[best + 1]):
            best += 1
        kept[count] = cells[best]
        count += 1
        anchor = best
    return kept[:count]


@njit(cache=True)
def walk_back(
    before: NDArray[np.int32], points: NDArray[np.int32], block: int
) -> NDArray[np.int64]:
    """The stand points from the start of a search to one block, both included."""
    count, at = 1, before[block]
    while at >= 0:
        count += 1
        at = before[at]
    cells = np.empty(count, dtype=np.int64)
    at = block
    for k in range(count - 1, -1, -1):
        cells[k] = points[at]
        at = before[at]
    return cells
