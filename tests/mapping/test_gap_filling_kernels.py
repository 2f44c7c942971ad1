"""The kernels of gap filling beside slow and plain references."""

import math
from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray
from scipy import ndimage

from mapping.gap_filling_hole_kernels import (
    all_unknown,
    has_empty_circle,
    narrow_holes,
    steps_of_wall,
)
from mapping.gap_filling_kernels import cells_between, draw_lines, gaps_along_rows, near_lines
from mapping.gap_filling_passage_kernels import closing_lines
from mapping.gap_filling_passages import floor_of, that_close_nothing
from mapping.gap_filling_wall_kernels import corners, extended, wall_ends
from mapping.grid import FREE, OCCUPIED, UNKNOWN

Mask = NDArray[np.bool_]
States = NDArray[np.int8]
coordinates = st.integers(-12, 12)


def random_mask(seed: int, share: float, shape: tuple[int, int] = (24, 31)) -> Mask:
    return np.asarray(np.random.default_rng(seed).random(shape) < share)


def random_states(seed: int, shape: tuple[int, int] = (24, 31)) -> States:
    rng = np.random.default_rng(seed)
    return rng.choice(np.array([UNKNOWN, FREE, OCCUPIED], np.int8), shape, p=[0.8, 0.05, 0.15])


def reference_between(line: tuple[int, int, int, int]) -> set[tuple[int, int]]:
    """By exact fractions: at every step, the cells whose centre is nearest to the line."""
    row, column, last_row, last_column = line
    steps = max(abs(last_row - row), abs(last_column - column))
    cells = set()
    for step in range(1, steps):
        y = row + Fraction((last_row - row) * step, steps)
        x = column + Fraction((last_column - column) * step, steps)
        for a in {math.floor(y), math.ceil(y)}:
            for b in {math.floor(x), math.ceil(x)}:
                if abs(a - y) <= Fraction(1, 2) and abs(b - x) <= Fraction(1, 2):
                    cells.add((a, b))
    return cells


@given(line=st.tuples(coordinates, coordinates, coordinates, coordinates))
@settings(max_examples=200, deadline=None)
def test_the_cells_between_are_those_nearest_to_the_line(line: tuple[int, int, int, int]) -> None:
    found = [(int(row), int(column)) for row, column in cells_between(np.array(line))]
    assert len(found) == len(set(found))
    assert set(found) == reference_between(line)


@given(seed=st.integers(0, 999), share=st.sampled_from([0.02, 0.1, 0.4]))
@settings(max_examples=30, deadline=None)
def test_near_lines_are_those_of_the_thesis_four_quadrants(seed: int, share: float) -> None:
    occupied = random_mask(seed, share)
    rows, columns = occupied.shape
    lines = set()
    for i, j in np.argwhere(occupied).tolist():
        for down in (-1, 1):
            for on in (-1, 1):
                for n in range(1, 6):
                    for m in range(1, 6):
                        a, b = i + down * n, j + on * m
                        if not (0 <= a < rows and 0 <= b < columns) or not occupied[a, b]:
                            continue
                        if not occupied[a - down, b - on]:
                            lines.add((i, j, a, b))
    assert {tuple(line) for line in near_lines(occupied, 5).tolist()} == lines


@given(seed=st.integers(0, 999), share=st.sampled_from([0.02, 0.1, 0.4]))
@settings(max_examples=30, deadline=None)
def test_gaps_along_rows_draw_what_the_thesis_loops_draw(seed: int, share: float) -> None:
    occupied = random_mask(seed, share)
    drawn = np.zeros_like(occupied)
    for i, j in np.argwhere(occupied).tolist():
        for n in range(1, 11):
            if j + n < occupied.shape[1] and occupied[i, j + n] and not occupied[i, j + 1]:
                drawn[i, j + 1 : j + n] = True
            if j - n >= 0 and occupied[i, j - n] and not occupied[i, j - 1]:
                drawn[i, j - n + 1 : j] = True
    found = np.zeros_like(occupied)
    draw_lines(gaps_along_rows(occupied, 10), found)
    assert np.array_equal(found & ~occupied, drawn & ~occupied)


