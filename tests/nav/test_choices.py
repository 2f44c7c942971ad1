"""Deciding, giving up, recovering, noticing lost headway: the explorer's smaller parts."""

from typing import Any

import numpy as np
import pytest

from mapping.errors import TestbedError
from mapping.grid import OccupancyGrid
from mapping.messages import LaserScan
from nav.decision import GAIN_RATE, TOUR, DecisionConfig, choose
from nav.frontier import Frontier
from nav.given_up import GivenUp
from nav.headway import Headway, HeadwayConfig
from nav.loyalty import Loyalty
from nav.navigators import make_navigator
from nav.planner import CostField
from nav.reactive import Reactive
from nav.recovery import Recovery, open_heading
from nav.spot_turn import SpotTurn
from nav.viewpoint import Viewpoint
from nav.visited_places import VisitedPlaces
from tests.nav.grids import costmap_of, grid_from_log_odds


def frontier_at(x: float, y: float) -> Frontier:
    return Frontier(cells=np.zeros((4, 2), dtype=np.int64), middle=np.array([x, y]), size=0.2)


def viewpoint_at(x: float, y: float, gain: float) -> Viewpoint:
    place = np.array([x, y])
    cost = OPEN_FIELD.cost_at(place)
    return Viewpoint(place=place, frontier=frontier_at(x, y), gain=gain, cost=cost)


OPEN_FIELD = CostField.around(
    costmap_of(grid_from_log_odds(np.full((200, 200), -5.0), 0.05)), (5.0, 5.0)
)
MIDDLE = np.array([5.0, 5.0, 0.0])


def choice(
    *viewpoints: Viewpoint, current: Viewpoint | None = None, rule: str = GAIN_RATE
) -> Viewpoint | None:
    return choose(viewpoints, OPEN_FIELD, MIDDLE, current, DecisionConfig(rule=rule))


@pytest.mark.parametrize("rule", [GAIN_RATE, TOUR])
def test_of_two_equal_gains_the_nearer_is_chosen(rule: str) -> None:
    near, far = viewpoint_at(6.0, 5.0, 1.0), viewpoint_at(8.0, 5.0, 1.0)
    assert choice(far, near, rule=rule) is near


@pytest.mark.parametrize("rule", [GAIN_RATE, TOUR])
def test_of_two_equally_far_the_one_that_shows_more_is_chosen(rule: str) -> None:
    less, more = viewpoint_at(7.0, 6.0, 1.0), viewpoint_at(7.0, 4.0, 2.0)
    assert choice(less, more, rule=rule) is more


def test_four_times_as_much_is_worth_three_times_the_way_and_not_five_times() -> None:
    near = viewpoint_at(6.0, 5.0, 1.0)
    assert choice(near, viewpoint_at(8.0, 5.0, 4.0)) is not near
    assert choice(near, viewpoint_at(9.9, 5.0, 4.0)) is near
    assert choice(near, viewpoint_at(9.9, 5.0, 40.0)) is not near


def test_of_two_equals_the_one_ahead_is_chosen() -> None:
    ahead, behind = viewpoint_at(7.0, 5.0, gain=1.0), viewpoint_at(3.0, 5.0, gain=1.0)
    assert choice(behind, ahead) is ahead


def test_more_than_can_be_known_of_far_space_counts_no_more() -> None:
    near, far = viewpoint_at(6.0, 5.0, gain=6.0), viewpoint_at(8.0, 5.0, gain=60.0)
    assert choice(far, near) is near


def test_on_a_tour_much_to_see_far_off_waits_for_a_crumb_on_the_way() -> None:
    crumb, room = viewpoint_at(6.0, 5.0, 0.3), viewpoint_at(9.0, 5.0, 4.0)
    assert choice(crumb, room, rule=TOUR) is crumb
    behind = viewpoint_at(2.0, 5.0, 0.3)
    assert choice(behind, room, rule=TOUR) is room


@pytest.mark.parametrize(("rule", "gain"), [(GAIN_RATE, 1.5), (TOUR, 3.0)])
def test_a_slightly_better_frontier_does_not_make_the_robot_turn_back(
    rule: str, gain: float
) -> None:
    here, there = viewpoint_at(6.0, 5.0, 1.0), viewpoint_at(4.2, 5.0, gain)
    assert choice(here, there, rule=rule) is there
    assert choice(here, there, current=here, rule=rule) is here


