"""Ghosts are occupied cells on free floor, away from everything solid."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy import ndimage

from mapping.ghosts import FAR_FROM_SOLID, ghost_area
from mapping.grid import GridConfig, OccupancyGrid
from mapping.truth import TruthMap, truth_map

LEFT, BOTTOM = -1.5, -1.0


def room(resolution: float) -> TruthMap:
    """Walls 0.1 m thick round a floor of 3 x 2 m, and a room beside it that nobody sees."""
    rows, columns = round(2.2 / resolution), round(6.2 / resolution)
    y = (np.arange(rows) + 0.5) * resolution - 0.1
    x = (np.arange(columns) + 0.5) * resolution - 0.1
    solid = (y < 0.0) | (y > 2.0)
    walls = (x < 0.0) | ((x > 3.0) & (x < 3.1)) | (x > 6.0)
    return truth_map(
        solid[:, None] | walls[None],
        resolution=resolution,
        origin=(LEFT - 0.1, BOTTOM - 0.1),
        start=(0.0, 0.0),
    )


def map_with(*places: tuple[float, float], resolution: float = 0.05) -> OccupancyGrid:
    grid = OccupancyGrid(
        GridConfig(resolution=resolution, origin=(-3.0, -3.0), rows=200, columns=200)
    )
    for place in places:
        grid.log_odds[tuple(grid.world_to_cell(place))] = 5.0
    return grid


@pytest.mark.parametrize("resolution", [0.01, 0.05])
def test_a_leg_in_the_middle_of_the_floor_is_a_ghost_of_its_own_area(resolution: float) -> None:
    grid = map_with((0.02, 0.02), (0.42, 0.02))
    assert ghost_area(grid, room(resolution)) == pytest.approx(2 * 0.05**2)


def test_walls_and_what_is_drawn_a_little_off_them_are_none() -> None:
    off = FAR_FROM_SOLID - 0.03
    grid = map_with((LEFT - 0.02, 0.0), (LEFT + off, 0.3), (0.3, BOTTOM + off))
    assert ghost_area(grid, room(0.01)) == 0.0


def test_what_lies_out_of_sight_or_off_the_raster_is_none() -> None:
    assert ghost_area(map_with((3.0, 0.0), (-2.9, -2.9)), room(0.05)) == 0.0


def test_an_empty_map_has_no_ghosts() -> None:
    assert ghost_area(map_with(), room(0.05)) == 0.0


@given(seed=st.integers(0, 10_000), resolution=st.sampled_from([0.02, 0.05]))
@settings(max_examples=20, deadline=None)
def test_ghosts_are_those_that_a_distance_transform_of_the_whole_truth_finds(
    seed: int, resolution: float
) -> None:
    truth, grid = room(resolution), map_with(resolution=resolution)
    grid.log_odds[np.random.default_rng(seed).random(grid.shape) < 0.05] = 5.0
    away = (ndimage.distance_transform_edt(~truth.occupied) - 0.5) * resolution
    far = truth.visible_free & (away > FAR_FROM_SOLID)
    shift = np.round((np.array(truth.origin) - grid.origin) / resolution).astype(int)[::-1]
    rows, columns = np.argwhere(far).T + shift[:, None]
    on_map = (rows < grid.shape[0]) & (columns < grid.shape[1])
    drawn = grid.log_odds[rows[on_map], columns[on_map]] > 0.0
    assert ghost_area(grid, truth) == pytest.approx(drawn.sum() * resolution**2)
