"""The costmap against plain counting and SciPy's distance transform."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.ndimage import distance_transform_edt

from mapping.errors import TestbedError
from mapping.grid import FREE, OCCUPIED, UNKNOWN, OccupancyGrid
from nav.costmap import Costmap, CostmapConfig
from tests.nav.grids import costmap_of, grid_from_log_odds, grid_from_text, random_grid


def plain_states(grid: OccupancyGrid, factor: int, known_share: float) -> np.ndarray:
    rows, columns = grid.shape
    states = np.full((-(-rows // factor), -(-columns // factor)), UNKNOWN, dtype=np.int8)
    for row in range(states.shape[0]):
        for column in range(states.shape[1]):
            block = grid.log_odds[
                row * factor : (row + 1) * factor, column * factor : (column + 1) * factor
            ]
            if (block > 3.0).any():
                states[row, column] = OCCUPIED
            elif (block < -3.0).sum() >= np.ceil(known_share * factor**2):
                states[row, column] = FREE
    return states


@given(seed=st.integers(0, 10_000), fine=st.sampled_from([1, 2, 5]))
@settings(max_examples=15, deadline=None)
def test_states_equal_plain_counting_of_fine_cells(seed: int, fine: int) -> None:
    grid = random_grid(seed, rows=20, columns=27, fine=fine)
    costmap = costmap_of(grid)
    assert np.array_equal(costmap.states, plain_states(grid, fine, costmap.config.known_share))


@given(seed=st.integers(0, 10_000), fine=st.sampled_from([1, 5]))
@settings(max_examples=10, deadline=None)
def test_clearance_equals_scipys_distance_transform_at_the_fine_resolution(
    seed: int, fine: int
) -> None:
    grid = random_grid(seed, rows=20, columns=27, fine=fine)
    costmap = costmap_of(grid)
    limit = costmap.config.inflation
    occupied = grid.log_odds > 3.0
    exact = (
        distance_transform_edt(~occupied, sampling=grid.resolution)
        if occupied.any()
        else np.full(grid.shape, np.inf)
    )
    middle = fine // 2  # with an odd factor the planning cell's centre is a fine cell's centre
    expected = np.minimum(exact[middle::fine, middle::fine], limit)
    asked = costmap.states != OCCUPIED
    assert costmap.clearance[asked] == pytest.approx(expected[asked], abs=1e-6)


@given(seed=st.integers(0, 10_000))
@settings(max_examples=15, deadline=None)
def test_refreshing_where_the_map_changed_equals_refreshing_everything(seed: int) -> None:
    grid = random_grid(seed, fine=2)
    costmap = costmap_of(grid)
    rng = np.random.default_rng(seed)
    row, column = rng.integers(20, 80), rng.integers(20, 120)
    grid.log_odds[row : row + 16, column : column + 16] = rng.choice([-5.0, 0.0, 5.0], (16, 16))
    costmap.refresh(grid, grid.cell_to_world([row + 8, column + 8]), reach=0.5)
    whole = costmap_of(grid)
    assert np.array_equal(costmap.states, whole.states)
    assert np.array_equal(costmap.clearance, whole.clearance)
    assert np.array_equal(costmap.cost, whole.cost)


def test_a_map_that_grew_is_taken_over_whole() -> None:
    grid = OccupancyGrid()
    costmap = costmap_of(grid)
    grid.cover(-5.0, 1.0, -1.0, 1.0)
    grid.log_odds[:] = -5.0
    costmap.refresh(grid, (0.0, 0.0), reach=0.1)
    assert (costmap.states[:-1, :-1] == FREE).all()


def test_a_door_of_30_cm_stays_open_wherever_the_grid_lines_fall() -> None:
    for shift in range(5):
        log_odds = np.full((100, 100), -5.0)
        log_odds[:, 50:54] = 5.0
        log_odds[30 + shift : 60 + shift, 50:54] = -5.0
        costmap = costmap_of(grid_from_log_odds(log_odds, 0.01))
        assert np.isfinite(costmap.cost[:, 10]).any()


def test_cost_is_one_in_the_open_and_infinite_where_none_may_go() -> None:
    costmap = costmap_of(
        grid_from_text(
            """
            ????????????????????
            ....................
            ....................
            ...................#
            ....................
            ....................
            """
        )
    )
    assert costmap.cost[1, 2] == 1.0
    assert np.isinf(costmap.cost[5]).all(), "unknown"
    assert np.isinf(costmap.cost[2, 19]), "occupied"
    assert np.isinf(costmap.cost[2, 18]), "0.05 m from an occupied cell"
    assert costmap.cost[2, 15] > costmap.cost[2, 14] > 1.0


def test_a_place_outside_the_map_has_no_clearance() -> None:
    costmap = costmap_of(grid_from_text("..\n.."))
    assert costmap.clearance_at((50.0, 50.0)) == 0.0
    assert Costmap().clearance_at((0.0, 0.0)) == 0.0


def test_an_inflation_inside_the_robot_is_refused() -> None:
    with pytest.raises(TestbedError, match="inflation"):
        CostmapConfig(inflation=0.05)


def test_a_map_drawn_anew_is_taken_over_whole_wherever_the_robot_is() -> None:
    before, after = random_grid(1), random_grid(2)
    after.redraws = 1
    refreshed, glanced = costmap_of(before), costmap_of(before)
    refreshed.refresh(after, (0.1, 0.1), 0.2)
    glanced.glance(after, (0.1, 0.1), 0.2, (0.9, 0.9), 0.1)
    for costmap in (refreshed, glanced):
        assert np.array_equal(costmap.states, costmap_of(after).states)
        assert np.array_equal(costmap.cost, costmap_of(after).cost)


def test_a_glance_takes_over_states_where_the_map_changed_and_somebody_looks() -> None:
    before, after = random_grid(1), random_grid(2)
    costmap = costmap_of(before)
    old, new = costmap.states.copy(), costmap_of(after).states
    changed, seen = np.array([0.3, 0.4]), np.array([0.5, 0.3])
    costmap.glance(after, changed, 0.2, seen, 0.15)
    rows, columns = np.indices(old.shape)
    middles = costmap.cell_to_world(np.stack((rows, columns), axis=-1))
    half = 0.5 * costmap.resolution
    is_changed = (np.abs(middles - changed) <= 0.2 + half).all(axis=-1)
    is_seen = (np.abs(middles - seen) <= 0.15 + half).all(axis=-1)
    assert 0 < (is_changed & is_seen & (old != new)).sum() < (old != new).sum()
    assert np.array_equal(costmap.states, np.where(is_changed & is_seen, new, old))
    costmap.glance(before, changed, 0.1, changed + 0.5, 0.1)
    assert np.array_equal(costmap.states, np.where(is_changed & is_seen, new, old)), "far apart"
