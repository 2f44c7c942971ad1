"""The manoeuvre's search for a way, pose by pose."""

import heapq

import numpy as np
from numba import njit
from numpy.typing import NDArray

from nav.gap_kernels import gaps_at
from nav.outline import Rectangle

NO_MOVE, FORWARD, BACKWARD, LEFT, RIGHT = -1, 0, 1, 2, 3
"""The kinds of moves."""

SQRT2 = 2.0**0.5
"""Cells are so many times smaller than a straight step, so that it always leaves its cell."""

ROUNDING = 1e-6
"""So much nearer is no nearer [m]: driving along a straight wall keeps the distance."""


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
