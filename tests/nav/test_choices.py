"""Deciding, giving up, recovering, noticing lost headway: the explorer's smaller parts."""

import numpy as np
import pytest

from mapping.errors import TestbedError
from mapping.grid import OccupancyGrid
from mapping.messages import LaserScan
from nav.decision import DecisionConfig, choose
from nav.frontier import Frontier
from nav.given_up import GivenUp
from nav.headway import Headway, HeadwayConfig
from nav.navigators import make_navigator
from nav.reactive import Reactive
from nav.recovery import Recovery, open_heading
from nav.viewpoint import Viewpoint


def frontier_at(x: float, y: float) -> Frontier:
    return Frontier(cells=np.zeros((4, 2), dtype=np.int64), middle=np.array([x, y]), size=0.2)


def viewpoint_at(x: float, y: float, gain: float) -> Viewpoint:
    place = np.array([x, y])
    return Viewpoint(
        place=place, frontier=frontier_at(x, y), gain=gain, cost=float(np.hypot(*place))
    )


def test_of_two_equal_gains_the_nearer_is_chosen() -> None:
    near, far = viewpoint_at(1.0, 0.0, 1.0), viewpoint_at(3.0, 0.0, 1.0)
    assert choose([far, near], OPEN_FIELD, np.zeros(3), None, DecisionConfig()) is near


def test_a_slightly_better_frontier_does_not_make_the_robot_turn_back() -> None:
    here, there = viewpoint_at(1.0, 0.0, 1.0), viewpoint_at(1.0, 1.0, 1.3)
    config = DecisionConfig()
    assert (
        choose([here, there], OPEN_FIELD, np.zeros(3), None, config) is there
        or config.loyalty > 1.0
    )
    assert choose([here, there], OPEN_FIELD, np.zeros(3), here, config) is here


def test_of_no_viewpoints_none_is_chosen() -> None:
    assert choose([], OPEN_FIELD, np.zeros(3), None, DecisionConfig()) is None


def test_a_frontier_given_up_gets_one_second_chance_and_keeps_its_last_reason() -> None:
    given_up = GivenUp()
    frontier = frontier_at(2.0, 1.0)
    given_up.give_up(frontier, "first")
    assert given_up.holds(frontier_at(2.1, 1.1))
    assert not given_up.holds(frontier_at(4.0, 1.0))
    assert given_up.second_chance()
    assert not given_up.holds(frontier)
    given_up.give_up(frontier, "second")
    assert given_up.holds(frontier)
    assert not given_up.second_chance()
    (left,) = given_up.left_over([frontier, frontier_at(9.0, 9.0)])
    assert (left.x, left.y, left.reason) == (2.0, 1.0, "second")


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
        twist = recovery.command(pose, points, 0.1)
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
    with pytest.raises(TestbedError, match="frontier, reactive"):
        make_navigator("magic")
