"""The way through a gap that a robot cannot follow its path through."""

import math

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray
from shapely import Point

from mapping.geometry import Pose
from mapping.grid import OccupancyGrid
from nav.manoeuvre import ManoeuvreConfig, plan_manoeuvre
from nav.manoeuvre_drive import ManoeuvreDrive
from nav.recovery import Recovery
from nav.safety import Safety, SafetyConfig
from tests.nav.slots import Passage, driven, outline_at

PERIOD = 0.1
NOISE = 0.0033
"""Standard deviation of the lidar close by [m]."""
FORTH = np.column_stack((np.arange(-0.1, 2.0, 0.05), np.zeros(42)))
"""The path through the passage."""


@given(
    width=st.floats(0.255, 0.3),
    length=st.floats(0.1, 0.4),
    x=st.floats(-0.25, -0.05),
    y=st.floats(-0.02, 0.1),
    yaw=st.floats(-0.7, 0.7),
    seed=st.integers(0, 1000),
)
@settings(max_examples=30, deadline=None)
def test_a_robot_before_a_gap_that_it_fits_through_gets_through_without_touching(
    width: float, length: float, x: float, y: float, yaw: float, seed: int
) -> None:
    passage, pose = Passage(width, length), np.array([x, y, yaw])
    assume(outline_at(pose).distance(passage.lines) > 0.012)
    end, nearest = recovered(passage, pose, np.random.default_rng(seed))
    assert nearest > 0.004
    assert end[0] > length, "beyond the first cupboard"
    assert passage.lines.distance(Point(end[:2])) > 0.13, "where it can turn"


def recovered(passage: Passage, pose: Pose, rng: np.random.Generator) -> tuple[Pose, float]:
    """Where the second recovery in a row ends, and how near it comes to anything."""
    recovery, safety, grid, walls = Recovery(), Safety(), OccupancyGrid(), passage.lines
    points, nearest = seen(passage, rng), math.inf
    recovery.begin(pose, 2, FORTH)
    for k in range(1200):
        if k % 2 == 0:
            points = seen(passage, rng)
        twist = recovery.command(pose, points, grid, PERIOD)
        if twist is None:
            break
        pose = driven(pose, safety.limit(twist, pose, points, grid), PERIOD)
        nearest = min(nearest, outline_at(pose).distance(walls))
    assert not recovery.active
    return pose, nearest


def seen(passage: Passage, rng: np.random.Generator) -> NDArray[np.float64]:
    points = passage.points
    return points + rng.normal(0.0, NOISE / math.sqrt(2.0), points.shape)


def legs_to(pose: Pose, passage: Passage, wanted: NDArray[np.float64]) -> tuple[object, ...]:
    return plan_manoeuvre(
        pose, passage.points, OccupancyGrid(), ManoeuvreConfig(), SafetyConfig(), wanted=wanted
    )


def test_the_way_ends_near_a_wanted_place_or_there_is_none() -> None:
    pose = np.array([-0.1, 0.02, 0.2])
    wanted = np.array([[0.5, 0.0], [0.6, 0.0]])
    legs = legs_to(pose, Passage(0.28, 0.3), wanted)
    assert min(math.hypot(legs[-1].x - x, legs[-1].y - y) for x, y in wanted) <= 0.2
    assert legs_to(pose, Passage(0.19, 0.3), wanted) == (), "too narrow for the robot"


def test_room_anywhere_will_do_where_there_is_none_on_the_way() -> None:
    passage, pose = Passage(0.17, 0.3), np.array([-0.06, 0.05, 0.0])
    drive = ManoeuvreDrive()
    assert drive.begin(pose, passage.points, OccupancyGrid(), onward=FORTH[8:14])
    twist = drive.command(pose, passage.points, OccupancyGrid(), PERIOD)
    assert twist is not None
    assert twist.linear_x < 0.0, "back out"


def test_a_move_that_the_safety_layer_refuses_is_not_planned_again() -> None:
    passage, pose, grid = Passage(0.28, 0.3), np.array([-0.06, 0.0, 0.0]), OccupancyGrid()
    drive = ManoeuvreDrive()
    assert drive.begin(pose, passage.points, grid, onward=FORTH[8:14])
    kinds = []
    for _ in range(40):  # it never gets anywhere
        twist = drive.command(pose, passage.points, grid, PERIOD)
        if twist is None:
            break
        kinds.append((np.sign(twist.linear_x), np.sign(twist.angular_z)))
    assert kinds[0] == (1.0, 0.0), "straight on"
    assert len(set(kinds)) > 1


@pytest.mark.parametrize("in_a_row", [1, 2])
def test_a_robot_without_a_path_recovers_as_ever(in_a_row: int) -> None:
    recovery, pose = Recovery(), np.array([-0.05, 0.0, 0.0])
    points = Passage(0.2, 0.3).points
    recovery.begin(pose, in_a_row)
    twist = recovery.command(pose, points, OccupancyGrid(), PERIOD)
    assert twist is not None
    assert twist.linear_x < 0.0
