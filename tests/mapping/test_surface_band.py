import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from mapping.grid import OCCUPIED, UNKNOWN, GridConfig, OccupancyGrid
from mapping.surface_band import TILE, band_along


def grid_with(rng: np.random.Generator, rows: int, columns: int) -> OccupancyGrid:
    """A few cells of each state, scattered over unknown ones."""
    grid = OccupancyGrid(GridConfig(resolution=0.01, rows=rows, columns=columns))
    for value in (-5.0, -1.0, 1.0, 5.0):
        cells = rng.integers(0, (rows, columns), (6, 2))
        grid.log_odds[cells[:, 0], cells[:, 1]] = value
    return grid


@settings(max_examples=40, deadline=None)
@given(st.integers(0, 2**32 - 1), st.integers(0, 4), st.integers(3, 90), st.integers(3, 90))
def test_the_band_holds_what_is_near_walls_or_undecided_and_nothing_twice(
    seed: int, width: int, rows: int, columns: int
) -> None:
    grid = grid_with(np.random.default_rng(seed), rows, columns)
    states = grid.states()
    wanted = {
        (row, column)
        for row, column in np.ndindex(rows, columns)
        if (states[row, column] == UNKNOWN and grid.log_odds[row, column] != 0.0)
        or np.any(
            states[
                max(row - width, 0) : row + width + 1, max(column - width, 0) : column + width + 1
            ]
            == OCCUPIED
        )
    }
    band = band_along(grid, width)
    assert len(band) == len(wanted)
    assert {(int(row), int(column)) for row, column in band.cells} == wanted
    assert not band.sums.any()


def test_a_tiles_cells_are_found_where_they_begin() -> None:
    grid = grid_with(np.random.default_rng(1), 100, 130)
    band = band_along(grid, 3)
    assert band.tile_shape == (4, 5)
    assert band.starts[0] == 0
    assert band.starts[-1] == len(band)
    for tile in range(20):
        cells = band.cells[band.starts[tile] : band.starts[tile + 1]]
        assert np.all(cells[:, 0] // TILE == tile // 5)
        assert np.all(cells[:, 1] // TILE == tile % 5)


def test_a_map_that_knows_nothing_has_no_band() -> None:
    assert len(band_along(OccupancyGrid(GridConfig(rows=50, columns=40)), 3)) == 0
