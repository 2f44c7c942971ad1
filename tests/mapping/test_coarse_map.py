"""Coarse maps of fine grids."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

from mapping.coarse_map import coarse_map
from mapping.grid import FREE, OCCUPIED, UNKNOWN, GridConfig, OccupancyGrid


def grid_of(states: NDArray[np.int8], resolution: float = 0.01) -> OccupancyGrid:
    rows, columns = states.shape
    grid = OccupancyGrid(
        GridConfig(resolution=resolution, origin=(-1.0, 2.0), rows=rows, columns=columns)
    )
    grid.log_odds[states == FREE] = -5.0
    grid.log_odds[states == OCCUPIED] = 5.0
    return grid


@given(st.integers(0, 2**32), st.integers(1, 40), st.integers(1, 40), st.integers(1, 7))
def test_each_coarse_cell_tells_what_a_plain_search_of_its_cells_tells(
    seed: int, rows: int, columns: int, cells: int
) -> None:
    states = np.random.default_rng(seed).choice(
        np.array([UNKNOWN, FREE, OCCUPIED], dtype=np.int8), (rows, columns), p=[0.9, 0.07, 0.03]
    )
    coarse = coarse_map(grid_of(states), 0.01 * cells)
    assert coarse.resolution == pytest.approx(0.01 * cells)
    first_column, first_row = np.round(
        (np.array(coarse.origin) - (-1.0, 2.0)) / coarse.resolution
    ).astype(int)
    seen = 0
    for row, column in np.ndindex(coarse.states.shape):
        top, left = (first_row + row) * cells, (first_column + column) * cells
        block = states[top : top + cells, left : left + cells]
        seen += np.count_nonzero(block != UNKNOWN)
        # OCCUPIED > FREE > UNKNOWN as numbers, and as what a block is called
        assert coarse.states[row, column] == block.max()
    assert seen == np.count_nonzero(states != UNKNOWN), "nothing known is left out"


def test_a_map_of_nothing_is_one_unknown_cell() -> None:
    coarse = coarse_map(grid_of(np.full((9, 7), UNKNOWN, dtype=np.int8)), 0.05)
    assert coarse.states.tolist() == [[UNKNOWN]]


def test_a_grid_that_is_coarser_stays_as_it_is() -> None:
    states = np.full((3, 4), FREE, dtype=np.int8)
    coarse = coarse_map(grid_of(states, resolution=0.2), 0.05)
    assert coarse.resolution == 0.2
    assert np.array_equal(coarse.states, states)
