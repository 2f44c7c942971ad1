"""The cells of returns and of the lines between them, against a plain walk along each line."""

import math

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from mapping.grid import UNKNOWN
from nav.returns_kernels import (
    STRAIGHT,
    SUPPORT,
    SUPPORT_BEAMS,
    cells_between,
    wall_in_unknown,
)
from tests.nav.grids import costmap_of, random_grid

GAP, STRAIGHT_GAP = 0.25, 0.6
LATTICE = (-2.0, -1.0, 0.05)
SHAPE = (60, 140)

Cells = set[tuple[int, int]]


def cell_of(point: NDArray[np.float64]) -> tuple[int, int]:
    left, bottom, edge = LATTICE
    return math.floor((point[1] - bottom) / edge), math.floor((point[0] - left) / edge)


def leads_on(
    at: dict[int, NDArray[np.float64]], count: int, near: int, far: int, step: int
) -> bool:
    """Whether the points before ``near`` lie on one line with it and ``far``, for long enough."""
    gap = math.dist(at[near], at[far])
    towards = (at[far] - at[near]) / gap
    for k in range(1, SUPPORT_BEAMS + 1):
        point = at.get((near + step * k) % count)
        if point is None:
            return False
        away = point - at[near]
        if abs(towards[0] * away[1] - towards[1] * away[0]) > STRAIGHT * gap:
            return False
        if -(towards @ away) >= SUPPORT * gap:
            return True
    return False


def plain_cells(points: NDArray[np.float64], beams: list[int], count: int) -> Cells:
    cells = {cell_of(point) for point in points}
    at = dict(zip(beams, points, strict=True))
    for beam, point in at.items():
        next_beam = (beam + 1) % count
        after = at.get(next_beam)
        if after is None or math.dist(point, after) > STRAIGHT_GAP:
            continue
        if math.dist(point, after) > GAP and not (
            leads_on(at, count, beam, next_beam, -1) or leads_on(at, count, next_beam, beam, 1)
        ):
            continue
        parts = max(1, math.ceil(2.0 * math.dist(point, after) / LATTICE[2]))
        cells |= {cell_of(point + k / parts * (after - point)) for k in range(parts)}
    return {
        (row, column) for row, column in cells if 0 <= row < SHAPE[0] and 0 <= column < SHAPE[1]
    }


def found_cells(points: NDArray[np.float64], beams: list[int], count: int) -> Cells:
    cells = cells_between(
        points, np.array(beams, dtype=np.int64), count, GAP, STRAIGHT_GAP, LATTICE, SHAPE
    )
    return {(int(row), int(column)) for row, column in cells}


@given(seed=st.integers(0, 10_000), kept=st.integers(0, 60))
@settings(max_examples=60)
def test_they_equal_those_of_a_plain_walk(seed: int, kept: int) -> None:
    """A closed wall round the lattice's corner: neighbours 5 to 60 cm apart, some beams gone, some
    points outside."""
    rng = np.random.default_rng(seed)
    beams = sorted(rng.choice(60, kept, replace=False).tolist())
    angles = 2.0 * np.pi * np.array(beams) / 60.0
    away = rng.uniform(0.5, 3.5) * rng.uniform(0.97, 1.03, kept)
    points = np.column_stack((away * np.cos(angles), away * np.sin(angles))).reshape(-1, 2)
    assert found_cells(points, beams, 60) == plain_cells(points, beams, 60)


@given(angle=st.floats(-math.pi, math.pi), length=st.floats(0.01, GAP - 1e-6))
def test_no_cell_of_a_line_is_jumped_over(angle: float, length: float) -> None:
    """From cell to cell it goes at most to a diagonal neighbour."""
    start = np.array([0.013, 0.027])
    end = start + length * np.array([math.cos(angle), math.sin(angle)])
    cells = cells_between(
        np.array([start, end]), np.array([4, 5]), 360, GAP, STRAIGHT_GAP, LATTICE, SHAPE
    )
    assert tuple(cells[0]) == cell_of(start)
    assert tuple(cells[-1]) == cell_of(end)
    assert np.abs(np.diff(cells, axis=0)).max() <= 1


def test_lines_join_neighbouring_beams_alone() -> None:
    points = np.array([[0.0, 0.0], [0.2, 0.0], [0.4, 0.0]])
    ends = {cell_of(point) for point in points}
    assert found_cells(points, [4, 6, 8], 360) == ends, "a beam between them failed or went on"
    joined = found_cells(points, [4, 5, 8], 360)
    assert joined > ends
    assert max(column for _, column in joined - ends) < cell_of(points[1])[1]


def test_the_last_beam_is_the_first_ones_neighbour() -> None:
    points = np.array([[0.0, 0.0], [0.2, 0.0]])
    assert len(found_cells(points, [0, 359], 360)) == 5
    assert len(found_cells(points, [0, 358], 360)) == 2


def test_of_no_or_one_return_there_is_no_line() -> None:
    assert found_cells(np.zeros((0, 2)), [], 360) == set()
    assert found_cells(np.zeros((1, 2)), [0], 1) == {cell_of(np.zeros(2))}


def wall_beside(side: float, beams: list[int]) -> NDArray[np.float64]:
    """Where beams at so many degrees meet a straight wall so far to the robot's left [m]."""
    return np.array([[side / math.tan(math.radians(beam)), side] for beam in beams])


def test_a_wall_seen_at_a_grazing_angle_is_joined_as_far_as_the_lidar_meets_it() -> None:
    beams = list(range(5, 12))
    points = wall_beside(0.3, beams)
    assert math.dist(points[0], points[1]) > 0.5, "more than neighbours may lie apart otherwise"
    columns = {column for _, column in found_cells(points, beams, 360)}
    assert columns == set(range(cell_of(points[-1])[1], cell_of(points[0])[1] + 1))


def test_a_corner_with_something_behind_it_is_not_joined_with_that() -> None:
    """The wall ends; the next beam meets another one 0.5 m behind and to the side."""
    beams = list(range(5, 12))
    points = wall_beside(0.3, beams)
    points[0] = points[1] + (0.35, 0.35)
    ends = {cell_of(points[0]), cell_of(points[1])}
    between = {cell_of(points[1] + share * (points[0] - points[1])) for share in (0.3, 0.5, 0.7)}
    assert not between & (found_cells(points, beams, 360) - ends)


def test_a_near_edge_is_not_joined_with_what_lies_far_behind_in_line() -> None:
    """Its points are close together: too short a piece of wall to tell a direction from."""
    points = np.array([[1.0, 0.3], [1.0, 0.28], [1.0, 0.26], [1.0, 0.24], [1.55, 0.24]])
    cells = found_cells(points, [4, 5, 6, 7, 8], 360)
    assert cell_of(np.array([1.3, 0.24])) not in cells


@given(seed=st.integers(0, 999))
@settings(max_examples=30, deadline=None)
def test_returns_are_wall_in_what_is_unknown_and_beside_it(seed: int) -> None:
    states = costmap_of(random_grid(seed)).states
    returned = np.random.default_rng(seed).random(states.shape) < 0.3
    unknown = np.pad(states == UNKNOWN, 1)
    beside = unknown[:-2, 1:-1] | unknown[2:, 1:-1] | unknown[1:-1, :-2] | unknown[1:-1, 2:]
    expected = np.argwhere(returned & (unknown[1:-1, 1:-1] | beside))
    assert np.array_equal(wall_in_unknown(states, returned), expected)
