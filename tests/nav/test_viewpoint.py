"""Viewpoints on maps small enough to count by hand."""

from dataclasses import replace
from itertools import product

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from mapping.errors import TestbedError
from mapping.grid import FREE, UNKNOWN
from nav.costmap import Costmap
from nav.frontier import FrontierConfig, find_frontiers
from nav.planner import CostField
from nav.viewpoint import Viewpoint, ViewpointConfig, ViewpointFinder, gain_at
from nav.viewpoint_kernels import view_square_on
from nav.visited_places import VisitedPlaces
from tests.nav.grids import (
    ROOM_WITH_UNKNOWN_EAST,
    costmap_of,
    grid_from_text,
    random_grid,
    room_with_slit,
)

HERE = np.array([1.0, 1.0])


def viewpoints_from(
    costmap: Costmap, start: np.ndarray, visited: VisitedPlaces | None = None
) -> list[Viewpoint]:
    field = CostField.around(costmap, start, escape_radius=0.0)
    frontiers = find_frontiers(costmap, FrontierConfig())
    places = (visited or VisitedPlaces()).on(costmap)
    return ViewpointFinder().find(field, frontiers, places, start)


@given(seed=st.integers(0, 10_000))
@settings(max_examples=15, deadline=None)
def test_viewpoints_are_reachable_clear_and_promise_enough(seed: int) -> None:
    config = ViewpointConfig()
    costmap = costmap_of(random_grid(seed))
    cells = np.argwhere(np.isfinite(costmap.cost))
    for viewpoint in viewpoints_from(costmap, costmap.cell_to_world(cells[len(cells) // 2])):
        row, column = costmap.world_to_cell(viewpoint.place)
        assert costmap.states[row, column] == FREE
        assert np.isfinite(viewpoint.cost)
        assert costmap.clearance[row, column] >= config.view_clearance - 1e-6
        assert viewpoint.gain >= config.min_gain


def test_the_robot_is_sent_to_known_ground_from_which_the_frontier_is_in_view() -> None:
    costmap = costmap_of(grid_from_text(ROOM_WITH_UNKNOWN_EAST))
    found = viewpoints_from(costmap, np.array([0.3, 1.0]))
    assert found
    assert all(0.9 < viewpoint.place[0] < 2.0 for viewpoint in found)


def test_a_frontier_whose_middle_no_place_sees_is_looked_at_by_another_part_of_it() -> None:
    costmap = costmap_of(room_with_slit())
    _, slit = find_frontiers(costmap, FrontierConfig())
    field = CostField.around(costmap, HERE, escape_radius=0.0)
    reached = costmap.cell_to_world(np.argwhere(np.isfinite(field.cost_to_come)))
    assert np.hypot(*(reached - slit.middle).T).min() > max(ViewpointConfig().view_distances)
    assert ViewpointFinder().find(field, [slit], VisitedPlaces().on(costmap), HERE)


def test_a_frontier_whose_middle_shows_too_little_is_looked_at_by_another_part_of_it() -> None:
    """A shadow along a passage; at its far end a way goes off between two cabinets."""
    wall, passage, shadow = 92 * "#", f"#{90 * '.'}#", f"#{90 * '?'}#"
    way_off, behind = f"{80 * '#'}{7 * '?'}{5 * '#'}", f"{60 * '#'}{31 * '?'}#"
    lines = [wall, *8 * [passage], shadow, *8 * [way_off], *16 * [behind], wall]
    costmap, robot = costmap_of(grid_from_text("\n".join(lines))), np.array([0.3, 1.5])
    (border,) = find_frontiers(costmap, FrontierConfig())
    assert border.middle[0] == pytest.approx(2.3, abs=0.06)
    finder = ViewpointFinder(ViewpointConfig(min_gain=0.3, min_share_per_metre=0.0))
    field = CostField.around(costmap, robot)
    (found,) = finder.find(field, [border], VisitedPlaces().on(costmap), robot)
    assert found.gain > 0.5
    assert 4.0 < found.place[0] < 4.35


def test_a_place_where_the_robot_has_stood_promises_nothing_any_more() -> None:
    costmap = costmap_of(grid_from_text(ROOM_WITH_UNKNOWN_EAST))
    visited = VisitedPlaces()
    for x in np.arange(0.3, 1.95, 0.1):
        for y in np.arange(0.2, 1.9, 0.1):
            visited.note(costmap, (x, y))
    assert viewpoints_from(costmap, HERE, visited) == []
    assert viewpoints_from(costmap, HERE)


def test_gain_is_the_unknown_area_in_view_and_walls_hide_what_is_behind() -> None:
    config = ViewpointConfig(gain_depth=0.5, gain_range=3.0)
    seen = gain_at(costmap_of(grid_from_text(ROOM_WITH_UNKNOWN_EAST)), np.array([1.9, 1.0]), config)
    assert 0.7 < seen < 1.7, "about a band of 0.5 m along 2 m of border, widened at its ends"
    closed = grid_from_text(ROOM_WITH_UNKNOWN_EAST.replace(".?", "#?"))
    assert gain_at(costmap_of(closed), HERE, config) == 0.0


def test_through_a_hole_in_a_wall_only_those_see_who_are_told_to() -> None:
    grid = grid_from_text(
        """
        ?????????
        ####?####
        #.......#
        #.......#
        #.......#
        #########
        """
    )
    costmap, place = costmap_of(grid), np.array([0.225, 0.125])
    config = ViewpointConfig(gain_depth=0.5)
    assert gain_at(costmap, place, config) == 0.0
    config = ViewpointConfig(gain_depth=0.5, through_holes=True)
    assert gain_at(costmap, place, config) > 0.0


def test_a_hole_in_the_wall_that_the_robot_stands_at_is_looked_at_square_on() -> None:
    wall, room = "#" * 60 + "?" * 4 + "#" * 18, "#" + "." * 80 + "#"
    rows = ["?" * 82] * 4 + [wall] * 3 + [room] * 30 + ["#" * 82]
    costmap, here = costmap_of(grid_from_text("\n".join(rows))), np.array([1.0, 1.35])
    (hole,) = find_frontiers(costmap, FrontierConfig(min_cells=2))
    field, nothing = CostField.around(costmap, here), VisitedPlaces().on(costmap)
    config = ViewpointConfig(through_holes=True, square_on=0.5)
    along = ViewpointFinder(replace(config, square_on=0.0)).find(field, [hole], nothing, here)
    found = ViewpointFinder(config).find(field, [hole], nothing, here)
    best = max(found, key=lambda viewpoint: viewpoint.gain)
    assert best.place == pytest.approx(hole.middle - (0.0, 0.5), abs=0.051)
    assert best.gain > 1.5 * max(viewpoint.gain for viewpoint in along)


@given(seed=st.integers(0, 10_000), reach=st.floats(0.0, 20.0))
@settings(max_examples=25, deadline=None)
def test_the_place_square_on_equals_a_plain_walk_away_from_the_unknown(
    seed: int, reach: float
) -> None:
    costmap = costmap_of(random_grid(seed))
    cells = np.argwhere(np.isfinite(costmap.cost))
    field = CostField.around(costmap, costmap.cell_to_world(cells[len(cells) // 2]))
    visited = np.random.default_rng(seed).random(costmap.states.shape) < 0.3
    for frontier in find_frontiers(costmap, FrontierConfig(min_cells=2)):
        unknown = np.pad(costmap.states == UNKNOWN, 1)
        away = np.zeros(2)
        for cell, step in product(frontier.cells, ((1, 0), (-1, 0), (0, 1), (0, -1))):
            away -= np.multiply(step, unknown[tuple(cell + 1 + step)])
        row, column = costmap.world_to_cell(frontier.middle).tolist()
        expected = (-1, -1)
        for step in range(1, int(reach) + 1) if away.any() else ():
            at = np.floor((row + 0.5, column + 0.5) + step * away / np.linalg.norm(away))
            cell = (int(at[0]), int(at[1]))
            if min(cell) < 0 or (np.array(cell) >= costmap.states.shape).any():
                break
            if costmap.states[cell] != FREE:
                break
            clear = costmap.clearance[cell] >= np.float32(0.14)
            if clear and np.isfinite(field.cost_to_come[cell]) and not visited[cell]:
                expected = cell
        assert expected == view_square_on(
            field.cost_to_come,
            costmap.states,
            costmap.clearance,
            visited,
            frontier.cells,
            row,
            column,
            reach,
            np.float32(0.14),
        )


def test_a_look_square_on_from_behind_the_frontier_is_refused() -> None:
    with pytest.raises(TestbedError, match="square_on must not be below 0"):
        ViewpointConfig(square_on=-0.1)


def test_each_viewpoint_knows_what_the_best_other_of_its_frontier_promises() -> None:
    costmap = costmap_of(grid_from_text(ROOM_WITH_UNKNOWN_EAST))
    found = viewpoints_from(costmap, HERE)
    assert len({id(item.frontier) for item in found}) < len(found)
    for item in found:
        others = [each for each in found if each.frontier is item.frontier and each is not item]
        assert item.rival >= max((each.gain for each in others), default=0.0)


def test_a_place_outside_the_map_promises_nothing() -> None:
    costmap = costmap_of(grid_from_text(".."))
    assert gain_at(costmap, np.array([9.0, 9.0]), ViewpointConfig()) == 0.0


def test_a_crumb_far_away_is_not_worth_the_way_that_a_near_one_is() -> None:
    costmap = costmap_of(grid_from_text(ROOM_WITH_UNKNOWN_EAST))
    frontiers = find_frontiers(costmap, FrontierConfig())
    nothing = VisitedPlaces().on(costmap)
    dear = ViewpointFinder(ViewpointConfig(min_share_per_metre=5.0, always_worth=100.0))
    far, near = np.array([0.3, 1.0]), HERE
    assert dear.find(CostField.around(costmap, far), frontiers, nothing, far) == []
    assert dear.find(CostField.around(costmap, near), frontiers, nothing, near)
    never_left = ViewpointFinder(ViewpointConfig(min_share_per_metre=5.0, always_worth=1.0))
    assert never_left.find(CostField.around(costmap, far), frontiers, nothing, far)
