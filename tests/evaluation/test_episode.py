"""Whole short episodes in a tiny room: reproducible, complete in their keys, safe to interrupt."""

import dataclasses
import json
import signal
from dataclasses import replace
from pathlib import Path
from typing import Any
from unittest.mock import patch

import numpy as np
import pytest

from envs.floor_plan import Route
from evaluation.episode import Episode, EpisodeConfig, run_episode
from evaluation.episode_folder import write_run
from evaluation.failure import RunError
from evaluation.kernels.warm_up import TINY_ROOM
from evaluation.progress import Progress
from evaluation.result import TIMING_KEYS
from mapping.errors import TestbedError
from mapping.io.map_server import read_map
from mapping.slam.graph_slam import GraphSlam

SHORT = EpisodeConfig(world="tiny_room", seed=3, time_limit=15.0)

DESIGN_KEYS = set(
    "world mapper navigator seed stop_reason sim_time_s wall_time_s real_time_factor coverage "
    "t90_s t95_s t99_s t_ref95_s efficiency "
    "path_length_m contacts min_clearance_m f1_5cm f1_10cm adnn_m h95_m free_iou "
    "false_free wall_thickness_ratio ate_rmse_m ate_max_m yaw_error_max_deg ate_aligned_rmse_m "
    "ate_online_rmse_m "
    "rpe_trans_rmse_m rpe_rot_rmse_deg map_updates scans_dropped map_update_ms_p50 "
    "decision_ms_p50 decision_ms_p99 "
    "map_update_ms_p99 map_update_rate_hz map_update_rate_min_hz map_update_rate_median_hz "
    "map_file_kb peak_rss_mb home_distance_m "
    "dropped_frontiers map_length_error map_reloads contacts_by_people ghost_area_m2".split()
)

FILES = {
    "config.json",
    "result.json",
    "map.pgm",
    "map.yaml",
    "map.png",
    "trajectory.tum",
    "ground_truth.tum",
    "odometry.tum",
    "goals.csv",
    "graph.g2o",
}


def test_the_same_seed_writes_the_same_bytes_but_for_the_timings(tmp_path: Path) -> None:
    results = []
    for name in ("a", "b"):
        write_run(run_episode(SHORT, plan=TINY_ROOM), tmp_path / name)
        results.append(json.loads((tmp_path / name / "result.json").read_text()))
    for key in TIMING_KEYS:
        for result in results:
            result.pop(key)
    assert results[0] == results[1]
    for file in FILES - {"result.json"}:
        assert (tmp_path / "a" / file).read_bytes() == (tmp_path / "b" / file).read_bytes(), file


def test_people_walk_through_an_episode_as_its_seed_says(tmp_path: Path) -> None:
    results = []
    for seed in (3, 3, 4):
        config = dataclasses.replace(SHORT, seed=seed, people=2, mapper="ogm")
        results.append(write_run(run_episode(config, plan=TINY_ROOM), tmp_path / str(len(results))))
    alone = write_run(
        run_episode(dataclasses.replace(SHORT, mapper="ogm"), plan=TINY_ROOM), tmp_path
    )
    first, again, other = (result["path_length_m"] for result in results)
    assert first == again != other
    assert first != alone["path_length_m"]
    assert json.loads((tmp_path / "0" / "config.json").read_text())["people"] == 2


def test_a_run_folder_has_every_file_and_every_key_and_its_map_can_be_read(tmp_path: Path) -> None:
    result = write_run(run_episode(SHORT, plan=TINY_ROOM), tmp_path)
    assert {path.name for path in tmp_path.iterdir()} == FILES
    assert set(result) == DESIGN_KEYS
    assert (read_map(tmp_path / "map.yaml").states == 0).any()
    assert result["map_reloads"] is True
    config = json.loads((tmp_path / "config.json").read_text())
    assert config["seed"] == 3
    assert config["versions"]["mujoco"]


def test_another_seed_gives_another_episode() -> None:
    tracks = [
        run_episode(EpisodeConfig(seed=seed, time_limit=5.0), plan=TINY_ROOM).track.pose_map
        for seed in (0, 1)
    ]
    assert not np.array_equal(tracks[0], tracks[1])


def test_an_episode_out_of_time_says_so() -> None:
    episode = run_episode(EpisodeConfig(time_limit=2.0), plan=TINY_ROOM)
    assert episode.stop_reason == "time_limit"
    assert episode.sim_time == pytest.approx(2.0, abs=0.3), "the first sweep comes before"


def test_an_episode_of_one_step_has_no_trajectory_to_score(tmp_path: Path) -> None:
    result = write_run(run_episode(EpisodeConfig(time_limit=0.1), plan=TINY_ROOM), tmp_path)
    assert result["ate_rmse_m"] is None
    assert result["rpe_trans_rmse_m"] is None
    assert result["ate_online_rmse_m"] == pytest.approx(0.0, abs=1e-3), "it has not moved"


def test_ctrl_c_ends_an_episode_and_keeps_the_map(tmp_path: Path) -> None:
    def stop(progress: Progress) -> None:
        if progress.time > 3.0:
            raise KeyboardInterrupt

    episode = run_episode(SHORT, stop, plan=TINY_ROOM)
    assert episode.stop_reason == "interrupted"
    assert write_run(episode, tmp_path)["coverage"] > 0.1