@given(seed=st.integers(0, 9999), line=st.tuples(*[st.integers(1, 22)] * 4))
@settings(max_examples=200, deadline=None)
def test_questions_about_a_line_are_answered_as_by_looking_at_every_cell(
    seed: int, line: tuple[int, int, int, int]
) -> None:
    states = random_states(seed)
    row, column, other, aside = line
    between = reference_between(line)
    assert all_unknown(states, *line) == all(states[cell] == UNKNOWN for cell in between)
    if (row, column) == (other, aside):
        return
    ends = np.array([[row, column], [other, aside]])
    rest = np.array([c for c in np.argwhere(states == OCCUPIED) if not (ends == c).all(1).any()])
    angles = np.einsum("ij,ij->i", ends[0] - rest, ends[1] - rest) if len(rest) else np.ones(1)
    assert has_empty_circle(states, np.array(line)) == bool(np.all(angles > 0))
    direction = np.array([other - row, aside - column])
    offsets = np.argwhere(states == OCCUPIED) - ends[0]
    along = offsets @ direction / np.hypot(*direction)
    across = (offsets[:, 0] * direction[1] - offsets[:, 1] * direction[0]) / np.hypot(*direction)
    near = (along > -1e-9) & (along < 8.0 - 1e-9) & (np.abs(across) <= 1.5 + 1e-9)
    steps = len(np.unique(np.floor(along[near] + 1e-9)))
    assert steps_of_wall(states, row, column, *direction.tolist(), 8, 1.5) == steps


@given(seed=st.integers(0, 9999))
@settings(max_examples=30, deadline=None)
def test_narrow_holes_are_found_as_by_trying_every_pair(seed: int) -> None:
    states = random_states(seed, (16, 18))
    cells = np.argwhere(states == OCCUPIED).tolist()
    lines = set()
    for k, (row, column) in enumerate(cells):
        for other, aside in cells[k + 1 :]:
            line = (row, column, other, aside)
            rise, run = other - row, aside - column
            if np.hypot(rise, run) > 6.0 or max(abs(rise), abs(run)) < 2:
                continue
            goes_on = False
            for lean in range(-2, 3):
                turn = lean / (2 * max(abs(rise), abs(run)))
                down, across = rise + turn * run, run - turn * rise
                back = steps_of_wall(states, row, column, -down, -across, 5, 1.0)
                on = steps_of_wall(states, other, aside, down, across, 5, 1.0)
                goes_on |= min(back, on) >= 2
            unseen = all(states[cell] == UNKNOWN for cell in reference_between(line))
            if unseen and goes_on and has_empty_circle(states, np.array(line)):
                lines.add(line)
    assert {tuple(line) for line in narrow_holes(states, 6, 5, 1.0, 2).tolist()} == lines


@pytest.mark.parametrize("seed", range(5))
def test_ends_of_walls_are_found_as_by_eigenvectors(seed: int) -> None:
    states = np.full((60, 60), UNKNOWN, dtype=np.int8)
    rng = np.random.default_rng(seed)
    angle = rng.uniform(0.0, np.pi)
    way = np.array([np.sin(angle), np.cos(angle)]) * np.linspace(0.0, 24.0, 60)[:, np.newaxis]
    cells = np.rint(30.0 + way + rng.normal(0.0, 0.5, way.shape)).astype(int)
    states[cells[:, 0], cells[:, 1]] = OCCUPIED
    occupied = np.argwhere(states == OCCUPIED)
    expected = {}
    for cell in occupied:
        near = occupied[np.hypot(*(occupied - cell).T) <= 15.0] - cell
        spread, axes = np.linalg.eigh(np.cov(near.T, bias=True))
        behind = near.mean(axis=0)
        direction = axes[:, 1] if behind @ axes[:, 1] < 0.0 else -axes[:, 1]
        if np.hypot(*behind) >= 0.3 * 15.0 and spread[0] <= 1.5**2:
            expected[tuple(cell.tolist())] = direction
    ends = wall_ends(states, 15, 0.3, 1.5, 10)
    assert len(ends) > 0
    for row, column, rise, run in ends:
        assert expected.pop((int(row), int(column))) == pytest.approx([rise, run], abs=1e-9)
    for row, column in expected:  # left out for want of a wall behind them
        back = -expected[row, column]
        assert steps_of_wall(states, row, column, *back.tolist(), 15, 3.0) < 10