def test_a_robot_that_changed_its_mind_in_vain_grows_loyal() -> None:
    here, there = viewpoint_at(8.0, 5.0, 1.0), viewpoint_at(4.0, 5.0, 1.5)
    assert choice(here, there, current=here) is there
    loyalty = Loyalty()
    for current, chosen in ((here, there), (there, here), (here, there)):
        loyalty.note(current, chosen, area=10.0)
    assert loyalty.times == 8.0
    assert choose([here, there], OPEN_FIELD, MIDDLE, here, DecisionConfig(), loyalty.times) is here
    loyalty.note(here, here, area=11.0)
    assert loyalty.times == 1.0, "it has seen something new since"


def test_going_on_and_setting_out_are_no_changes_of_mind() -> None:
    loyalty, here = Loyalty(), viewpoint_at(6.0, 5.0, 1.0)
    for current, chosen in ((None, here), (here, here), (here, None)):
        loyalty.note(current, chosen, area=0.0)
    assert loyalty.times == 1.0


@pytest.mark.parametrize(
    "settings",
    [{"settling_way": 0.0}, {"most_gain": float("nan")}, {"turning_way": -0.1}, {"rule": "best"}],
)
def test_settings_that_decide_nothing_are_refused(settings: dict[str, Any]) -> None:
    with pytest.raises(TestbedError, match=next(iter(settings))):
        DecisionConfig(**settings)


def test_of_no_viewpoints_none_is_chosen() -> None:
    assert choice() is None


def test_of_more_viewpoints_than_are_toured_one_is_chosen_all_the_same() -> None:
    many = [viewpoint_at(1.0 + 0.1 * k, 3.0, 1.0) for k in range(60)]
    assert choice(*many, rule=TOUR) in many


def test_two_disappointments_make_a_frontier_given_up() -> None:
    given_up, viewpoint = GivenUp(), viewpoint_at(1.0, 1.0, 1.0)
    given_up.disappoint(viewpoint, "nothing new")
    assert not given_up.holds(viewpoint.frontier)
    given_up.disappoint(viewpoint, "nothing new")
    assert given_up.holds(viewpoint.frontier)


def test_views_from_beside_a_doorway_do_not_make_it_given_up() -> None:
    given_up, doorway = GivenUp(), frontier_at(1.0, 1.0)
    for gain in (0.2, 0.3, 0.4, 0.5):
        beside = Viewpoint(place=doorway.middle, frontier=doorway, gain=gain, cost=1.0, rival=1.7)
        given_up.disappoint(beside, "nothing new")
    assert not given_up.holds(doorway)
    through = Viewpoint(place=doorway.middle, frontier=doorway, gain=1.7, cost=1.0, rival=0.5)
    given_up.disappoint(through, "nothing new")
    given_up.disappoint(through, "nothing new")
    assert given_up.holds(doorway)


def test_after_a_view_in_vain_only_better_views_of_the_frontier_count_while_there_are_any() -> None:
    given_up, doorway, elsewhere = GivenUp(), frontier_at(1.0, 1.0), frontier_at(3.0, 1.0)

    def view(frontier: Frontier, gain: float) -> Viewpoint:
        return Viewpoint(place=frontier.middle, frontier=frontier, gain=gain, cost=1.0)

    beside, nearly, through = (view(doorway, gain) for gain in (0.40, 0.45, 1.70))
    other = view(elsewhere, 0.30)
    everything = [nearly, through, beside, other]
    assert given_up.not_in_vain(everything) == everything
    given_up.disappoint(beside, "nothing new")
    assert given_up.not_in_vain(everything) == [through, other]
    assert given_up.not_in_vain([beside, other, nearly]) == [beside, other, nearly]


def test_marks_keep_their_places_when_the_map_grows() -> None:
    grid = OccupancyGrid()
    costmap = costmap_of(grid)
    visited = VisitedPlaces()
    visited.note(costmap, (1.0, -0.5))
    grid.cover(-4.0, 1.0, -4.0, 1.0)
    costmap.refresh(grid)
    marks = visited.on(costmap)
    assert marks.shape == costmap.states.shape
    assert marks[tuple(costmap.world_to_cell((1.1, -0.5)))]
    assert not marks[tuple(costmap.world_to_cell((1.4, -0.5)))]


def test_a_blocked_turn_is_tried_the_other_way_round() -> None:
    turn = SpotTurn()
    turn.begin(1.0, 0.0)
    directions = [turn.update(0.0, 0.1) for _ in range(10)]
    assert directions[:5] == [1.0] * 5
    assert directions[-1] == -1.0
    turn.begin(1.0, 0.0)
    assert [turn.update(0.1 * k, 0.1) for k in range(1, 20)] == [1.0] * 19


