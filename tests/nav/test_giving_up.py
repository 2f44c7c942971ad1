"""A robot that gets nowhere gives the frontier up, says why, and looks for another way."""

from collections.abc import Callable

import numpy as np

from mapping.geometry import Pose, compose
from mapping.grid import OccupancyGrid
from nav.closed_gaps import RADIUS, ClosedGaps
from nav.explorer import NO_HEADWAY, FrontierExplorer
from nav.navigator import COMPLETE, RUNNING, UNREACHABLE_START
from nav.planner import CostField
from tests.nav.grids import ROOM_WITH_UNKNOWN_EAST, costmap_of, grid_from_text

MOST_PERIODS, PERIOD = 6000, 0.1

TWO_WAYS = "\n".join(
    ["#" * 100]
    + ["#" + "." * 39 + "#" + "." * 39 + "?" * 20] * 13
    + ["#" + "." * 79 + "?" * 20] * 6
    + ["#" + "." * 39 + "#" + "." * 39 + "?" * 20] * 23
    + ["#" + "." * 79 + "?" * 20] * 12
    + ["#" + "." * 39 + "#" + "." * 39 + "?" * 20] * 10
    + ["#" * 100]
)
"""Two rooms of 2 m with a door of 0.3 m and one of 0.6 m between them; then it is unknown."""


def drive(
    explorer: FrontierExplorer, grid: OccupancyGrid, pose: Pose, may_stand: Callable[[Pose], bool]
) -> list[Pose]:
    """Drive as commanded wherever the robot may stand, until it is done or for ten minutes."""
    track = [pose]
    for _ in range(MOST_PERIODS):
        twist = explorer.command(grid, pose, None)
        if explorer.status != RUNNING:
            break
        turned = np.array([0.0, 0.0, twist.angular_z * PERIOD])
        moved = compose(compose(pose, turned), np.array([twist.linear_x * PERIOD, 0.0, 0.0]))
        pose = moved if may_stand(moved) else pose
        track.append(pose)
    return track


def test_recoveries_on_the_way_to_one_frontier_add_up_until_it_is_given_up() -> None:
    """The wheels turn in vain: whatever it commands, it stays where it began."""
    explorer = FrontierExplorer()
    drive(
        explorer,
        grid_from_text(ROOM_WITH_UNKNOWN_EAST),
        np.array([0.8, 1.0, 0.0]),
        lambda pose: False,
    )
    assert explorer.status == COMPLETE, "it stands where it began: at home"
    assert {dropped.reason for dropped in explorer.dropped_frontiers} == {NO_HEADWAY}


def test_a_door_that_lets_nobody_through_is_closed_and_the_other_one_taken() -> None:
    """The nearer door has a pane that neither map nor lidar shows."""
    explorer, grid = FrontierExplorer(), grid_from_text(TWO_WAYS)
    track = drive(
        explorer,
        grid,
        np.array([1.0, 2.4, 0.0]),
        lambda pose: not (abs(pose[0] - 2.02) < 0.15 and pose[1] > 1.6),
    )
    assert max(pose[0] for pose in track) > 2.5
    assert explorer.status != RUNNING


def test_a_robot_that_its_map_knows_nothing_around_of_waits_for_the_map_and_gives_nothing_up() -> (
    None
):
    """Where it stands in the right half of a hall the map is blank for a while."""
    hall = ["#" * 180] + ["#" + "." * 160 + "?" * 19] * 100 + ["#" * 180]
    whole = grid_from_text("\n".join(hall))
    blank = grid_from_text("\n".join(row[:80] + "?" * 100 for row in hall))
    whole.redraws = blank.redraws + 1
    explorer, pose = FrontierExplorer(), np.array([5.2, 2.5, 0.0])
    for _ in range(60):
        explorer.command(blank, pose, None)
    assert explorer.status == RUNNING
    track = drive(explorer, whole, pose, lambda pose: True)
    assert max(place[0] for place in track) > 6.5, "it went on to the frontier"


def test_a_robot_shut_in_that_sees_out_tries_to_get_free_and_then_says_so() -> None:
    """A cage of 0.5 m whose bars let the lidar see the hall."""
    hall = [list("#" + "." * 98 + "#") for _ in range(60)]
    for k in range(10):
        for row, column in ((25, 20 + k), (34, 20 + k), (25 + k, 20), (25 + k, 29)):
            hall[row][column] = "#"
    explorer = FrontierExplorer()
    cage = grid_from_text("\n".join(map("".join, hall)))
    drive(explorer, cage, np.array([1.25, 1.5, 0.0]), lambda pose: False)
    assert explorer.status == UNREACHABLE_START


def test_no_way_leads_through_a_closed_gap_until_it_is_opened_again() -> None:
    grid, gaps = grid_from_text(TWO_WAYS), ClosedGaps()
    assert not gaps.reopen()
    costmap = costmap_of(grid)
    beyond = (3.0, 2.4)
    direct = CostField.around(costmap, (1.0, 2.4)).cost_at(beyond)
    for y in (2.3, 2.4, 2.5):
        gaps.close(np.array([2.0, y]))
    gaps.mark(costmap)
    assert CostField.around(costmap, (1.0, 2.4)).cost_at(beyond) > direct + 1.0
    for y in (0.55, 0.8, 1.05):
        gaps.close(np.array([2.0, y]))
    gaps.mark(costmap)
    assert not CostField.around(costmap, (1.0, 2.4)).reaches(beyond)
    assert gaps.reopen()
    costmap.refresh(grid)
    gaps.mark(costmap)
    assert CostField.around(costmap, (1.0, 2.4)).cost_at(beyond) == direct


def test_gaps_at_the_edge_of_the_map_and_beyond_it_are_no_trouble() -> None:
    costmap, gaps = costmap_of(grid_from_text(TWO_WAYS)), ClosedGaps()
    closed = int(np.isinf(costmap.cost).sum())
    gaps.close(np.array([-1.0, 99.0]))
    gaps.mark(costmap)
    assert np.isinf(costmap.cost).sum() == closed
    gaps.close(np.array([2.5, 1.6]))
    gaps.mark(costmap)
    added = (np.isinf(costmap.cost).sum() - closed) * costmap.resolution**2
    assert abs(added - np.pi * RADIUS**2) < 0.3 * np.pi * RADIUS**2
