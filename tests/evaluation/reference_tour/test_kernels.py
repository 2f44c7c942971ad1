"""The kernels against plain references: dense sampling, scipy's search, lists of cells."""

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from numpy.typing import NDArray
from scipy.sparse import coo_array
from scipy.sparse.csgraph import dijkstra

from evaluation.reference_tour.view_kernels import count_views, see_blocks, unseen_weight
from evaluation.reference_tour.way_kernels import (
    NEIGHBOURS,
    is_clear,
    link_blocks,
    pull_taut,
    spread,
    stand_points,
    walk_back,
)

Mask = NDArray[np.bool_]

SIDE, ROWS, COLUMNS = 3, 12, 14
WIDTH = SIDE * COLUMNS
INSIDE = (SIDE * (ROWS - 4), SIDE * (COLUMNS - 4))

FLOORS = arrays(np.bool_, INSIDE, elements=st.sampled_from([True] * 12 + [False]))
"""Open cells within the frame of two blocks."""


def framed(inside: Mask) -> Mask:
    return np.pad(inside, 2 * SIDE).ravel()


def marked(runs: NDArray[np.int32]) -> Mask:
    blocks = np.zeros(ROWS * COLUMNS, dtype=np.bool_)
    for first, end in runs:
        blocks[first:end] = True
    return blocks


def crossed(a: int, b: int) -> set[int]:
    """Cells that the line between two cells' centres crosses or touches, by clipping each."""
    ay, ax, by, bx = a // WIDTH, a % WIDTH, b // WIDTH, b % WIDTH
    cells = set()
    for y in range(min(ay, by), max(ay, by) + 1):
        for x in range(min(ax, bx), max(ax, bx) + 1):
            beside = 2 * abs((y - ay) * (bx - ax) - (x - ax) * (by - ay))
            if beside <= abs(bx - ax) + abs(by - ay):
                cells.add(y * WIDTH + x)
    return cells


@given(inside=FLOORS, ends=st.tuples(*[st.integers(0, INSIDE[k % 2] - 1) for k in range(4)]))
def test_a_line_is_clear_when_every_cell_that_it_touches_is(
    inside: Mask, ends: tuple[int, int, int, int]
) -> None:
    cells = framed(inside)
    a, b = ((ends[k] + 2 * SIDE) * WIDTH + ends[k + 1] + 2 * SIDE for k in (0, 2))
    cells[a] = True
    assert is_clear(cells, WIDTH, a, b) == all(cells[cell] for cell in crossed(a, b))


