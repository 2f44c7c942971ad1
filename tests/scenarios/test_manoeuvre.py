"""Whole explorations that begin in a pocket in which the robot cannot turn."""

import pytest

from envs.floor_plan import FloorPlan, Wall
from evaluation.episode import EpisodeConfig, run_episode
from evaluation.result import result_of
from nav.navigator import COMPLETE

WIDTH, DEPTH = 0.275, 0.5
"""Of the slot [m]: the robot is 0.18 m wide, and needs 0.29 m to turn."""

THICKNESS = 0.02
"""Of the walls [m]."""

TIME = 100.0
"""Twice what it takes [s]. Backing off and turning alone take 155 and 164 s from two of these
starts and do not get out from the third."""


def room_with_slot(ahead: float, aside: float, yaw: float) -> FloorPlan:
    """A room whose right-hand wall has a slot; the robot stands in it, as far from its mouth."""
    half = 0.5 * (WIDTH + THICKNESS)
    corners = (
        *((0.0, 0.0), (2.0, 0.0), (2.0, 1.0 - half), (2.0 + DEPTH, 1.0 - half)),
        *((2.0 + DEPTH, 1.0 + half), (2.0, 1.0 + half), (2.0, 2.0), (0.0, 2.0)),
    )
    return FloorPlan(
        name="slot",
        start=(2.0 + ahead, 1.0 + aside, yaw),
        walls=(Wall(points=corners, closed=True, thickness=THICKNESS),),
    )


@pytest.mark.parametrize(
    ("ahead", "aside", "yaw"), [(0.36, -0.015, -0.35), (0.37, 0.01, 0.6), (0.37, 0.0, -0.5)]
)
def test_a_robot_in_a_slot_that_it_cannot_turn_in_gets_out_and_explores(
    ahead: float, aside: float, yaw: float
) -> None:
    config = EpisodeConfig(world="slot", mapper="ogm", odometry="truth", time_limit=TIME)
    episode = run_episode(config, plan=room_with_slot(ahead, aside, yaw))
    result = result_of(episode, map_file_kb=None)
    assert result["stop_reason"] == COMPLETE
    assert result["contacts"] == 0
    assert result["coverage"] >= 0.97
