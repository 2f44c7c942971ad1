"""A robot of plain kinematics is driven through drawn rooms, with a perfect map."""

import numpy as np
import pytest
from numpy.typing import NDArray

from mapping.errors import TestbedError
from mapping.geometry import Pose, compose
from mapping.grid import OccupancyGrid
from nav.navigator import COMPLETE, RUNNING, STUCK
from nav.waypoints import Waypoints, WaypointsConfig
from tests.nav.grids import ROOM_WITH_UNKNOWN_EAST, grid_from_text

ROOM = "\n".join(["#" * 60] + ["#" + "." * 58 + "#"] * 58 + ["#" * 60])
"""3 x 3 m."""

SEPARATE = "\n".join(
    ["#" * 80] + ["#" + "." * 38 + "##" + "." * 38 + "#"] * 38 + ["#" * 80],
)
"""Two rooms of 2 x 2 m without a door."""


def tour(
    navigator: Waypoints, grid: OccupancyGrid, start: tuple[float, float, float], seconds: float
) -> Pose:
    """The poses ``(n, 3)`` until the navigator stops."""
    pose, poses = np.array(start), []
    for _ in range(round(10 * seconds)):
        twist = navigator.command(grid, pose, None)
        turn = 0.1 * twist.angular_z
        pose = compose(pose, (0.1 * twist.linear_x, 0.0, turn))
        poses.append(pose)
        if navigator.status != RUNNING:
            break
    return np.array(poses)


def first_near(poses: Pose, place: tuple[float, float]) -> int:
    gaps: NDArray[np.float64] = np.hypot(*(poses[:, :2] - place).T)
    return int(np.flatnonzero(gaps < 0.21)[0])


def test_places_are_passed_in_order_and_the_last_is_reached() -> None:
    places = [(2.5, 0.5), (2.5, 2.5), (0.5, 2.5), (1.5, 1.5)]
    poses = tour(navigator := Waypoints(places), grid_from_text(ROOM), (0.5, 0.5, 0.0), 120.0)
    assert navigator.status == COMPLETE
    visits = [first_near(poses, place) for place in places]
    assert visits == sorted(visits)
    assert np.hypot(*(poses[-1, :2] - places[-1])) <= WaypointsConfig().arrived
    assert navigator.plan.goal is None
    assert navigator.command(grid_from_text(ROOM), poses[-1], None).linear_x == 0.0


def test_the_same_place_may_come_again() -> None:
    places = [(2.5, 0.5), (0.5, 0.5), (2.5, 0.5)]
    poses = tour(navigator := Waypoints(places), grid_from_text(ROOM), (0.5, 0.5, 0.0), 120.0)
    assert navigator.status == COMPLETE
    assert np.abs(np.diff(poses[:, 0])).sum() > 5.0


def test_a_place_in_the_unknown_or_beyond_the_map_is_made_for() -> None:
    grid = grid_from_text(ROOM_WITH_UNKNOWN_EAST)
    poses = tour(navigator := Waypoints([(6.0, 1.0)]), grid, (1.0, 1.0, 0.0), 90.0)
    assert navigator.status == COMPLETE
    assert poses[-1, 0] > 5.8


def test_a_place_that_something_stands_on_is_made_for_as_near_as_may_be() -> None:
    grid = grid_from_text(ROOM)
    grid.log_odds[28:32, 28:32] = 5.0
    poses = tour(navigator := Waypoints([(1.5, 1.5)]), grid, (0.5, 0.5, 0.0), 60.0)
    assert navigator.status == COMPLETE
    assert np.hypot(*(poses[-1, :2] - 1.5)) < 0.45


def test_without_any_way_it_tries_and_is_stuck() -> None:
    navigator = Waypoints([(3.0, 1.0)])
    tour(navigator, grid_from_text(SEPARATE), (1.0, 1.0, 0.0), 300.0)
    assert navigator.status == STUCK


def test_after_a_redraw_it_plans_on_the_new_map() -> None:
    """A wall comes, with a door where there was none: the old way would lead into it."""
    navigator, grid = Waypoints([(2.5, 0.5)]), grid_from_text(ROOM)
    tour(navigator, grid, (0.5, 0.5, 0.0), 3.0)
    before = navigator.plan.path
    assert np.abs(before[:, 1] - 0.5).max() < 0.1
    redrawn = grid_from_text(ROOM)
    redrawn.redraws = 1
    redrawn.log_odds[:45, 30:32] = 5.0
    navigator.command(redrawn, np.array([0.8, 0.5, 0.0]), None)
    assert navigator.plan.path[:, 1].max() > 2.25


def test_distances_at_which_nothing_is_reached_are_refused() -> None:
    with pytest.raises(TestbedError, match="waypoints passed: 0"):
        WaypointsConfig(passed=0.0)
