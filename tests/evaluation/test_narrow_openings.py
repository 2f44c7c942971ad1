"""Rooms behind doors that show as hardly more than a gap between two beams are found."""

import pytest

from envs.floor_plan import FloorPlan, Wall
from evaluation.episode import EpisodeConfig, run_episode

DEAD_END = FloorPlan(
    name="dead_end",
    start=(0.5, 0.5, 1.5708),
    walls=(
        Wall(points=((0.0, 0.0), (3.0, 0.0), (3.0, 6.0), (0.0, 6.0)), closed=True),
        Wall(points=((1.1, 0.0), (1.1, 5.45))),
        Wall(points=((1.1, 5.77), (1.1, 6.0))),
    ),
)
"""A corridor with a door of 0.32 m in its side, right at its end, and a room behind it."""


FAR_END = FloorPlan(
    name="far_end",
    start=(0.5, 0.5, 1.5708),
    walls=(
        Wall(
            points=((0.0, 0.0), (6.0, 0.0), (6.0, 6.0), (3.0, 6.0), (3.0, 12.0), (0.0, 12.0)),
            closed=True,
        ),
        Wall(points=((3.0, 6.0), (1.1, 6.0), (1.1, 11.45))),
        Wall(points=((1.1, 11.77), (1.1, 12.0))),
    ),
)
"""The same at the end of a longer corridor, beyond a hall, from where it is a long way back."""


@pytest.mark.parametrize("seed", [0, 1])
def test_a_narrow_door_that_was_only_seen_at_a_grazing_angle_is_found_in_the_end(seed: int) -> None:
    config = EpisodeConfig(mapper="ogm", odometry="truth", seed=seed, time_limit=600.0)
    episode = run_episode(config, plan=DEAD_END)
    assert episode.stop_reason == "complete"
    assert episode.contacts == 0
    assert episode.coverages[-1] > 0.98


@pytest.mark.parametrize("seed", [1, 3])
def test_a_narrow_door_is_worth_a_long_way_in_the_end(seed: int) -> None:
    config = EpisodeConfig(mapper="ogm", odometry="truth", seed=seed, time_limit=600.0)
    episode = run_episode(config, plan=FAR_END)
    assert episode.stop_reason == "complete"
    assert episode.contacts == 0
    assert episode.coverages[-1] > 0.98
