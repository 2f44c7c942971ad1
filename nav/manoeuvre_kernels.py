"""The manoeuvre's inner loops: what is near, how close a pose comes to it, the search for a way."""

import heapq

import numpy as np
from numba import njit
from numpy.typing import NDArray

from nav.cell_window_kernels import cells_around
from nav.outline import Rectangle

NO_MOVE, FORWARD, BACKWARD, LEFT, RIGHT = -1, 0, 1, 2, 3
"""The kinds of moves."""

SQRT2 = 2.0**0.5
"""Cells are so many times smaller than a straight step, so that it always leaves its cell."""

ROUNDING = 1e-6
"""So much nearer is no nearer [m]: driving along a straight wall keeps the distance."""


@njit(cache=True)
def bucket_points(
    points: NDArray[np.float64], left: float, bottom: float, size: float, count: int
) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """Sort points into ``count`` x ``count`` square buckets, row by row; those outside are dropped.

    Returns:
        The points ``(m, 2)`` in the order of their buckets, and where each bucket begins
        ``(count * count + 1,)``.
    """
    buckets = np.full(len(points), -1, dtype=np.int64)
    begins = np.zeros(count * count + 1, dtype=np.int64)
    for k in range(len(points)):
        column = int(np.floor((points[k, 0] - left) / size))
        row = int(np.floor((points[k, 1] - bottom) / size))
        if 0 <= row < count and 0 <= column < count:
            buckets[k] = row * count + column
            begins[buckets[k] + 1] += 1
    for bucket in range(count * count):
        begins[bucket + 1] += begins[bucket]
    ends = begins.copy()
    ordered = np.empty((begins[-1], 2))
    for k in range(len(points)):
        if buckets[k] >= 0:
            place = ends[buckets[k]]
            ordered[place, 0], ordered[place, 1] = points[k, 0], points[k, 1]
            ends[buckets[k]] += 1
    return ordered, begins


@njit(cache=True)
def gaps_at(
    ordered: NDArray[np.float64],
    begins: NDArray[np.int64],
    buckets: tuple[float, float, float, int],
    x: float,
    y: float,
    yaw: float,
    outline: tuple[Rectangle, Rectangle],
) -> tuple[float, float]:
    """Distance [m] from the robot's outline, and from its axle, to the nearest point.

    Distances are right up to a bucket's size; what is farther comes out as that size or more.

    Args:
        ordered: The points as ``bucket_points`` sorts them.
        begins: Where each bucket begins.
        buckets: Left and bottom edge of the first bucket, their size [m], and how many a side has.
        x: Of the axle's middle [m].
        y: The same.
        yaw: Heading [rad].
        outline: The rectangles that the robot consists of.
    """
    left, bottom, size, count = buckets
    cos, sin = np.cos(yaw), np.sin(yaw)
    column, row = int(np.floor((x - left) / size)), int(np.floor((y - bottom) / size))
    to_outline = to_axle = size * size
    for i in range(max(row - 1, 0), min(row + 2, count)):
        first, last = max(column - 1, 0), min(column + 1, count - 1)
        if first > last:
            continue
        for k in range(begins[i * count + first], begins[i * count + last + 1]):
            dx, dy = ordered[k, 0] - x, ordered[k, 1] - y
            ahead, aside = cos * dx + sin * dy, abs(cos * dy - sin * dx)
            to_axle = min(to_axle, dx * dx + dy * dy)
            for front, back, side in outline:
                out_x = max(ahead - front, -back - ahead, 0.0)
                out_y = max(aside - side, 0.0)
                to_outline = min(to_outline, out_x * out_x + out_y * out_y)
    return np.sqrt(to_outline), np.sqrt(to_axle)


