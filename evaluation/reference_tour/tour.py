"""Turns the truth of a floor plan into a fast tour of it, as one who knows the plan would drive.

How long exploring a place takes says little before one knows how long it must take. The reference
is a robot that knows the plan, needs no map and no turns, and always drives at full speed:

1. Set cover: beginning with what the start sees, add the viewpoint that sees the most floor not
   seen yet, until the share is seen (greedy; Johnson 1974). Viewpoints are about LATTICE apart.
2. Tour: order the viewpoints by nearest neighbour, 2-opt and or-opt; the tour ends anywhere.
3. Only with ``sees_while_driving``: leave out the viewpoint that saves the longest way, as long as
   the rest of the tour still sees the share on its way, and order the others anew, until none can
   be left out.
4. Only with it: end the tour when the share is seen.

All of this is tried with a few shifted lattices; the shortest tour counts.

No step proves the tour the shortest there is: it is a good one, found the same way for every plan.
Floor is counted in a regular sample of the truth's cells, one in each block of 5 cm, and looked at
every 0.25 m: counted in all cells, a tour
of step 4 sees the share to within a per cent.
"""

import heapq
from collections.abc import Callable
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.sparse.csgraph import shortest_path

from evaluation.reference_tour.floor_graph import FloorGraph, floor_graph
from evaluation.reference_tour.open_tour import improved, nearest_neighbours
from evaluation.reference_tour.seen_floor import Runs, SeenFloor
from mapping.burger import MAX_LINEAR_SPEED
from mapping.errors import TestbedError
from mapping.truth import TruthMap

LATTICE = 0.5
"""Distance between places that may become viewpoints [m]."""

SHIFTS = ((0.0, 0.0), (0.5, 0.5), (0.5, 0.0), (0.0, 0.5))
"""By how many squares the lattice is shifted, up and right, in one try after another."""

ENOUGH_TRIED = 40
"""No other try follows when all tries together had so many viewpoints: large plans take long, and
luck evens out in them."""

NEAR = 8.0
"""Ways up to this length [m] are searched, longer ones put together of them."""


@dataclass(frozen=True, slots=True, kw_only=True)
class ReferenceTour:
    """A tour that sees the share of the floor, or all that it can of it."""

    viewpoints: NDArray[np.float64]
    """Where it must pass ``(n, 2)`` [m]: the start, then the chosen places in order."""
    path: NDArray[np.float64]
    """Its corners ``(m, 2)`` [m]; a single point when the start sees enough."""
    length_m: float
    """Length of the path [m]."""
    time_s: float
    """How long that takes at full speed [s]."""
    coverage: float
    """Share of the floor that is seen at its end."""
    sees_share: bool
    """Whether that is the share asked for; no viewpoints may show so much."""


def reference_tour(
    truth: TruthMap, start: ArrayLike, share: float = 0.95, *, sees_while_driving: bool = False
) -> ReferenceTour:
    """How a robot that knows the floor plan sees a share of its floor.

    The floor is the truth's ``visible_free``, seen by a lidar of 360 degrees within its range.

    Args:
        truth: The place.
        start: The robot's first position x, y [m]; more entries, as a yaw, are ignored.
        share: Share 0..1 of the floor to be seen.
        sees_while_driving: Whether it also sees between viewpoints, steps 3 and 4; else it drives
            to all of them, and what it sees on the way does not count.

    Raises:
        TestbedError: The robot cannot be at the start, or the share is none.
    """
    if not 0.0 < share <= 1.0:
        raise TestbedError(f"share: {share}; must be above 0, at most 1")
    floor = floor_graph(truth)
    first = floor.block_at(start)
    reached = np.flatnonzero(np.isfinite(floor.lengths_from(first)))
    tours: list[ReferenceTour] = []
    tried = 0
    for shift in SHIFTS:
        places = _lattice(floor, reached, shift)
        viewpoints, seen = _set_cover(floor, first, places, share)
        lengths = _lengths(floor, viewpoints)
        order = improved(nearest_neighbours(viewpoints, lengths), lengths)
        if sees_while_driving:
            order = _without_redundant(floor, order, lengths, share)
            tours.append(_until_seen(floor, order, share))
        else:
            ways = [floor.leg(a, b).points for a, b in pairwise(order)]
            tours.append(_driven(floor, order, ways, seen))
        tried += len(viewpoints)
        if tried >= ENOUGH_TRIED:
            break
    return min(tours, key=lambda each: (not each.sees_share, each.length_m))


def _set_cover(
    floor: FloorGraph, first: int, places: list[int], share: float
) -> tuple[list[int], SeenFloor]:
    """The start and the viewpoints that are added until enough is seen, and what they see.

    A gain never grows when others are added, so only the best of the old gains is reckoned anew
    until it stays the best (lazy evaluation; Minoux 1978).
    """
    chosen, seen = [first], SeenFloor(floor, share)
    seen.add(floor.view(first))
    if seen.enough:
        return chosen, seen
    heap = [(-seen.gain(floor.view(block)), block) for block in places]
    heapq.heapify(heap)
    while heap and not seen.enough:
        _, block = heapq.heappop(heap)
        entry = (-seen.gain(floor.view(block)), block)
        if heap and entry > heap[0]:
            heapq.heappush(heap, entry)
        elif entry[0] < 0:
            seen.add(floor.view(block))
            chosen.append(block)
    return chosen, seen


