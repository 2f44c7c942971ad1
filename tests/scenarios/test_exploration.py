"""Whole explorations: complete, home, without contact, and with a map that is right."""

import pytest

from envs.floor_plan import FloorPlan, Wall
from evaluation.episode import Episode, EpisodeConfig, run_episode
from evaluation.result import result_of
from nav.navigator import COMPLETE


def explored(**settings: object) -> tuple[Episode, dict[str, object]]:
    episode = run_episode(EpisodeConfig(**settings))  # type: ignore[arg-type]
    return episode, result_of(episode, map_file_kb=None)


@pytest.mark.parametrize(
    ("lidar", "f1"),
    # The datasheet's 3.5 % precision spreads far walls over the 5 cm that count as right.
    [("datasheet", 0.90), ("ideal", 0.97)],
)
def test_with_true_odometry_the_map_is_as_good_as_the_lidar(lidar: str, f1: float) -> None:
    episode, result = explored(world="turtlebot3_world", odometry="truth", lidar=lidar, seed=7)
    assert result["stop_reason"] == COMPLETE
    assert result["contacts"] == 0
    assert result["coverage"] >= 0.985
    assert result["f1_5cm"] >= f1
    assert result["free_iou"] >= 0.96, "as the map that ROBOTIS ships, 0.960"
    assert episode.grid.shape[0] * episode.grid.resolution < 15.0, "nothing far outside the walls"


def test_the_thesis_mapper_explores_as_well() -> None:
    _, result = explored(world="empty_room", mapper="occgridmapp", odometry="truth", seed=1)
    assert result["stop_reason"] == COMPLETE
    assert result["contacts"] == 0
    assert result["scans_dropped"] > 0, "the turn gate leaves scans out"


def test_a_robot_in_a_closed_cell_is_done_without_moving() -> None:
    corners = ((-0.16, -0.16), (0.16, -0.16), (0.16, 0.16), (-0.16, 0.16))
    cell = FloorPlan(
        name="cell",
        start=(0.0, 0.0, 0.0),
        walls=(Wall(points=corners, closed=True, thickness=0.02),),
    )
    episode = run_episode(EpisodeConfig(odometry="truth", time_limit=30.0), plan=cell)
    assert episode.stop_reason == COMPLETE
    assert episode.coverages[-1] > 0.9
    assert episode.sim_time < 5.0