@njit(cache=True)
def search_way(
    ordered: NDArray[np.float64],
    begins: NDArray[np.int64],
    buckets: tuple[float, float, float, int],
    start: NDArray[np.float64],
    outline: tuple[Rectangle, Rectangle],
    clear: float,
    room: float,
    avoided: NDArray[np.float64],
    apart: float,
    wanted: NDArray[np.float64],
    within: float,
    barred: int,
    reach: float,
    step: tuple[float, int],
    prices: tuple[float, float, float],
    most_poses: int,
) -> NDArray[np.int64]:
    """Cheapest moves from a pose to one whose axle has ``room`` all round.

    Poses are exact; of all that fall into one cell and heading, only the cheapest is gone on from
    (hybrid A*, Dolgov et al. 2008, with the straight way to ``wanted`` as its heuristic). A move
    may not come nearer to anything than ``clear``, or than the pose before it where that was nearer
    already.

    Args:
        ordered: The obstacles, as ``bucket_points`` sorts them.
        begins: Where each bucket begins.
        buckets: As ``gaps_at``.
        start: ``(3,)``.
        outline: The rectangles that the robot consists of.
        clear: Distance to keep from everything [m].
        room: Distance of the axle's middle from everything that is looked for [m].
        avoided: Places ``(k, 2)`` near which room does not count [m].
        apart: How near [m].
        wanted: Places ``(k, 2)`` near one of which room is looked for; anywhere if there are none.
        within: How near [m].
        barred: The kind of move not to begin with, -1 for none.
        reach: The way may not lead farther than this from the start, along x or y [m].
        step: Length of a straight move [m] and how many turns make a full circle.
        prices: Of a straight move, of a turn, and of a move of another kind than the one before.
        most_poses: The search gives up when it has gone on from so many poses.

    Returns:
        The kinds of the moves ``(n,)``, empty if the start has room or no way is found.
    """
    length, headings = step
    side = 2 * int(np.ceil(reach * SQRT2 / length)) + 1
    closed = np.zeros(side * side * headings, dtype=np.bool_)
    poses = np.empty((4 * most_poses + 1, 2))
    turns = np.zeros(len(poses), dtype=np.int64)
    gaps, kinds = np.empty(len(poses)), np.full(len(poses), -1, dtype=np.int64)
    parents = np.full(len(poses), -1, dtype=np.int64)
    poses[0, 0], poses[0, 1] = start[0], start[1]
    gaps[0] = gaps_at(ordered, begins, buckets, start[0], start[1], start[2], outline)[0]
    costs = np.zeros(len(poses))
    heap = [(0.0, 0)]
    count, expanded = 1, 0
    while len(heap) > 0 and expanded < most_poses:
        _, index = heapq.heappop(heap)
        x, y, turn = poses[index, 0], poses[index, 1], turns[index]
        column = int(np.floor((x - start[0]) * SQRT2 / length + 0.5)) + side // 2
        row = int(np.floor((y - start[1]) * SQRT2 / length + 0.5)) + side // 2
        if not (0 <= row < side and 0 <= column < side):
            continue
        cell = (row * side + column) * headings + turn
        if closed[cell]:
            continue
        closed[cell] = True
        expanded += 1
        yaw = start[2] + turn * 2.0 * np.pi / headings
        has_room = gaps_at(ordered, begins, buckets, x, y, yaw, outline)[1] >= room
        is_wanted = _left_to(x, y, wanted, within) == 0.0
        if has_room and is_wanted and not _is_near(x, y, avoided, apart):
            moves: NDArray[np.int64] = _moves_to(index, parents, kinds)
            return moves
        for kind in range(4):
            if index == 0 and kind == barred:
                continue
            gap = _gap_after(
                ordered, begins, buckets, x, y, yaw, kind, outline, length, 2.0 * np.pi / headings
            )
            if gap < min(clear, gaps[index]) - ROUNDING:
                continue
            is_straight = kind <= BACKWARD
            along = (length if kind == FORWARD else -length) if is_straight else 0.0
            poses[count, 0] = x + along * np.cos(yaw)
            poses[count, 1] = y + along * np.sin(yaw)
            turned = 0 if is_straight else (1 if kind == LEFT else -1)
            turns[count] = (turn + turned) % headings
            gaps[count], kinds[count], parents[count] = gap, kind, index
            price = prices[0] if is_straight else prices[1]
            if kinds[index] != kind:
                price += prices[2]
            costs[count] = costs[index] + price
            left_to_go = _left_to(poses[count, 0], poses[count, 1], wanted, within)
            heapq.heappush(heap, (costs[count] + left_to_go, count))
            count += 1
    return np.empty(0, dtype=np.int64)


