"""Frontiers on maps small enough to count by hand."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy import ndimage

from mapping.grid import FREE, OCCUPIED, UNKNOWN, OccupancyGrid
from nav.former_walls import FormerWalls
from nav.frontier import FrontierConfig, find_frontiers
from nav.frontier_kernels import any_near, mark_frontier, take_pieces
from tests.nav.grids import ROOM_WITH_UNKNOWN_EAST, costmap_of, grid_from_text, random_grid


def plain_frontier(states: np.ndarray, beside_walls: bool) -> np.ndarray:
    padded = np.pad(states, 1, constant_values=FREE)
    rows, columns = states.shape
    marked = np.zeros(states.shape, dtype=bool)
    for i in range(rows):
        for j in range(columns):
            cross = padded[[i, i + 2, i + 1, i + 1], [j + 1, j + 1, j, j + 2]]
            block = padded[i : i + 3, j : j + 3]
            borders = states[i, j] == FREE and (cross == UNKNOWN).any()
            marked[i, j] = borders and (beside_walls or not (block == OCCUPIED).any())
    return marked


@given(seed=st.integers(0, 10_000), beside_walls=st.booleans())
@settings(max_examples=20, deadline=None)
def test_the_marked_frontier_equals_a_plain_look_at_every_cell(
    seed: int, beside_walls: bool
) -> None:
    states = costmap_of(random_grid(seed)).states
    found = mark_frontier(states, beside_walls)
    assert np.array_equal(found, plain_frontier(states, beside_walls))


@given(seed=st.integers(0, 9_999), share=st.floats(0.0, 1.0))
@settings(max_examples=60, deadline=None)
def test_pieces_of_marked_cells_are_those_that_scipy_labels(seed: int, share: float) -> None:
    rng = np.random.default_rng(seed)
    marked = (rng.random(rng.integers(1, 25, 2)) < share).astype(np.int8)
    labels, count = ndimage.label(marked, structure=np.ones((3, 3)))
    cells, starts = take_pieces(marked)
    assert not marked.any(), "taken"
    assert len(starts) == count + 1
    assert starts[-1] == len(cells)
    for piece in range(count):
        own = cells[starts[piece] : starts[piece + 1]]
        assert np.array_equal(own, np.argwhere(labels == piece + 1))


@given(seed=st.integers(0, 9_999), reach=st.integers(0, 4))
@settings(max_examples=60, deadline=None)
def test_a_mark_is_near_where_the_marks_made_wider_reach(seed: int, reach: int) -> None:
    rng = np.random.default_rng(seed)
    marked = rng.random((12, 17)) < 0.02
    wide = ndimage.maximum_filter(marked, size=2 * reach + 1, mode="constant")
    for cell in rng.integers(0, (12, 17), (20, 2)):
        assert any_near(marked, cell[None], reach) == wide[cell[0], cell[1]]
    assert any_near(marked, np.argwhere(wide), reach) == wide.any()


def test_one_open_side_is_one_frontier() -> None:
    costmap = costmap_of(grid_from_text(ROOM_WITH_UNKNOWN_EAST))
    (frontier,) = find_frontiers(costmap, FrontierConfig())
    assert frontier.size == pytest.approx(38 * 0.05), "its two ends touch the walls"
    assert frontier.middle == pytest.approx([40.5 * 0.05, 20.5 * 0.05], abs=0.06)


def test_a_hole_of_one_cell_in_a_wall_seen_from_afar_is_no_frontier() -> None:
    rows = ["?" * 22] + ["#" * 22] + ["#" + "." * 20 + "#"] * 20 + ["#" * 22]
    rows[1] = "#" * 10 + "." + "#" * 11
    assert find_frontiers(costmap_of(grid_from_text("\n".join(rows))), FrontierConfig()) == []


def test_space_that_opens_where_a_wall_was_is_no_frontier_but_a_new_door_far_off_is() -> None:
    former_walls = FormerWalls()
    picture = ROOM_WITH_UNKNOWN_EAST.replace(".?", "#?")
    walled, opened = grid_from_text(picture), grid_from_text(ROOM_WITH_UNKNOWN_EAST)
    former_walls.note(costmap_of(walled), (1.0, 1.0))
    costmap = costmap_of(opened)
    assert find_frontiers(costmap, FrontierConfig(), former_walls) == []
    never_near = FormerWalls()
    never_near.note(costmap_of(walled), (-3.0, 1.0))
    assert len(find_frontiers(costmap, FrontierConfig(), never_near)) == 1


def test_former_walls_keep_their_places_when_the_map_grows() -> None:
    grid = OccupancyGrid()
    grid.log_odds[:] = -5.0
    grid.log_odds[:, 260:265] = 5.0
    costmap = costmap_of(grid)
    former_walls = FormerWalls()
    former_walls.note(costmap, (0.0, 0.0))
    grid.cover(-4.0, 1.0, -4.0, 1.0)
    costmap.refresh(grid)
    states = costmap.states.copy()
    costmap.states[states == OCCUPIED] = FREE
    marked = np.ones(costmap.states.shape, dtype=np.int8)
    former_walls.unmark(costmap, marked)
    assert not marked[states == OCCUPIED].all()
    assert marked[tuple(costmap.world_to_cell((-1.0, 0.0)))]
    assert not marked[tuple(costmap.world_to_cell((0.06, 0.0)))]


def test_a_closed_room_has_no_frontier() -> None:
    room = "\n".join(["#" * 20] + ["#" + "." * 18 + "#"] * 18 + ["#" * 20])
    assert find_frontiers(costmap_of(grid_from_text(room)), FrontierConfig()) == []
