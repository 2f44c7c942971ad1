"""The planner against SciPy's Dijkstra on the same graph."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.sparse import coo_array
from scipy.sparse.csgraph import dijkstra

from nav.costmap import Costmap
from nav.planner import CostField
from nav.planner_kernels import line_cost
from tests.nav.grids import ROOM_WITH_UNKNOWN_EAST, costmap_of, grid_from_text, random_grid


def scipy_costs(costmap: Costmap, start: tuple[int, int]) -> np.ndarray:
    rows, columns = costmap.cost.shape
    sources, targets, weights = [], [], []
    for i in range(rows):
        for j in range(columns):
            for di in (-1, 0, 1):
                for dj in (-1, 0, 1):
                    k, m = i + di, j + dj
                    if (di, dj) == (0, 0) or not (0 <= k < rows and 0 <= m < columns):
                        continue
                    mean = 0.5 * (costmap.cost[i, j] + costmap.cost[k, m])
                    corners = costmap.cost[i, m] + costmap.cost[k, j]
                    if np.isfinite(mean) and np.isfinite(corners):
                        sources.append(i * columns + j)
                        targets.append(k * columns + m)
                        weights.append(costmap.resolution * np.hypot(di, dj) * mean)
    graph = coo_array((weights, (sources, targets)), shape=(rows * columns,) * 2).tocsr()
    return dijkstra(graph, indices=start[0] * columns + start[1]).reshape(rows, columns)


def open_cell(costmap: Costmap, seed: int) -> tuple[int, int]:
    cells = np.argwhere(np.isfinite(costmap.cost))
    row, column = cells[np.random.default_rng(seed).integers(len(cells))]
    return int(row), int(column)


@given(seed=st.integers(0, 10_000))
@settings(max_examples=8, deadline=None)
def test_costs_equal_scipys_dijkstra(seed: int) -> None:
    costmap = costmap_of(random_grid(seed, rows=25, columns=30))
    start = open_cell(costmap, seed)
    field = CostField.around(costmap, costmap.cell_to_world(start), escape_radius=0.0)
    assert field.cost_to_come == pytest.approx(scipy_costs(costmap, start), rel=1e-5)


@given(seed=st.integers(0, 10_000))
@settings(max_examples=15, deadline=None)
def test_a_path_leads_from_start_to_goal_through_open_cells_only(seed: int) -> None:
    costmap = costmap_of(random_grid(seed))
    start, goal = open_cell(costmap, seed), open_cell(costmap, seed + 1)
    field = CostField.around(costmap, costmap.cell_to_world(start), escape_radius=0.0)
    place = costmap.cell_to_world(goal)
    if not field.reaches(place):
        with pytest.raises(ValueError, match="no known way"):
            field.path_to(place)
        return
    path = field.path_to(place)
    assert path[0] == pytest.approx(costmap.cell_to_world(start))
    assert path[-1] == pytest.approx(place)
    for a, b in zip(costmap.world_to_cell(path[:-1]), costmap.world_to_cell(path[1:]), strict=True):
        assert line_cost(a, b, costmap.cost) < 100.0 * np.hypot(*(b - a)) + 1e-9


def test_a_straight_way_has_no_corners() -> None:
    costmap = costmap_of(grid_from_text("\n".join(["." * 60] * 60)))
    field = CostField.around(costmap, (0.5, 0.5))
    assert len(field.path_to((2.5, 1.3))) == 2


def test_a_robot_too_close_to_a_wall_may_leave_but_not_cross_it() -> None:
    costmap = costmap_of(grid_from_text("\n".join([".........#.........."] * 20)))
    field = CostField.around(costmap, (0.43, 0.5))
    assert field.reaches((0.1, 0.5))
    assert not field.reaches((0.9, 0.5))


def test_a_search_with_a_bound_settles_what_is_cheaper_and_leaves_the_rest() -> None:
    costmap = costmap_of(grid_from_text("\n".join(["." * 80] * 20)))
    field = CostField.around(costmap, (0.5, 0.5), max_cost=1.0)
    assert field.cost_at((1.2, 0.5)) == pytest.approx(0.7, abs=0.05)
    assert not field.reaches((3.5, 0.5))


def test_nothing_is_reachable_from_outside_the_map() -> None:
    costmap = costmap_of(grid_from_text("\n".join(["." * 20] * 20)))
    assert not CostField.around(costmap, (-3.0, 0.5)).reaches((0.5, 0.5))


def test_the_nearest_place_that_is_reached_is_the_point_itself_or_one_beside_it() -> None:
    field = CostField.around(costmap_of(grid_from_text(ROOM_WITH_UNKNOWN_EAST)), (1.0, 1.0))
    inside = np.array([0.7, 0.9])
    assert np.array_equal(field.nearest_reached(inside, 0.0), inside)
    beside = field.nearest_reached((0.08, 1.0), 0.2)
    assert beside is not None
    assert field.reaches(beside)
    places = field.costmap.cell_to_world(np.argwhere(np.isfinite(field.cost_to_come)))
    assert np.hypot(*(beside - (0.08, 1.0))) == np.hypot(*(places - (0.08, 1.0)).T).min()
    assert field.nearest_reached((0.08, 1.0), 0.01) is None
