"""Where scans met something is no way on, long before the map says that a wall is there."""

import math

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from mapping.grid import FREE, OCCUPIED, UNKNOWN, OccupancyGrid
from nav.costmap import Costmap
from nav.frontier import FrontierConfig, find_frontiers
from nav.returns import NO_WAY_THROUGH, Returns
from nav.scan_points import ScanView
from tests.nav.grids import costmap_of, grid_from_log_odds, grid_from_text
from tests.nav.scans import Room, box, views_of

HALF_KNOWN = grid_from_text("\n".join(["." * 40 + "?" * 40] * 40))
"""2 x 4 m, free in the west and unknown in the east."""


def view_of(points: list[tuple[float, float]], beams: list[int] | None = None) -> ScanView:
    """A scan that met something at these places [m], with beams side by side if not told."""
    indices = list(range(len(points))) if beams is None else beams
    ranges = np.full(360, math.inf)
    ranges[indices] = 1.0
    return ScanView(
        stamp=0.0,
        points=np.array(points, dtype=np.float64).reshape(-1, 2),
        beams=np.array(indices, dtype=np.int64),
        origin=np.zeros(2),
        bearing=0.0,
        increment=math.radians(1.0),
        ranges=ranges,
    )


def occupied_after(*views: ScanView) -> list[tuple[int, int]]:
    """The cells that are taken for occupied after some scans."""
    costmap, returns = costmap_of(HALF_KNOWN), Returns()
    for view in views:
        returns.note(costmap, view)
    returns.mark(costmap)
    return [(int(row), int(column)) for row, column in np.argwhere(costmap.states == OCCUPIED)]


def test_returns_from_two_scans_mark_a_cell_and_from_one_do_not() -> None:
    wall = view_of([(3.01, 0.52)])
    assert occupied_after(wall) == []
    assert occupied_after(wall, view_of([(3.04, 0.54)])) == [(10, 60)]
    assert occupied_after(wall, view_of([(3.06, 0.54)])) == [], "the cell beside it"


def test_two_returns_of_one_scan_are_still_one_scan() -> None:
    assert occupied_after(view_of([(3.01, 0.52), (3.02, 0.53), (3.01, 0.52)])) == []


def test_known_free_cells_stay_free_and_clearances_as_they_are() -> None:
    costmap, returns = costmap_of(HALF_KNOWN), Returns()
    states, clearance = costmap.states.copy(), costmap.clearance.copy()
    for _ in range(3):
        returns.note(costmap, view_of([(1.0, 1.0), (3.0, 1.0)], [3, 90]))
    returns.mark(costmap)
    assert np.array_equal(costmap.states[states == FREE], states[states == FREE])
    assert np.count_nonzero(costmap.states != states) == 1
    assert np.array_equal(costmap.clearance, clearance)


def test_what_the_map_comes_to_know_to_be_free_is_free() -> None:
    """Someone stood there: the marks speak for unknown cells alone."""
    costmap, returns = costmap_of(HALF_KNOWN), Returns()
    for _ in range(2):
        returns.note(costmap, view_of([(3.0, 1.0)]))
    seen_since = costmap_of(grid_from_text("\n".join(["." * 80] * 40)))
    returns.mark(seen_since)
    assert not (seen_since.states == OCCUPIED).any()


def columns_between(gap: float, beams: list[int]) -> set[int]:
    """The columns marked by two returns so far apart [m], along one row from x = 2.51 on."""
    pair = view_of([(2.51, 1.02), (2.51 + gap, 1.02)], beams)
    return {column for _, column in occupied_after(pair, pair)}


def test_a_gap_of_30_cm_between_neighbouring_beams_stays_open_and_a_narrower_one_is_shut() -> None:
    assert columns_between(0.30, [7, 8]) == {50, 56}
    assert columns_between(NO_WAY_THROUGH - 0.01, [7, 8]) == {50, 51, 52, 53}
    assert columns_between(0.20, [7, 9]) == {50, 54}, "the beam between them went through"


def test_a_door_in_a_wall_seen_at_a_grazing_angle_is_most_likely_wall_but_not_surely() -> None:
    """The wall's returns lie 0.1 m apart and leave 0.4 m out."""
    wall = view_of([(2.51 + 0.1 * k, 1.02) for k in (0, 1, 2, 3, 4, 8, 9, 10)])
    costmap, returns = costmap_of(HALF_KNOWN), Returns()
    for _ in range(2):
        returns.note(costmap, wall)
    surely, likely = costmap_of(HALF_KNOWN), costmap_of(HALF_KNOWN)
    returns.mark(surely, sure=True)
    returns.mark(likely)
    assert (likely.states[20, 50:71] == OCCUPIED).all()
    assert np.flatnonzero(surely.states[20] == OCCUPIED).tolist() == [
        *range(50, 59),
        *range(66, 71),
    ]


