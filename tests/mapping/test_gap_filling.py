"""Gap filling: what each rule joins, what it must leave alone, and what no rule may close."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray
from scipy import ndimage

from mapping.errors import TestbedError
from mapping.gap_filling import GapFilling, fill_gaps, with_gaps_filled
from mapping.grid import FREE, OCCUPIED, UNKNOWN, GridConfig, OccupancyGrid

CELL = 0.01
RULES: tuple[GapFilling, ...] = ("thesis", "better")
States = NDArray[np.int8]
Mask = NDArray[np.bool_]


def unknown(rows: int, columns: int) -> States:
    return np.full((rows, columns), UNKNOWN, dtype=np.int8)


def put_wall(states: States, start: tuple[float, float], end: tuple[float, float]) -> None:
    """Draw a wall, 2 cells thick, between two places (row, column)."""
    way = np.linspace(start, end, 4 * int(np.hypot(*np.subtract(end, start))) + 1)
    for row, column in np.floor(way).astype(int):
        states[row : row + 2, column : column + 2] = OCCUPIED


def two_rooms(door: int, door_state: int = FREE, thickness: int = 8) -> States:
    """Two rooms of 1.2 x 1 m with a door of so many cells in the wall between them."""
    states = np.full((124, 220 + thickness), FREE, dtype=np.int8)
    states[[0, 1, -1, -2]] = states[:, [0, 1, -1, -2]] = OCCUPIED
    wall = slice(110, 110 + thickness)
    states[:, wall] = UNKNOWN
    states[:, [110, 109 + thickness]] = OCCUPIED
    first = 62 - door // 2
    states[first : first + door, wall] = door_state
    states[[first - 1, first + door], wall] = OCCUPIED
    return states


def rooms_connected(states: States, radius: float = 0.089) -> bool:
    """Whether a disc can go from the left room of ``two_rooms`` to the right one.

    Its centre may stand on edges between cells, so the map is looked at in cells half as wide.
    """
    fine = np.kron(states == OCCUPIED, np.ones((2, 2)))[:-1, :-1]
    distance = np.asarray(ndimage.distance_transform_edt(fine == 0)) - 0.5
    labels, _ = ndimage.label(distance >= 2.0 * radius / CELL - 1.0)
    left, right = labels[80, 100], labels[80, -100]
    return bool(left == right != 0)


def filled_map(states: States, rule: GapFilling) -> States:
    return np.where(fill_gaps(states, CELL, rule), np.int8(OCCUPIED), states)


@st.composite
def maps(draw: st.DrawFn) -> States:
    """Walls at any angle, with holes and specks, before free and unknown ground."""
    rng = np.random.default_rng(draw(st.integers(0, 2**32 - 1)))
    states = unknown(90, 110)
    for _ in range(draw(st.integers(0, 2))):
        row, column = rng.integers(0, 60), rng.integers(0, 80)
        states[row : row + rng.integers(5, 60), column : column + rng.integers(5, 60)] = FREE
    for _ in range(draw(st.integers(1, 4))):
        ends = rng.uniform((2, 2), (86, 106), (2, 2))
        pieces = np.sort(rng.uniform(0.0, 1.0, 4))
        for first, last in (pieces[:2], pieces[2:]):
            one, two = ends[0] + (ends[1] - ends[0]) * np.array([[first], [last]])
            put_wall(states, tuple(one), tuple(two))
    specks = rng.integers(0, (90, 110), (draw(st.integers(0, 30)), 2))
    states[specks[:, 0], specks[:, 1]] = rng.choice([FREE, UNKNOWN, OCCUPIED], len(specks))
    return states


@given(states=maps())
@settings(max_examples=40, deadline=None)
def test_filling_twice_by_the_better_rule_equals_once(states: States) -> None:
    assert not fill_gaps(filled_map(states, "better"), CELL, "better").any()


@given(states=maps())
@settings(max_examples=40, deadline=None)
def test_the_better_rule_fills_unknown_cells_only(states: States) -> None:
    assert np.all(states[fill_gaps(states, CELL, "better")] == UNKNOWN)


@given(states=maps(), rule=st.sampled_from(RULES), turns=st.integers(0, 3), flip=st.booleans())
@settings(max_examples=60, deadline=None)
def test_a_map_that_is_turned_or_mirrored_is_filled_alike(
    states: States, rule: GapFilling, turns: int, flip: bool
) -> None:
    def turned(mask: NDArray[np.generic]) -> NDArray[np.generic]:
        return np.rot90(mask[:, ::-1] if flip else mask, turns)

    other = np.ascontiguousarray(turned(states)).astype(np.int8)
    assert np.array_equal(fill_gaps(other, CELL, rule), turned(fill_gaps(states, CELL, rule)))


@pytest.mark.parametrize("rule", RULES)
@pytest.mark.parametrize("door_state", [FREE, UNKNOWN])
@pytest.mark.parametrize("door", [18, 19, 30, 49])
@pytest.mark.parametrize("thickness", [1, 8])
def test_a_passage_of_the_robots_width_or_more_stays_open(
    rule: GapFilling, door: int, door_state: int, thickness: int
) -> None:
    for states in (two_rooms(door, door_state, thickness),):
        assert rooms_connected(states)
        assert rooms_connected(filled_map(states, rule))
        upright = filled_map(np.ascontiguousarray(states.T), rule).T
        assert rooms_connected(np.asarray(upright))


@pytest.mark.parametrize("rule", RULES)
def test_a_second_door_does_not_make_up_for_the_first(rule: GapFilling) -> None:
    states = two_rooms(20)
    states[90:112, 110:118] = FREE
    filled = filled_map(states, rule)
    one, two = filled.copy(), filled.copy()
    one[85:, 110:118] = OCCUPIED
    two[:85, 110:118] = OCCUPIED
    assert rooms_connected(one)
    assert rooms_connected(two)


def test_a_narrower_door_is_closed_by_the_thesis_rule_and_by_the_better_one_if_unseen() -> None:
    assert not rooms_connected(filled_map(two_rooms(12), "thesis"))
    assert not fill_gaps(two_rooms(12, FREE, 1), CELL, "better").any()
    seen_through = filled_map(two_rooms(12), "better")
    assert np.all(seen_through[two_rooms(12) == FREE] == FREE)


def test_the_thesis_joins_cells_up_to_5_cells_off_at_any_angle_and_up_to_50_along_rows() -> None:
    states = unknown(40, 120)
    states[10, 10] = states[15, 13] = states[30, 20] = states[30, 70] = OCCUPIED
    states[5, 40] = states[11, 46] = states[20, 60] = states[20, 111] = OCCUPIED
    filled = fill_gaps(states, CELL, "thesis")
    assert filled[30, 21:70].all(), "50 cells apart in a row"
    assert filled[11:15].sum() >= 4, "5 and 3 cells apart"
    assert not filled[5:11, 40:47].any(), "6 cells apart and not in a row"
    assert not filled[20].any(), "51 cells apart in a row"


def test_the_thesis_rule_makes_a_trash_can_near_a_wall_a_part_of_it() -> None:
    states = np.full((120, 120), FREE, dtype=np.int8)
    states[:, :3] = OCCUPIED
    rows, columns = np.indices(states.shape)
    states[np.hypot(rows - 60, columns - 30) < 15.0] = OCCUPIED  # 12 cm from the wall, fig. 5.5
    assert filled_map(states, "thesis")[55:65, 3:15].min() == OCCUPIED
    assert not fill_gaps(states, CELL, "better").any(), "beams passed between them"


@pytest.mark.parametrize("angle_deg", [0.0, 17.0, 45.0, 62.0, 90.0])
@pytest.mark.parametrize("hole", [6, 14, 40])
def test_the_better_rule_closes_an_unseen_hole_of_a_straight_wall(
    angle_deg: float, hole: int
) -> None:
    states = unknown(160, 160)
    along = np.array([np.sin(np.radians(angle_deg)), np.cos(np.radians(angle_deg))])
    for first, last in ((-70.0, -0.5 * hole), (0.5 * hole, 70.0)):
        put_wall(states, tuple(79.0 + first * along), tuple(79.0 + last * along))
    filled = filled_map(states, "better") == OCCUPIED
    _, pieces = ndimage.label(filled, np.ones((3, 3)))
    assert pieces == 1, "the wall is whole"
    drawn = np.argwhere(fill_gaps(states, CELL, "better")) - 79.5
    across = np.abs(drawn[:, 0] * along[1] - drawn[:, 1] * along[0])
    assert across.max() <= 2.5, "and straight"


def test_the_better_rule_draws_two_walls_out_to_their_corner() -> None:
    states = unknown(100, 100)
    put_wall(states, (10.0, 10.0), (10.0, 60.0))
    put_wall(states, (40.0, 85.0), (90.0, 85.0))
    filled = filled_map(states, "better") == OCCUPIED
    assert filled[10, 10:86].all()
    assert filled[10:90, 85].all()


def test_the_better_rule_draws_a_wall_on_to_what_it_meets_and_nowhere_else() -> None:
    states = unknown(120, 120)
    put_wall(states, (10.0, 30.0), (60.0, 30.0))
    assert not fill_gaps(states, CELL, "better").any(), "it may end there"
    put_wall(states, (80.0, 5.0), (80.0, 110.0))
    assert fill_gaps(states, CELL, "better")[62:80, 30].all()
    states[70, :] = FREE
    assert not fill_gaps(states, CELL, "better").any(), "beams passed there"


def test_the_edge_of_a_round_things_shadow_is_not_taken_for_a_wall() -> None:
    states = np.full((120, 160), FREE, dtype=np.int8)
    rows, columns = np.indices(states.shape)
    distance = np.hypot(rows - 60, columns - 60)
    states[(np.abs(rows - 60) <= 20) & (columns > 60)] = UNKNOWN
    states[distance < 20.0] = UNKNOWN
    states[(np.abs(distance - 19.0) < 1.0) & (columns < 64)] = OCCUPIED
    states[:, 100:] = OCCUPIED
    assert not fill_gaps(states, CELL, "better")[:, 80:].any()


def test_the_map_keeps_its_cells_and_gains_occupied_ones() -> None:
    grid = OccupancyGrid(GridConfig(rows=60, columns=60, grows=False))
    grid.log_odds[10, 10:30] = grid.log_odds[10, 36:56] = 5.0
    before = grid.log_odds.copy()
    copy = with_gaps_filled(grid, "better")
    assert np.array_equal(grid.log_odds, before), "the map that the robot drives by stays"
    assert np.all(copy.states()[10, 30:36] == OCCUPIED)
    copy.log_odds[10, 30:36] = 0.0
    assert np.array_equal(copy.log_odds, before)
    assert with_gaps_filled(grid, "none") is grid


@pytest.mark.parametrize("rule", ["none", "thesis", "better"])
def test_a_map_of_nothing_or_of_one_cell_has_no_gaps(rule: GapFilling) -> None:
    assert not fill_gaps(unknown(5, 7), CELL, rule).any()
    states = unknown(5, 7)
    states[4, 6] = OCCUPIED
    assert not fill_gaps(states, CELL, rule).any()


@pytest.mark.parametrize("rule", RULES)
def test_cells_of_5_cm_are_filled_by_the_same_lengths(rule: GapFilling) -> None:
    states = unknown(40, 60)
    put_wall(states, (10.0, 2.0), (10.0, 24.0))
    put_wall(states, (10.0, 31.0), (10.0, 50.0))
    assert fill_gaps(states, 0.05, rule)[10, 27:30].all(), "0.25 m"
    states[:, 34:38] = UNKNOWN
    states[10:12, 26:34] = UNKNOWN
    assert not fill_gaps(states, 0.05, rule).any(), "0.6 m"


def test_a_rule_that_there_is_not_is_told() -> None:
    with pytest.raises(TestbedError, match="gap_filling: 'worse'; must be one of none, thesis"):
        fill_gaps(unknown(3, 3), CELL, "worse")  # type: ignore[arg-type]