@given(inside=FLOORS)
@settings(max_examples=5)
def test_ways_are_the_shortest_over_clear_links_as_scipy_finds_them(inside: Mask) -> None:
    inside[10:14, 4:20] = True  # so that there is somewhere to go
    cells = framed(inside)
    points = stand_points(cells, WIDTH, SIDE)
    links = link_blocks(points, cells, WIDTH, SIDE)
    standing = np.flatnonzero(points >= 0)
    sources, targets, steps = [], [], []
    for block in standing.tolist():
        row, column = divmod(int(points[block]), WIDTH)
        assert (row // SIDE) * COLUMNS + column // SIDE == block
        for k, (down, right) in enumerate(NEIGHBOURS.tolist()):
            other = block + down * COLUMNS + right
            clear = points[other] >= 0 and all(
                cells[cell] for cell in crossed(int(points[block]), int(points[other]))
            )
            assert bool(links[block] >> k & 1) == bool(links[other] >> (k + 8) & 1) == clear
            if clear:
                sources.append(block)
                targets.append(other)
                steps.append(np.hypot(points[other] // WIDTH - row, points[other] % WIDTH - column))
    graph = coo_array((steps, (sources, targets)), shape=(len(points), len(points))).tocsr()
    start = int(standing[0])
    expected = dijkstra(graph, directed=False, indices=start)
    lengths, before = spread(links, points, WIDTH, SIDE, start, -1, np.inf)
    assert lengths == pytest.approx(expected, rel=1e-5)
    target = int(standing[np.argmax(np.where(np.isfinite(expected), expected, -1.0)[standing])])
    early, _ = spread(links, points, WIDTH, SIDE, start, target, np.inf)
    assert early[target] == lengths[target]
    way = walk_back(before, points, target)
    taut = pull_taut(way, cells, WIDTH)
    assert taut[0] == points[start]
    assert taut[-1] == points[target]
    assert length_of(way) == pytest.approx(float(lengths[target]), rel=1e-5)
    assert length_of(taut) <= length_of(way) + 1e-9
    assert all(is_clear(cells, WIDTH, a, b) for a, b in pairwise(taut))


def length_of(way: NDArray[np.int64]) -> float:
    return float(np.hypot(np.diff(way // WIDTH), np.diff(way % WIDTH)).sum())


@given(inside=FLOORS, reach=st.floats(4.0, 12.0))
@settings(max_examples=5)
def test_blocks_seen_are_those_whose_middle_a_finely_sampled_beam_meets(
    inside: Mask, reach: float
) -> None:
    inside[10:14, 10:14] = True
    cells = framed(inside)
    blocked = ~cells
    free = ~blocked.reshape(ROWS, SIDE, COLUMNS, SIDE).any(axis=(1, 3)).ravel()
    cell = (12 + 2 * SIDE) * WIDTH + 12 + 2 * SIDE
    beams = 40
    fast = marked(see_blocks(blocked, free, WIDTH, SIDE, cell, reach, beams))
    sure, perhaps = sampled_view(blocked, cell, reach, beams)
    assert not (sure & ~fast).any()
    assert not (fast & ~perhaps).any()


def sampled_view(blocked: Mask, cell: int, reach: float, beams: int) -> tuple[Mask, Mask]:
    """Blocks that are surely seen, and those that may be when a beam grazes a cell or a middle."""
    gap, graze = 0.02, 0.03
    sure, perhaps = np.zeros((2, ROWS * COLUMNS), dtype=np.bool_)
    y0, x0 = cell // WIDTH + 0.5, cell % WIDTH + 0.5
    own = int(y0) // SIDE * COLUMNS + int(x0) // SIDE
    sure[own] = perhaps[own] = True
    for beam in range(beams):
        angle = 2.0 * np.pi * beam / beams
        for margin, seen in ((graze, sure), (-graze, perhaps)):
            for way in np.arange(0.0, reach + gap - margin, gap):
                y, x = y0 + way * np.sin(angle), x0 + way * np.cos(angle)
                around = [(y + i * margin, x + j * margin) for i in (-1, 0, 1) for j in (-1, 0, 1)]
                stops = [blocked[int(v) * WIDTH + int(u)] for v, u in around]
                if any(stops) if margin > 0.0 else all(stops):
                    break
                beside = [abs(each % SIDE - 0.5 * SIDE) for each in (y, x)]
                # The beam must pass the point of it that lies nearest to the block's centre.
                if max(beside) <= 0.25 * SIDE - margin:
                    block = int(y) // SIDE * COLUMNS + int(x) // SIDE
                    centre = (int(y) // SIDE + 0.5) * SIDE, (int(x) // SIDE + 0.5) * SIDE
                    nearest = (centre[0] - y0) * np.sin(angle) + (centre[1] - x0) * np.cos(angle)
                    if way >= nearest + (margin if margin > 0.0 else -SIDE):
                        seen[block] = True
    return sure, perhaps


@given(
    views=st.lists(st.lists(st.integers(0, 29), max_size=8), max_size=5),
    weights=arrays(np.int32, 30, elements=st.integers(0, 3)),
)
def test_what_is_seen_is_the_weight_of_the_union_of_the_views(
    views: list[list[int]], weights: NDArray[np.int32]
) -> None:
    counts = np.zeros(30, dtype=np.int32)
    seen: set[int] = set()
    for view in views:
        runs = np.array([(block, block + 1) for block in sorted(set(view))], dtype=np.int32)
        runs = runs.reshape(-1, 2)
        new = sum(int(weights[block]) for block in set(view) - seen)
        assert unseen_weight(runs, weights, counts) == new
        assert count_views(runs, weights, counts, 1) == new
        seen |= set(view)
    for k, view in enumerate(views):
        runs = np.array([(block, block + 1) for block in sorted(set(view))], dtype=np.int32)
        runs = runs.reshape(-1, 2)
        left = set().union(*views[k + 1 :])
        gone = sum(int(weights[block]) for block in set(view) - left)
        assert count_views(runs, weights, counts, -1) == gone
    assert not counts.any()