def test_a_redrawn_map_tells_by_itself_where_scans_met_something() -> None:
    log_odds = np.where(np.arange(400) < 200, -5.0, np.zeros((200, 400)))
    log_odds[101, [203, 204, 218]] = 0.1
    log_odds[160, 220] = -0.1
    grid = grid_from_log_odds(log_odds, 0.01)
    costmap, returns = costmap_of(grid), Returns()
    returns.take_over(costmap, grid)
    returns.mark(costmap)
    assert np.argwhere(costmap.states == OCCUPIED).tolist() == [[20, 40], [20, 43]]


def test_marks_follow_a_growing_map() -> None:
    grid = OccupancyGrid()
    costmap, returns = costmap_of(grid), Returns()
    place = (1.03, -0.52)
    returns.note(costmap, view_of([place]))
    grid.cover(-9.0, 4.0, -8.0, 3.0)
    costmap.refresh(grid)
    returns.note(costmap, view_of([place]))
    assert costmap.states.shape != (0, 0)
    returns.mark(costmap)
    assert np.argwhere(costmap.states == OCCUPIED).tolist() == [
        costmap.world_to_cell(place).tolist()
    ]
    grid.cover(-20.0, 4.0, -8.0, 9.0)
    costmap.refresh(grid)
    assert not (costmap.states == OCCUPIED).any()
    returns.mark(costmap)
    assert np.argwhere(costmap.states == OCCUPIED).tolist() == [
        costmap.world_to_cell(place).tolist()
    ]


def test_returns_outside_the_map_and_before_there_is_one_are_ignored() -> None:
    returns, far = Returns(), view_of([(-0.01, 1.0), (4.01, 1.0), (1.0, -0.01), (1.0, 2.01)])
    returns.note(Costmap(), far)
    returns.mark(Costmap())
    assert occupied_after(far, far) == []


def unknown_with_returns(room: Room, poses: NDArray[np.float64], seed: int) -> Costmap:
    """A map that knows only the floor within 1 m of (3, 2) when some scans have come."""
    grid = OccupancyGrid()
    grid.cover(-1.0, 7.0, -1.0, 5.0)
    rows, columns = np.indices(grid.shape)
    x = grid.origin[0] + (columns + 0.5) * grid.resolution
    y = grid.origin[1] + (rows + 0.5) * grid.resolution
    grid.log_odds[np.hypot(x - 3.0, y - 2.0) < 1.0] = -5.0
    costmap, returns = costmap_of(grid), Returns()
    for view in views_of(room, poses, np.random.default_rng(seed)):
        returns.note(costmap, view)
    returns.mark(costmap)
    return costmap


@given(seed=st.integers(0, 10_000))
@settings(max_examples=8)
def test_a_robot_that_turns_about_marks_walls_where_they_are_and_no_door(seed: int) -> None:
    rng = np.random.default_rng(seed)
    door = rng.uniform(0.5, 3.0)
    walls = [box(4.6, -0.5, 0.1, door), box(4.6, door, 0.1, 4.5 - door), box(0.8, -0.5, 0.1, 5.0)]
    walls[0][:, [1, 3]] = np.clip(walls[0][:, [1, 3]], -0.5, door - 0.2)
    walls[1][:, [1, 3]] = np.clip(walls[1][:, [1, 3]], door + 0.2, 4.5)
    room = Room(walls=np.concatenate(walls))
    poses = np.column_stack((np.full(31, 3.0), np.full(31, 2.0), np.linspace(0.0, 2.0, 31)))
    costmap = unknown_with_returns(room, poses, seed)
    marked = costmap.cell_to_world(np.argwhere(costmap.states == OCCUPIED))
    assert len(marked) > 20
    gaps = np.array([room.clearance(place) for place in marked])
    # four sigmas of the lidar at 2.6 m and half a cell's diagonal
    assert gaps.max() < 4.0 * 0.035 / 3.0 * 2.6 + 0.036
    through = np.abs(marked - (4.65, door))
    assert not np.any((through[:, 0] < 0.15) & (through[:, 1] < 0.05))


def test_a_wall_in_the_last_free_cell_is_no_frontier_any_more() -> None:
    """Its surface lies just inside a cell whose greater part is free."""
    grid = grid_from_text("\n".join(["." * 30 + "?" * 10] * 60))
    wall = [(1.49, 0.01 + 0.05 * k) for k in range(60)]
    costmap, returns = costmap_of(grid), Returns()
    for _ in range(2):
        returns.note(costmap, view_of(wall))
    returns.mark(costmap)
    assert find_frontiers(costmap, FrontierConfig()) == []
    assert (costmap.states[:, :29] == FREE).all(), "the robot may stand beside it"


def test_a_wall_seen_through_a_thin_map_is_no_frontier_any_more() -> None:
    """Its returns lie 5 cm apart and the map's cells between them are unknown."""
    grid = grid_from_text("\n".join(["." * 30 + "?" * 10] * 60))
    wall = [(1.52, 0.01 + 0.05 * k) for k in range(60)]
    costmap, returns = costmap_of(grid), Returns()
    assert len(find_frontiers(costmap, FrontierConfig())) == 1
    for _ in range(2):
        returns.note(costmap, view_of(wall))
    returns.mark(costmap)
    assert find_frontiers(costmap, FrontierConfig()) == []
    assert (costmap.states[:, 32] == UNKNOWN).all()
