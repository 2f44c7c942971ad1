"""Frontiers and viewpoints on maps small enough to count by hand."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from mapping.grid import FREE, UNKNOWN
from nav.frontier import FrontierConfig, find_frontiers, find_viewpoints, gain_at
from nav.frontier_kernels import mark_frontier
from nav.planner import CostField
from tests.nav.grids import costmap_of, grid_from_text, random_grid

ROOM_WITH_UNKNOWN_EAST = "\n".join(
    ["#" * 41 + "?" * 39] + ["#" + "." * 40 + "?" * 39] * 40 + ["#" * 41 + "?" * 39]
)


def plain_frontier(states: np.ndarray) -> np.ndarray:
    padded = np.pad(states, 1, constant_values=FREE)
    rows, columns = states.shape
    marked = np.zeros(states.shape, dtype=bool)
    for i in range(rows):
        for j in range(columns):
            around = (
                padded[i, j + 1],
                padded[i + 2, j + 1],
                padded[i + 1, j],
                padded[i + 1, j + 2],
            )
            marked[i, j] = states[i, j] == FREE and UNKNOWN in around
    return marked


@given(seed=st.integers(0, 10_000))
@settings(max_examples=15, deadline=None)
def test_the_marked_frontier_equals_a_plain_look_at_every_cell(seed: int) -> None:
    states = costmap_of(random_grid(seed)).states
    assert np.array_equal(mark_frontier(states), plain_frontier(states))


def test_one_open_side_is_one_frontier() -> None:
    costmap = costmap_of(grid_from_text(ROOM_WITH_UNKNOWN_EAST))
    (frontier,) = find_frontiers(costmap, FrontierConfig())
    assert frontier.size == pytest.approx(40 * 0.05)
    assert frontier.middle == pytest.approx([40.5 * 0.05, 20.5 * 0.05], abs=0.06)


def test_a_closed_room_has_no_frontier() -> None:
    room = "\n".join(["#" * 20] + ["#" + "." * 18 + "#"] * 18 + ["#" * 20])
    assert find_frontiers(costmap_of(grid_from_text(room)), FrontierConfig()) == []


@given(seed=st.integers(0, 10_000))
@settings(max_examples=15, deadline=None)
def test_viewpoints_are_reachable_clear_and_promise_enough(seed: int) -> None:
    config = FrontierConfig()
    costmap = costmap_of(random_grid(seed))
    cells = np.argwhere(np.isfinite(costmap.cost))
    start = costmap.cell_to_world(cells[len(cells) // 2])
    field = CostField.around(costmap, start, escape_radius=0.0)
    for viewpoint in find_viewpoints(field, find_frontiers(costmap, config), config):
        row, column = costmap.world_to_cell(viewpoint.place)
        assert costmap.states[row, column] == FREE
        assert np.isfinite(viewpoint.cost)
        assert costmap.clearance[row, column] >= config.view_clearance - 1e-6
        assert viewpoint.gain >= config.min_gain


def test_gain_is_the_unknown_area_in_view_and_walls_hide_what_is_behind() -> None:
    costmap = costmap_of(grid_from_text(ROOM_WITH_UNKNOWN_EAST))
    config = FrontierConfig(gain_depth=0.5, gain_range=3.0)
    seen = gain_at(costmap, np.array([1.9, 1.0]), config)
    assert 0.7 < seen < 1.7, "about a band of 0.5 m along 2 m of border, widened at its ends"
    closed = ROOM_WITH_UNKNOWN_EAST.replace(".?", "#?")
    assert gain_at(costmap_of(grid_from_text(closed)), np.array([1.0, 1.0]), config) == 0.0


def test_a_place_outside_the_map_promises_nothing() -> None:
    costmap = costmap_of(grid_from_text(".."))
    assert gain_at(costmap, np.array([9.0, 9.0]), FrontierConfig()) == 0.0
