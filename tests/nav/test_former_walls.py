"""Borders that open where a wall was are drift; those beside a wall that still stands are not."""

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from mapping.grid import OCCUPIED
from nav.former_walls import FormerWalls
from nav.frontier import FrontierConfig, find_frontiers
from nav.frontier_kernels import unmark_near_former_walls
from tests.nav.grids import costmap_of, grid_from_text, random_grid


def plain_unmark(
    marked: NDArray[np.int8], walls: NDArray[np.bool_], states: NDArray[np.int8], reach: int
) -> NDArray[np.int8]:
    """Asks of every marked cell whether a wall nearby touches nothing that is still drawn."""
    drawn = np.pad(states == OCCUPIED, 1)
    rows, columns = states.shape
    still = np.zeros_like(walls)
    for down in range(3):
        for right in range(3):
            still |= drawn[down : down + rows, right : right + columns]
    gone = np.argwhere(walls & ~still)
    kept = marked.copy()
    for row, column in np.argwhere(marked):
        if np.any(np.abs(gone - (row, column)).max(axis=1, initial=0) <= reach):
            kept[row, column] = 0
    return kept


@given(seed=st.integers(0, 10_000), reach=st.integers(0, 6))
@settings(max_examples=25)
def test_unmarking_equals_a_plain_look_at_every_wall(seed: int, reach: int) -> None:
    rng = np.random.default_rng(seed)
    before = costmap_of(random_grid(seed)).states
    states = np.where(rng.random(before.shape) < 0.3, 0, before).astype(np.int8)
    walls = (before == OCCUPIED) | (rng.random(before.shape) < 0.002)
    marked = (rng.random(states.shape) < 0.2).astype(np.int8)
    expected = plain_unmark(marked, walls, states, reach)
    unmark_near_former_walls(marked, walls, states, reach)
    assert np.array_equal(marked, expected)


def frontiers_after(before: list[str], after: list[str]) -> int:
    """Frontiers on the second map of a robot that has seen the first from nearby."""
    former_walls = FormerWalls()
    former_walls.note(costmap_of(grid_from_text("\n".join(before))), (0.8, 0.8))
    costmap = costmap_of(grid_from_text("\n".join(after)))
    return len(find_frontiers(costmap, FrontierConfig(), former_walls))


WALL = "#" * 32
FREE_ROW = "#" + "." * 20 + "#" + "?" * 10
THICK_ROW = "#" + "." * 20 + "##" + "?" * 9
OPEN_ROW = "#" + "." * 20 + "." + "?" * 10
ROOM = [WALL] + [FREE_ROW] * 30 + [WALL]


def test_a_wall_that_is_drawn_thinner_than_before_closes_no_frontier_beside_it() -> None:
    """The door in the east wall opens when the map clears up; the rest of the wall still stands."""
    with_door = [OPEN_ROW if 8 <= k < 24 else row for k, row in enumerate(ROOM)]
    thick_with_door = [
        OPEN_ROW if 8 <= k < 24 else (THICK_ROW if row == FREE_ROW else row)
        for k, row in enumerate(ROOM)
    ]
    assert frontiers_after(with_door, with_door) == 1
    assert frontiers_after(thick_with_door, with_door) == 1


def test_a_wall_that_has_moved_away_opens_no_frontier() -> None:
    moved = [OPEN_ROW if row == FREE_ROW else row for row in ROOM]
    assert frontiers_after(moved, moved) == 1
    assert frontiers_after(ROOM, moved) == 0
