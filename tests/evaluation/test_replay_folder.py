"""The files of a replay: scores, the same bytes again, the pose graph."""

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from evaluation.recording import Recording
from evaluation.replay import run_replay
from evaluation.replay_folder import write_replay
from evaluation.result import TIMING_KEYS
from mapping.geometry import between
from mapping.io.g2o import read_g2o
from mapping.io.map_server import read_map
from mapping.io.tum import read_tum
from mapping.messages import LaserScan, Odometry, Twist
from mapping.relations import Relations
from mapping.sensor_log import SensorLog
from mapping.trajectory import poses_at
from tests.evaluation.arena_log import COARSE, LOG, RECORDING, RELATION_KEYS, RUN
from tests.evaluation.test_episode import DESIGN_KEYS
from tests.mapping.arena import circling


def test_a_run_folder_is_mapped_in_the_frame_of_its_world_and_scored(tmp_path: Path) -> None:
    result = write_replay(run_replay(replace(COARSE, resolution=0.01), RUN), tmp_path)
    # arithmetic in float32 and true poses interpolated between tenths of a second, 2 cm apart
    assert result["ate_max_m"] < 1e-3
    assert result["ate_online_rmse_m"] < 1e-3
    assert result["rpe_trans_rmse_m"] < 1e-3
    assert result["f1_5cm"] > 0.9, "in the frame of the truth, unaligned"
    assert result["coverage"] > 0.5
    assert result["world"] == "arena"
    assert read_tum(tmp_path / "ground_truth.tum").stamps.tolist() == pytest.approx(
        RUN.ground_truth.stamps.tolist()  # type: ignore[union-attr]
    )


def test_the_relations_of_a_true_trajectory_have_no_error(tmp_path: Path) -> None:
    stamps = np.array([[0.0, 10.0], [2.0, 4.0], [3.0, 300.0]])
    poses = between(circling()(stamps[:, 0]), circling()(stamps[:, 1]))
    recording = Recording(log=LOG, relations=Relations(stamps=stamps, poses=poses))
    result = write_replay(run_replay(COARSE, recording), tmp_path)
    assert result["relations_used"] == 2
    assert result["relations_trans_max_m"] == pytest.approx(0.0, abs=1e-6)
    assert result["relations_rot_mean_deg"] == pytest.approx(0.0, abs=1e-4)
    assert result["ate_rmse_m"] is None


def test_a_replay_writes_the_files_and_keys_of_an_episode_and_the_same_bytes_again(
    tmp_path: Path,
) -> None:
    results = []
    for name in ("a", "b"):
        (tmp_path / name).mkdir()
        (tmp_path / name / "ground_truth.tum").write_text("of an earlier run")
        results.append(write_replay(run_replay(COARSE, RECORDING), tmp_path / name))
    assert set(results[0]) == DESIGN_KEYS | RELATION_KEYS | {"log"}
    for key in TIMING_KEYS:
        for result in results:
            result.pop(key)
    assert results[0] == results[1]
    files = {"config.json", "map.pgm", "map.yaml", "map.png", "trajectory.tum", "odometry.tum"}
    assert {path.name for path in (tmp_path / "a").iterdir()} == files | {"result.json"}
    for file in files:
        assert (tmp_path / "a" / file).read_bytes() == (tmp_path / "b" / file).read_bytes(), file
    assert (read_map(tmp_path / "a" / "map.yaml").states == 0).any()
    assert json.loads((tmp_path / "a" / "config.json").read_text())["resolution"] == 0.05


def test_the_graph_mapper_leaves_its_pose_graph(tmp_path: Path) -> None:
    replay = run_replay(replace(COARSE, mapper="graph"), RECORDING)
    write_replay(replay, tmp_path)
    written, known = read_g2o(tmp_path / "graph.g2o"), replay.pose_graph
    assert known is not None
    assert len(written.ids) > 1
    assert np.array_equal(written.poses, known.poses)
    assert np.array_equal(written.information, known.information)
    keyframes = [poses_at(replay.trajectory, [s])[0] for s in replay.trajectory.stamps]
    away = between(written.poses[:, None], np.array(keyframes)[None])
    assert np.hypot(*away[..., :2].transpose(2, 0, 1)).min(axis=1).max() < 1e-6, "of some scan each"
    write_replay(run_replay(COARSE, RECORDING), tmp_path)
    assert not (tmp_path / "graph.g2o").exists(), "of an earlier run"


def test_a_log_of_one_scan_is_mapped(tmp_path: Path) -> None:
    log = SensorLog(
        source="one.log",
        scans=[LaserScan(stamp=5.0, ranges=np.ones(4, dtype=np.float32), time_increment=0.0)],
        odometry=[Odometry(stamp=5.0, pose_odom=np.zeros(3), twist=Twist())],
    )
    result = write_replay(run_replay(COARSE, Recording(log=log)), tmp_path)
    assert result["map_updates"] == 1
    assert result["sim_time_s"] == 0.0
    assert result["map_update_rate_hz"] is None
