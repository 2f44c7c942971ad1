"""What comes with a log: the world, the truth and relations, from a run folder or refused."""

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from envs.plan_yaml import write_plan
from evaluation.episode import EpisodeConfig, run_episode
from evaluation.episode_folder import write_run
from evaluation.kernels.warm_up import TINY_ROOM
from evaluation.recorder import Recorder
from evaluation.recording import Recording, check_recording, load_recording
from evaluation.replay import ReplayConfig, run_replay
from evaluation.replay_folder import write_replay
from mapping.errors import TestbedError
from mapping.io.carmen_writer import write_carmen
from mapping.io.tum import write_tum
from mapping.relations import Relations
from mapping.trajectory import Trajectory
from tests.evaluation.arena_log import ARENA, COARSE, LOG, START, true_trajectory


def far_away(trajectory: Trajectory) -> Trajectory:
    return Trajectory(stamps=trajectory.stamps + 1e6, poses=trajectory.poses)


ELSEWHERE = Relations(stamps=np.array([[1e6, 2e6]]), poses=np.zeros((1, 3)))


@pytest.mark.parametrize(
    ("recording", "told"),
    [
        (Recording(log=replace(LOG, scans=[])), r"arena\.log: there is no laser scan"),
        (Recording(log=replace(LOG, odometry=[])), "no odometry near"),
        (Recording(log=LOG, relations=ELSEWHERE), "none of 1 relations"),
        (Recording(log=LOG, ground_truth=far_away(true_trajectory())), "ground_truth"),
    ],
)
def test_a_log_that_cannot_be_mapped_or_scored_is_refused_before_it_is_mapped(
    recording: Recording, told: str
) -> None:
    with pytest.raises(TestbedError, match=told):
        check_recording(recording, Path("a.relations"))


def run_folder_of(folder: Path, world: str) -> Path:
    write_carmen(folder / "log.carmen", LOG)
    truth = true_trajectory()
    write_tum(folder / "ground_truth.tum", truth.stamps, truth.poses)
    (folder / "config.json").write_text(json.dumps({"world": world}))
    return folder


def test_a_run_folder_tells_its_world_and_the_truth(tmp_path: Path) -> None:
    write_plan(ARENA, tmp_path / "arena.yaml")
    recording = load_recording(run_folder_of(tmp_path, str(tmp_path / "arena.yaml")))
    assert recording.plan == ARENA
    assert recording.start_pose_map.tolist() == list(START)
    assert recording.ground_truth is not None
    assert len(recording.log.scans) == 60
    assert recording.sha256 is not None
    before = recording.sha256
    (tmp_path / "result.json").write_text("{}")
    assert load_recording(tmp_path).sha256 == before, "the log is hashed, not the whole folder"
    log = tmp_path / "log.carmen"
    log.write_text(log.read_text() + "# one more line\n")
    assert load_recording(tmp_path).sha256 != before


@pytest.mark.parametrize("mapper", ["ogm", "occgridmapp"])
def test_a_recorded_episode_replays_to_the_same_map_and_trajectory(
    mapper: str, tmp_path: Path
) -> None:
    write_plan(TINY_ROOM, tmp_path / "tiny.yaml")
    world = str(tmp_path / "tiny.yaml")
    config = EpisodeConfig(world=world, mapper=mapper, time_limit=10.0)
    explored = write_run(run_episode(config, recorder=Recorder()), tmp_path / "explored")
    recording = load_recording(tmp_path / "explored")
    again = ReplayConfig(log=tmp_path / "explored", mapper=mapper)
    replayed = write_replay(run_replay(again, recording), tmp_path / "replayed")
    for file in ("map.pgm", "map.yaml", "trajectory.tum"):
        one, other = (tmp_path / folder / file for folder in ("explored", "replayed"))
        assert one.read_bytes() == other.read_bytes(), file
    assert replayed["f1_5cm"] == explored["f1_5cm"]
    assert replayed["ate_rmse_m"] == pytest.approx(explored["ate_rmse_m"], abs=1e-6)


def test_a_run_folder_whose_world_is_gone_is_scored_by_its_trajectory_alone(
    tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    recording = load_recording(run_folder_of(tmp_path, "/gone/arena.yaml"))
    assert "/gone/arena.yaml" in caplog.text
    assert recording.start_pose_map == pytest.approx(START)
    result = write_replay(run_replay(COARSE, recording), tmp_path / "out")
    assert result["ate_rmse_m"] is not None
    assert result["f1_5cm"] is None