def test_an_end_is_drawn_out_to_the_first_occupied_cell_unless_a_free_one_comes_before() -> None:
    states = np.full((3, 30), UNKNOWN, dtype=np.int8)
    states[:, 20] = OCCUPIED
    states[2, 15] = FREE
    ends = np.array([[0.0, 5.0, 0.0, 1.0], [2.0, 5.0, 0.0, 1.0], [1.0, 25.0, 0.0, 1.0]])
    lines, room = extended(states, ends, 30, 30)
    assert lines.tolist() == [[0, 5, 0, 20]]
    assert room.tolist() == [0, 9, 4]


def test_a_corner_is_where_two_ends_that_are_drawn_out_meet() -> None:
    states = np.full((40, 40), UNKNOWN, dtype=np.int8)
    ends = np.array([[5.0, 10.0, 0.0, 1.0], [25.0, 30.0, -1.0, 0.0], [25.0, 20.0, 1.0, 0.0]])
    lines = corners(states, ends, np.array([25, 25, 10]), 0.7)
    assert sorted(lines.tolist()) == [[5, 10, 5, 30], [25, 30, 5, 30]]
    assert len(corners(states, ends, np.array([15, 25, 10]), 0.7)) == 0, "the first ends before"
    states[15, 30] = FREE
    assert len(corners(states, ends, np.array([25, 25, 10]), 0.7)) == 0, "beams passed there"


@given(seed=st.integers(0, 9999), line=st.tuples(*[st.integers(4, 26)] * 4))
@settings(max_examples=100, deadline=None)
def test_a_line_closes_a_passage_if_labels_of_the_floor_say_so(
    seed: int, line: tuple[int, int, int, int]
) -> None:
    radius, depth = 1.5, 6.0
    occupied = random_mask(seed, 0.02, (31, 31))
    fits = np.asarray(ndimage.distance_transform_edt(~occupied)) > 2.0
    places = fits & random_mask(seed + 1, 0.5, (31, 31))
    between = reference_between(line)
    rows, columns = np.indices(fits.shape)
    rise, run = line[2] - line[0], line[3] - line[1]
    length = max(np.hypot(rise, run), 1e-9)
    along = ((rows - line[0]) * rise + (columns - line[1]) * run) / length
    aside = np.abs((rows - line[0]) * run - (columns - line[1]) * rise) / length
    near = (along > -1e-9) & (along < length + 1e-9) & (aside <= depth + 1e-9)
    before = fits & near
    after = before.copy()
    for row, column in between:
        down, across = np.abs(rows - row) - 0.5, np.abs(columns - column) - 0.5
        after &= np.hypot(np.maximum(down, 0.0), np.maximum(across, 0.0)) >= radius
    old, new = ndimage.label(before)[0], ndimage.label(after)[0]
    pairs = np.unique(np.stack((old, new))[:, after & places], axis=1)
    closes = len(pairs[0]) > len(np.unique(pairs[0])) and any(fits[cell] for cell in between)
    assert closing_lines(np.array([line]), fits, places, radius, depth).tolist() == [closes]


def test_lines_that_part_places_only_together_are_dropped_together() -> None:
    states = np.full((120, 160), FREE, dtype=np.int8)
    states[[0, -1]] = states[:, [0, -1]] = OCCUPIED
    states[58:62, :40] = states[58:62, -40:] = OCCUPIED
    floor = floor_of(states, 0.01)
    halves = np.array([[60, 39, 60, 80], [60, 120, 60, 80]])
    for half in halves:
        assert len(that_close_nothing(half[np.newaxis], floor)) in (0, 1)
    kept = that_close_nothing(halves, floor)
    drawn = floor.occupied.copy()
    draw_lines(kept, drawn)
    labels, _ = ndimage.label(np.asarray(ndimage.distance_transform_edt(~drawn)) >= 9.4)
    assert labels[30, 80] == labels[90, 80] != 0
