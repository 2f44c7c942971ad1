import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mapping.slam.hit_field import HitField

PLACES = st.tuples(st.floats(-50.0, 50.0), st.floats(-50.0, 50.0))
WALL = np.column_stack(
    (np.full(41, 1.0), np.arange(-20, 21) * 0.05, np.ones(41), np.full(41, -1.0), np.zeros(41))
).astype(np.float32)
"""A straight wall a metre ahead, points a cell apart."""


@given(center=PLACES, place=PLACES, yaw=st.floats(-3.0, 3.0))
def test_metres_and_cells_are_inverses(
    center: tuple[float, float], place: tuple[float, float], yaw: float
) -> None:
    field = HitField(0.05, 1.0, 1.0)
    field.clear(center)
    pose = np.array([*place, yaw])
    assert field.to_metres(field.to_cells(pose)) == pytest.approx(pose, abs=1e-9)


@given(center=PLACES)
def test_the_middle_lies_where_it_was_laid_on_whole_cells(center: tuple[float, float]) -> None:
    field = HitField(0.05, 1.0, 1.0)
    field.clear(center)
    assert np.all(np.abs(field.center - center) <= 0.5 * 0.05 + 1e-9)
    assert np.allclose(field.corner / 0.05, np.round(field.corner / 0.05), atol=1e-6)


def test_a_wall_seen_by_one_scan_has_density_one() -> None:
    field = HitField(0.05, 2.0, 1.0)
    field.clear([0.0, 0.0])
    field.add([0.0, 0.0, 0.0], WALL)
    column, row, _ = field.to_cells([1.0 + 0.025, 0.025, 0.0])
    # a point between four cells: half a cell off the wall's line
    assert field.density[int(row), int(column), 2] == pytest.approx(np.exp(-0.125), rel=0.01)


def test_two_halves_of_a_walls_weight_are_the_wall() -> None:
    whole, halves = HitField(0.05, 2.0, 1.0), HitField(0.05, 2.0, 1.0)
    half = WALL * np.float32([1.0, 1.0, 0.5, 1.0, 1.0])
    whole.add([1.0, 1.0, 0.3], WALL)
    for _ in range(2):
        halves.add([1.0, 1.0, 0.3], half)
    assert np.allclose(whole.density, halves.density, atol=1e-5)


@given(poses=st.lists(st.tuples(*[st.floats(-4.0, 4.0)] * 3), min_size=1, max_size=4))
def test_a_cleared_field_is_empty(poses: list[tuple[float, float, float]]) -> None:
    field = HitField(0.05, 2.0, 1.0)
    for _ in range(2):
        field.clear([0.0, 0.0])
        assert not field.density.any()
        field.add([0.0, 0.0, 0.0], WALL)
        assert field.density.any()
        for pose in poses:
            field.add(pose, WALL)


def test_maxima_of_a_window_are_those_of_the_field_there() -> None:
    field = HitField(0.05, 2.0, 1.0)
    field.clear([0.0, 0.0])
    field.add([0.0, 0.0, 0.4], WALL)
    whole = field.maxima((0, 80, 0, 80), 4)
    part = field.maxima((30, 70, 45, 75), 4)
    assert whole.shape == (4, 80, 80)
    assert part.any()
    assert np.array_equal(part[0], whole[0, 30:70, 45:75])
    # the blocks at the upper and right edges hold only what lies in the window
    assert np.array_equal(part[3, :-7, :-7], whole[3, 30:63, 45:68])
    assert np.all(part[3] <= whole[3, 30:70, 45:75])
