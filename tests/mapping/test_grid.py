import math
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from mapping.errors import TestbedError
from mapping.grid import FREE, OCCUPIED, TILE_CELLS, UNKNOWN, GridConfig, OccupancyGrid

CELL = st.tuples(st.integers(-500, 2000), st.integers(-500, 2000))


@given(cell=CELL, x=st.floats(-30, 30), y=st.floats(-30, 30), edge=st.sampled_from([0.01, 0.05]))
def test_world_to_cell_and_cell_to_world_are_inverses(
    cell: tuple[int, int], x: float, y: float, edge: float
) -> None:
    grid = OccupancyGrid(GridConfig(resolution=edge, origin=(x, y), rows=1, columns=1))
    assert tuple(grid.world_to_cell(grid.cell_to_world(cell))) == cell


@given(boxes=st.lists(st.tuples(st.floats(-9, 9), st.floats(-9, 9)), min_size=1, max_size=4))
@settings(max_examples=30, deadline=None)
def test_a_grid_that_grows_keeps_its_cells_in_their_places(
    boxes: list[tuple[float, float]],
) -> None:
    grid = OccupancyGrid(GridConfig(resolution=0.05, origin=(0.0, 0.0), rows=4, columns=4))
    grid.log_odds[2, 1] = 7.0
    for x, y in boxes:
        grid.cover(x, x + 1.0, y, y + 1.0)
        assert np.all(grid.contains(grid.world_to_cell([[x, y], [x + 1.0, y + 1.0]])))
        assert (np.array(grid.shape) - 4).tolist() == [
            TILE_CELLS * round((side - 4) / TILE_CELLS) for side in grid.shape
        ]
    assert grid.log_odds.sum() == 7.0
    assert grid.log_odds[tuple(grid.world_to_cell([0.075, 0.125]))] == 7.0


def test_a_fixed_grid_does_not_grow() -> None:
    grid = OccupancyGrid(GridConfig(rows=4, columns=4, grows=False))
    grid.cover(-50.0, 50.0, -50.0, 50.0)
    assert grid.shape == (4, 4)


def test_states_are_told_by_the_thresholds_which_count_as_unknown() -> None:
    grid = OccupancyGrid(GridConfig(rows=1, columns=5))
    grid.log_odds[0] = [-3.1, -3.0, 0.0, 3.0, 3.1]
    assert grid.states().tolist() == [[FREE, UNKNOWN, UNKNOWN, UNKNOWN, OCCUPIED]]


def test_a_copy_is_a_grid_of_its_own() -> None:
    grid = OccupancyGrid()
    twin = grid.copy()
    grid.log_odds[0, 0] = 1.0
    grid.cover(-9.0, 9.0, -9.0, 9.0)
    assert twin.log_odds[0, 0] == 0.0
    assert twin.shape == (512, 512)


@pytest.mark.parametrize("broken", [{"resolution": 0.0}, {"resolution": np.nan}, {"rows": 0}])
def test_a_grid_that_cannot_be_is_told(broken: dict[str, float]) -> None:
    with pytest.raises(TestbedError):
        GridConfig(**broken)  # type: ignore[arg-type]


def test_a_box_that_is_not_finite_is_told() -> None:
    with pytest.raises(TestbedError, match="finite"):
        OccupancyGrid().cover(0.0, np.nan, 0.0, 1.0)


SMALL = GridConfig(resolution=0.05, rows=240, columns=240, origin=(0.0, 0.0), most_cells=480 * 480)


@pytest.mark.parametrize("far", [40.0, 1e6, 1e18, 1e300])
def test_a_grid_does_not_grow_beyond_its_most_cells(
    far: float, caplog: pytest.LogCaptureFixture
) -> None:
    grid = OccupancyGrid(SMALL)
    grid.log_odds[3, 4] = 7.0
    for _ in range(3):
        grid.cover(-far, far, 1.0, 2.0)
    assert grid.shape == (240, 240)
    assert grid.origin.tolist() == [0.0, 0.0]
    assert grid.log_odds[3, 4] == 7.0
    assert len(caplog.records) == 1, "told once"
    assert "not drawn" in caplog.text


def test_a_refused_box_does_not_keep_a_grid_from_growing_to_what_fits() -> None:
    grid = OccupancyGrid(SMALL)
    grid.cover(0.0, 1e6, 0.0, 1e6)
    grid.cover(-1.0, 12.5, 1.0, 2.0)
    assert grid.shape == (240, 720), "12 m and a tile to each side"
    grid.cover(0.0, 1.0, -12.5, 1.0)
    assert grid.shape == (240, 720), "with two tiles below it would be too large"


@given(
    boxes=st.lists(
        st.tuples(st.floats(-1e3, 1e3), st.floats(-1e3, 1e3), st.floats(0, 50)), max_size=6
    )
)
def test_no_boxes_make_a_grid_larger_than_its_most_cells(
    boxes: list[tuple[float, float, float]],
) -> None:
    grid = OccupancyGrid(SMALL)
    for x, y, side in boxes:
        grid.cover(x, x + side, y, y + side)
        assert grid.log_odds.size <= SMALL.most_cells


def test_most_cells_below_one_make_no_grid() -> None:
    with pytest.raises(TestbedError, match="most_cells"):
        GridConfig(most_cells=0)


@pytest.mark.parametrize(
    ("wrong", "told"),
    [
        ({"origin": (math.nan, 0.0)}, "origin"),
        ({"origin": (0.0, math.inf)}, "origin"),
        ({"rows": 1.5}, "grid size: 1.5 x 512"),
        ({"columns": 0}, "grid size"),
    ],
)
def test_figures_that_make_no_grid_are_refused(wrong: dict[str, Any], told: str) -> None:
    with pytest.raises(TestbedError, match=told):
        GridConfig(**wrong)
