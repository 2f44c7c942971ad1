"""Ghosts are occupied cells on free floor, away from everything solid."""

import numpy as np
import pytest

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