def _lattice(floor: FloorGraph, blocks: NDArray[np.int64], shift: tuple[float, float]) -> list[int]:
    """Of each square of LATTICE that of some blocks which is nearest to its middle.

    The squares lie round the middle of the floor, so that the same plan drawn elsewhere, or turned
    by a right angle, has the same viewpoints.
    """
    step = max(1, round(LATTICE / floor.resolution))
    height = len(floor.reachable) // floor.width
    cells = np.divmod(floor.points[blocks], floor.width)
    squares, away = np.zeros((2, len(blocks)), dtype=np.int64), np.zeros(len(blocks))
    for axis, (lines, size) in enumerate(zip(cells, (height, floor.width), strict=True)):
        from_middle = 2 * lines.astype(np.int64) - (size - 1)  # in half cells
        from_middle += round(2 * step * shift[axis])
        squares[axis] = from_middle // (2 * step)
        away += (from_middle - (2 * squares[axis] + 1) * step) ** 2
    order = np.lexsort((blocks, away, *squares))
    _, nearest = np.unique(squares[:, order], axis=1, return_index=True)
    return [int(block) for block in blocks[order][nearest]]


def _lengths(floor: FloorGraph, blocks: list[int]) -> dict[tuple[int, int], float]:
    """Length of the way between each two of some blocks [m]."""
    near = NEAR
    while True:
        rows = np.array([floor.lengths_from(block, near)[blocks] for block in blocks])
        table = shortest_path(np.where(np.isfinite(rows), rows, 0.0), directed=False)
        if np.isfinite(table).all():
            break
        near *= 2.0
    pairs = np.ndindex(table.shape)
    return {(blocks[i], blocks[j]): float(table[i, j]) for i, j in pairs}


def _without_redundant(
    floor: FloorGraph, tour: list[int], lengths: dict[tuple[int, int], float], share: float
) -> list[int]:
    """Leave out viewpoints, the one that saves most first, while the way still sees enough.

    One that was refused is not tried again between the same two: the tour sees ever less.
    """
    seen = SeenFloor(floor, share)
    seen.add(floor.view(tour[0]))
    _count(floor, tour, seen.add)
    refused: set[tuple[int, ...]] = set()
    while True:
        for _, place in sorted((-_saving(tour, k, lengths), k) for k in range(1, len(tour))):
            around = tour[place - 1 : place + 2]
            if tuple(around) in refused:
                continue
            _exchange(floor, around, around[:1] + around[2:], seen)
            if seen.enough:
                tour = _order_anew(floor, tour[:place] + tour[place + 1 :], lengths, seen)
                break
            _exchange(floor, around[:1] + around[2:], around, seen)
            refused.add(tuple(around))
        else:
            return tour


def _saving(tour: list[int], place: int, lengths: dict[tuple[int, int], float]) -> float:
    """Length of way saved when a tour leaves out one of its places [m]."""
    around = tour[place - 1 : place + 2]
    shorter = around[:1] + around[2:]
    return sum(lengths[leg] for leg in pairwise(around)) - sum(
        lengths[leg] for leg in pairwise(shorter)
    )


def _order_anew(
    floor: FloorGraph, tour: list[int], lengths: dict[tuple[int, int], float], seen: SeenFloor
) -> list[int]:
    """A shorter order of a tour's places if there is one that still sees enough."""
    other = improved(tour, lengths)
    if other == tour:
        return tour
    _exchange(floor, tour, other, seen)
    if seen.enough:
        return other
    _exchange(floor, other, tour, seen)
    return tour


def _exchange(floor: FloorGraph, old: list[int], new: list[int], seen: SeenFloor) -> None:
    """Count what is seen on the ways of a new tour in place of an old one's."""
    _count(floor, old, seen.remove)
    _count(floor, new, seen.add)


def _count(floor: FloorGraph, tour: list[int], count: Callable[[Runs], None]) -> None:
    for a, b in pairwise(tour):
        count(floor.leg(a, b).runs)


def _until_seen(floor: FloorGraph, tour: list[int], share: float) -> ReferenceTour:
    """The tour up to where the share is seen."""
    seen = SeenFloor(floor, share)
    seen.add(floor.view(tour[0]))
    passed, driven = tour[:1], []
    for a, b in pairwise(tour):
        if seen.enough:
            break
        leg, stop = floor.leg(a, b), 0
        while stop < len(leg.stops) and not seen.enough:
            seen.add(floor.view(leg.blocks[stop]))
            stop += 1
        driven.append(leg.until(float(leg.stops[stop - 1])))
        passed = [*passed, b] if stop == len(leg.stops) else passed
    return _driven(floor, passed, driven, seen)


def _driven(
    floor: FloorGraph, passed: list[int], ways: list[NDArray[np.float64]], seen: SeenFloor
) -> ReferenceTour:
    """The tour that passes some viewpoints on ways from each to the next."""
    first = floor.position(passed[0])[np.newaxis]
    path = np.concatenate([first, *(way[1:] for way in ways)])
    length = float(np.hypot(*np.diff(path, axis=0).T).sum())
    return ReferenceTour(
        viewpoints=np.array([floor.position(block) for block in passed]),
        path=path,
        length_m=length,
        time_s=length / MAX_LINEAR_SPEED,
        coverage=seen.coverage,
        sees_share=seen.enough,
    )
