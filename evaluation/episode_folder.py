"""Turns an episode into the files of a run folder."""

from pathlib import Path
from typing import Any

import numpy as np

from evaluation.animation.animation import Animation
from evaluation.episode import Episode
from evaluation.goals_file import write_goals
from evaluation.map_reload import map_reloads
from evaluation.recorder import remove_recording
from evaluation.result import result_of
from evaluation.run_folder import (
    ANIMATION_FILE,
    GOALS_FILE,
    describe,
    start_run,
    write_json,
    write_pose_graph,
)
from mapping.io.map_server import write_map
from mapping.io.tum import write_tum
from mapping.plot import save_map_picture


def write_run(episode: Episode, folder: Path, animation: Animation | None = None) -> dict[str, Any]:
    """Write every file of the run folder, each whole or not at all; returns the result.

    ``config.json``, ``map.pgm`` and ``map.yaml``, ``map.png``, the three trajectories,
    ``goals.csv``, of a mapper that keeps one ``graph.g2o``, of a recorded episode ``log.carmen``
    and ``bag/``, of an animated one ``episode.gif``, and last ``result.json``: a folder that has
    one is complete.
    """
    start_run(folder)
    write_json(folder / "config.json", describe(episode.config))
    write_map(folder / "map.yaml", episode.grid)
    track = episode.track
    stamps = track.stamps
    trajectory = episode.trajectory
    write_tum(folder / "trajectory.tum", trajectory.stamps, trajectory.poses)
    write_tum(folder / "ground_truth.tum", stamps, track.pose_world)
    write_tum(folder / "odometry.tum", stamps, track.pose_odom)
    write_goals(folder / GOALS_FILE, episode.goals)
    write_pose_graph(folder, episode.pose_graph)
    map_file_kb = (folder / "map.pgm").stat().st_size / 1e3
    result = result_of(episode, map_file_kb, map_reloads(folder / "map.yaml", episode.grid))
    save_map_picture(
        folder / "map.png",
        episode.grid,
        path=trajectory.poses[:, :2],
        truth=episode.truth,
        goals=np.array([(goal.x, goal.y) for goal in episode.goals]).reshape(-1, 2),
        left_over=np.array([(each.x, each.y) for each in episode.dropped_frontiers]).reshape(-1, 2),
        title=title_of(result),
    )
    if animation is not None:
        animation.write(folder / ANIMATION_FILE, episode)
    if episode.recorder is None:
        remove_recording(folder)
    else:
        episode.recorder.write(folder, episode.grid)
    write_json(folder / "result.json", result)
    return result


def title_of(result: dict[str, Any]) -> str:
    """One line that says what a picture of a run shows."""
    f1 = result["f1_5cm"]
    world = Path(result["world"]).stem
    return (
        f"{world}, {result['mapper']}, seed {result['seed']}: {result['stop_reason']} "
        f"after {result['sim_time_s']:.0f} s, coverage {result['coverage']:.3f}, "
        f"F1(5 cm) {'-' if f1 is None else format(f1, '.3f')}"
    )