def test_a_frontier_given_up_gets_one_second_chance_and_keeps_its_last_reason() -> None:
    given_up = GivenUp()
    frontier = frontier_at(2.0, 1.0)
    given_up.give_up(frontier, "first")
    assert given_up.holds(frontier_at(2.1, 1.1))
    assert not given_up.holds(frontier_at(4.0, 1.0))
    assert given_up.another_chance(2)
    assert not given_up.holds(frontier)
    given_up.give_up(frontier, "second")
    assert given_up.holds(frontier)
    assert not given_up.another_chance(2)
    (left,) = given_up.left_over([frontier, frontier_at(9.0, 9.0)])
    assert (left.x, left.y, left.reason) == (2.0, 1.0, "second")


def test_a_place_left_over_is_told_once_however_many_borders_it_has() -> None:
    border, opening, other = frontier_at(2.0, 1.0), frontier_at(2.2, 1.1), frontier_at(2.0, 2.0)
    left = GivenUp().left_over([border, opening, other], "no time")
    assert [(each.x, each.y) for each in left] == [(2.0, 1.0), (2.0, 2.0)]


def test_standing_still_loses_headway_after_its_patience_and_moving_keeps_it() -> None:
    headway = Headway(HeadwayConfig(patience=2.0))
    assert not any(headway.is_lost(np.array([0.02 * k, 0.0, 0.0]), 0.1) for k in range(100))
    lost = [headway.is_lost(np.array([2.0, 0.0, 0.0]), 0.1) for _ in range(25)]
    assert not any(lost[:19])
    assert lost[-1]


def test_turning_for_ever_on_one_spot_is_no_headway() -> None:
    headway = Headway(HeadwayConfig(turning_patience=5.0))
    assert any(headway.is_lost(np.array([0.0, 0.0, 0.1 * k % 3.0]), 0.1) for k in range(60))


def test_the_open_side_is_the_one_without_points() -> None:
    angles = np.radians(np.arange(-120, 121))
    points = 0.3 * np.column_stack((np.cos(angles), np.sin(angles)))
    assert abs(open_heading(np.zeros(3), points, view=1.0)) == pytest.approx(np.pi, abs=0.3)


def test_a_recovery_backs_off_then_turns_then_ends() -> None:
    recovery = Recovery()
    pose = np.zeros(3)
    angles = np.radians(np.arange(-90, 91))
    points = 0.2 * np.column_stack((np.cos(angles), np.sin(angles)))
    recovery.begin(pose)
    kinds = []
    for _ in range(120):
        twist = recovery.command(pose, points, OccupancyGrid(), 0.1)
        if twist is None:
            break
        kinds.append("back" if twist.linear_x < 0.0 else "turn")
        pose = pose + [
            0.1 * twist.linear_x * np.cos(pose[2]),
            0.1 * twist.linear_x * np.sin(pose[2]),
            0.1 * twist.angular_z,
        ]
    assert kinds[0] == "back"
    assert kinds[-1] == "turn"
    assert not recovery.active


@pytest.mark.parametrize("gear", [1.0, -1.0])
def test_a_recovery_backs_off_to_where_the_robot_came_from(gear: float) -> None:
    recovery = Recovery()
    recovery.begin(np.zeros(3), gear=gear)
    twist = recovery.command(np.zeros(3), np.zeros((0, 2)), OccupancyGrid(), 0.1)
    assert twist is not None
    assert gear * twist.linear_x < 0.0


def scan_with(ahead: float, left: float, right: float) -> LaserScan:
    ranges = np.full(360, 3.0, dtype=np.float32)
    ranges[:30], ranges[-30:] = ahead, ahead
    ranges[30:90], ranges[-90:-30] = left, right
    return LaserScan(stamp=0.0, ranges=ranges)


def test_the_reactive_navigator_drives_when_it_is_open_and_turns_to_the_open_side() -> None:
    grid, pose = OccupancyGrid(), np.zeros(3)
    assert Reactive().command(grid, pose, scan_with(3.0, 1.0, 1.0)).linear_x > 0.0
    assert Reactive().command(grid, pose, scan_with(0.25, 2.0, 0.4)).angular_z > 0.0
    assert Reactive().command(grid, pose, scan_with(0.25, 0.4, 2.0)).angular_z < 0.0


def test_an_unknown_navigator_is_refused_with_the_known_names() -> None:
    with pytest.raises(
        TestbedError, match="frontier, tour, nearest, explore_lite, gain_cost, reactive, waypoints"
    ):
        make_navigator("magic")