def test_ctrl_c_before_the_first_step_leaves_nothing_to_keep() -> None:
    agent_acts = patch("nav.agent.MappingAgent.act", side_effect=KeyboardInterrupt)
    with agent_acts, pytest.raises(KeyboardInterrupt):
        run_episode(SHORT, plan=TINY_ROOM)


def test_ctrl_c_in_the_last_turn_is_not_lost() -> None:
    def press(progress: Progress) -> None:
        if progress.time > 1.1:
            signal.raise_signal(signal.SIGINT)

    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    try:
        episode = run_episode(EpisodeConfig(time_limit=1.1), press, plan=TINY_ROOM)
    finally:
        signal.signal(signal.SIGINT, before)
    assert episode.stop_reason == "interrupted"


def test_a_robot_that_topples_ends_its_episode() -> None:
    fallen = patch("envs.simulation.lean_of", side_effect=[0.0] * 30 + [1.5] * 10)
    with fallen:
        episode = run_episode(SHORT, plan=TINY_ROOM)
    assert episode.stop_reason == "toppled"
    assert episode.sim_time == pytest.approx(3.3)


def failing_after(calls: int) -> Any:
    """A mapper that takes so many scans, then has a defect."""
    update, left = GraphSlam.update, iter(range(calls))

    def fail(self: GraphSlam, *messages: Any) -> bool:
        if next(left, None) is None:
            raise ZeroDivisionError("a defect of one's own")
        return update(self, *messages)

    return patch.object(GraphSlam, "update", fail)


def test_an_error_ends_a_run_and_keeps_its_map(tmp_path: Path) -> None:
    with failing_after(40), pytest.raises(RunError) as caught:
        run_episode(SHORT, plan=TINY_ROOM)
    assert isinstance(caught.value.__cause__, ZeroDivisionError)
    assert isinstance(caught.value.left, Episode)
    result = write_run(caught.value.left, tmp_path)
    assert result["stop_reason"] == "error"
    assert result["coverage"] > 0.1


def test_an_error_when_the_map_is_finished_keeps_it_unfinished() -> None:
    broken = patch.object(GraphSlam, "finish", side_effect=ZeroDivisionError)
    with broken, pytest.raises(RunError) as caught:
        run_episode(replace(SHORT, time_limit=2.0), plan=TINY_ROOM)
    assert isinstance(caught.value.left, Episode)
    assert (caught.value.left.grid.states() == 0).any(), "free floor"


def test_an_error_before_there_is_anything_to_keep_comes_as_it_is() -> None:
    with failing_after(0), pytest.raises(ZeroDivisionError):
        run_episode(SHORT, plan=TINY_ROOM)


def test_a_run_that_cannot_be_written_whole_leaves_no_earlier_result_to_vouch_for_it(
    tmp_path: Path,
) -> None:
    episode = run_episode(EpisodeConfig(time_limit=2.0), plan=TINY_ROOM)
    write_run(episode, tmp_path)
    broken = patch("evaluation.episode_folder.write_map", side_effect=TestbedError("disk full"))
    with broken, pytest.raises(TestbedError):
        write_run(episode, tmp_path)
    assert not (tmp_path / "result.json").exists()


def test_a_navigator_without_a_plan_runs_out_its_time_without_contact() -> None:
    config = EpisodeConfig(navigator="reactive", time_limit=40.0)
    episode = run_episode(config, plan=TINY_ROOM)
    assert episode.stop_reason == "time_limit"
    assert episode.contacts == 0


@pytest.mark.parametrize(
    "wrong",
    [
        {"seed": -1},
        {"time_limit": 0.0},
        {"time_limit": float("nan")},
        {"resolution": 0.0},
        {"resolution": float("nan")},
    ],
)
def test_a_config_that_makes_no_episode_is_refused(wrong: dict[str, float]) -> None:
    with pytest.raises(TestbedError, match=next(iter(wrong))):
        EpisodeConfig(**wrong)


@pytest.mark.parametrize("field", ["mapper", "navigator", "odometry", "lidar", "imu"])
def test_an_unknown_name_is_refused_with_the_known_ones(field: str) -> None:
    with pytest.raises(TestbedError, match=r"nonsense.*(must be|one of)"):
        run_episode(EpisodeConfig(**{field: "nonsense"}), plan=TINY_ROOM)


def test_waypoints_come_from_a_route_of_the_world_or_from_their_text() -> None:
    plan = replace(TINY_ROOM, routes=(Route(name="across", points=((1.2, 0.6),)),))
    config = replace(SHORT, navigator="waypoints", time_limit=30.0)
    by_name = run_episode(replace(config, waypoints="across"), plan=plan)
    by_text = run_episode(replace(config, waypoints="1.2,0.6"), plan=plan)
    assert by_name.stop_reason == by_text.stop_reason == "complete"
    assert np.array_equal(by_name.track.pose_world, by_text.track.pose_world)
    with pytest.raises(TestbedError, match=r"waypoints: 'up'; must be .*\(across\)"):
        run_episode(replace(config, waypoints="up"), plan=plan)
    with pytest.raises(TestbedError, match="waypoints: none"):
        run_episode(config, plan=plan)