@njit(cache=True)
def _gap_after(
    ordered: NDArray[np.float64],
    begins: NDArray[np.int64],
    buckets: tuple[float, float, float, int],
    x: float,
    y: float,
    yaw: float,
    kind: int,
    outline: tuple[Rectangle, Rectangle],
    length: float,
    angle: float,
) -> float:
    """Least distance of the outline [m] at the end of a move and, of a turn, half way."""
    if kind <= BACKWARD:
        along = length if kind == FORWARD else -length
        x, y = x + along * np.cos(yaw), y + along * np.sin(yaw)
        return float(gaps_at(ordered, begins, buckets, x, y, yaw, outline)[0])
    turned = angle if kind == LEFT else -angle
    half_way = gaps_at(ordered, begins, buckets, x, y, yaw + 0.5 * turned, outline)[0]
    at_end = gaps_at(ordered, begins, buckets, x, y, yaw + turned, outline)[0]
    return float(min(half_way, at_end))


@njit(cache=True)
def _is_near(x: float, y: float, places: NDArray[np.float64], apart: float) -> bool:
    """Whether any of the places ``(k, 2)`` lies within ``apart`` of (x, y) [m]."""
    near = False
    for k in range(len(places)):
        near = near or np.hypot(places[k, 0] - x, places[k, 1] - y) < apart
    return near


@njit(cache=True)
def _left_to(x: float, y: float, places: NDArray[np.float64], within: float) -> float:
    """The straight way from (x, y) to ``within`` [m] of the nearest place; 0 if there is none."""
    if len(places) == 0:
        return 0.0
    nearest = np.inf
    for k in range(len(places)):
        nearest = min(nearest, np.hypot(places[k, 0] - x, places[k, 1] - y))
    return max(nearest - within, 0.0)


@njit(cache=True)
def _moves_to(
    index: int, parents: NDArray[np.int64], kinds: NDArray[np.int64]
) -> NDArray[np.int64]:
    """The kinds of the moves that lead from the root of a search to one of its poses."""
    count, last = 0, index
    while parents[last] >= 0:
        count, last = count + 1, parents[last]
    moves = np.empty(count, dtype=np.int64)
    for k in range(count - 1, -1, -1):
        moves[k] = kinds[index]
        index = parents[index]
    return moves


@njit(cache=True)
def occupied_near(
    log_odds: NDArray[np.float32],
    lattice: tuple[float, float, float],
    occupied_above: float,
    x: float,
    y: float,
    reach: float,
) -> NDArray[np.float64]:
    """Centres ``(n, 2)`` of occupied cells with a neighbour that is not, within a square [m].

    Args:
        log_odds: The map ``[row, col]``.
        lattice: Its origin x, y and its resolution [m].
        occupied_above: Log odds above which a cell is occupied.
        x: Middle of the square [m].
        y: The same.
        reach: Half its side [m].
    """
    left, bottom, resolution = lattice
    rows, columns = log_odds.shape
    first_row, end_row, first_column, end_column = cells_around(
        log_odds.shape, lattice, x, y, reach
    )
    points = np.empty(((end_row - first_row) * (end_column - first_column), 2))
    count = 0
    for i in range(first_row, end_row):
        for j in range(first_column, end_column):
            if log_odds[i, j] <= occupied_above:
                continue
            is_inside = 0 < i < rows - 1 and 0 < j < columns - 1
            is_inside = is_inside and log_odds[i - 1, j] > occupied_above
            is_inside = is_inside and log_odds[i + 1, j] > occupied_above
            is_inside = is_inside and log_odds[i, j - 1] > occupied_above
            if is_inside and log_odds[i, j + 1] > occupied_above:
                continue
            points[count, 0] = left + (j + 0.5) * resolution
            points[count, 1] = bottom + (i + 0.5) * resolution
            count += 1
    return points[:count]


@njit(cache=True)
def worth_minding(
    cells: NDArray[np.float64], points: NDArray[np.float64], apart: float
) -> NDArray[np.bool_]:
    """Which cells ``(n, 2)`` lie farther than ``apart`` [m] from every point ``(m, 2)``."""
    keep = np.ones(len(cells), dtype=np.bool_)
    for k in range(len(cells)):
        for i in range(len(points)):
            dx, dy = cells[k, 0] - points[i, 0], cells[k, 1] - points[i, 1]
            if dx * dx + dy * dy < apart * apart:
                keep[k] = False
                break
    return keep
