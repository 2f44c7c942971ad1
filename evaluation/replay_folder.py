"""Turns a replay into the files of a run folder, those that an episode's has."""

from pathlib import Path
from typing import Any

from evaluation.map_reload import map_reloads
from evaluation.replay import Replay
from evaluation.replay_result import result_of_replay, truth_of
from evaluation.run_folder import describe, start_run, write_json, write_pose_graph
from mapping.io.map_server import write_map
from mapping.io.tum import write_tum
from mapping.plot import save_map_picture


def write_replay(replay: Replay, folder: Path) -> dict[str, Any]:
    """Write every file of the run folder, each whole or not at all; returns the result.

    The files are those of an episode. ``ground_truth.tum`` is there only if it is known;
    ``odometry.tum`` has a pose for every message. ``result.json`` comes last: a folder that has
    one is complete.
    """
    recording, trajectory = replay.recording, replay.trajectory
    start_run(folder)
    write_json(folder / "config.json", _description(replay))
    write_map(folder / "map.yaml", replay.grid)
    write_tum(folder / "trajectory.tum", trajectory.stamps, trajectory.poses)
    write_tum(folder / "odometry.tum", replay.odometry.stamps, replay.odometry.poses)
    write_pose_graph(folder, replay.pose_graph)
    true_poses = recording.ground_truth
    if true_poses is None:
        (folder / "ground_truth.tum").unlink(missing_ok=True)  # an earlier run's
    else:
        write_tum(folder / "ground_truth.tum", true_poses.stamps, true_poses.poses)
    truth = truth_of(replay)
    map_file_kb = (folder / "map.pgm").stat().st_size / 1e3
    reloads = map_reloads(folder / "map.yaml", replay.grid)
    result = result_of_replay(replay, truth, map_file_kb, reloads)
    save_map_picture(
        folder / "map.png",
        replay.grid,
        path=trajectory.poses[:, :2],
        truth=truth,
        title=title_of(result),
    )
    write_json(folder / "result.json", result)
    return result


def title_of(result: dict[str, Any]) -> str:
    """One line that says what a picture of a replay shows."""
    error = ""
    if result["relations_trans_mean_m"] is not None:
        error = f", {result['relations_used']} relations: {result['relations_trans_mean_m']:.3f} m"
    elif result["ate_rmse_m"] is not None:
        error = f", position error {result['ate_rmse_m']:.3f} m rms"
    return (
        f"{Path(result['log']).name}, {result['mapper']}: {result['stop_reason']}, "
        f"{result['map_updates']} scans in {result['sim_time_s']:.0f} s{error}"
    )


def _description(replay: Replay) -> dict[str, Any]:
    """Everything that defines the replay."""
    description = describe(replay.config)
    description["log_sha256"] = replay.recording.sha256
    return description
