"""Turns an episode into the files of a run folder."""

import json
import platform
import subprocess
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import asdict
from importlib.metadata import version
from pathlib import Path
from typing import Any

from evaluation.episode import Episode, EpisodeConfig
from evaluation.recorder import remove_recording
from evaluation.replay import ReplayConfig
from evaluation.result import result_of
from mapping.errors import TestbedError
from mapping.io.atomic import write_atomically
from mapping.io.map_server import write_map
from mapping.io.tum import write_tum
from mapping.plot import save_map_picture

RECORDED_VERSIONS = ("burger-testbed", "mujoco", "gymnasium", "numpy", "scipy", "numba", "gtsam")


@contextmanager
def run_folder(folder: Path) -> Iterator[None]:
    """Make sure before a run that its folder can be written; take it away if nothing comes of it.

    Raises:
        TestbedError: If it is a file, or nothing can be written there.
    """
    is_new = not folder.exists()
    _make(folder)
    try:
        yield
    except (TestbedError, KeyboardInterrupt):
        if is_new and not any(folder.iterdir()):
            folder.rmdir()
        raise


def write_run(episode: Episode, folder: Path) -> dict[str, Any]:
    """Write every file of the run folder, each whole or not at all; returns the result.

    ``config.json``, ``map.pgm`` and ``map.yaml``, ``map.png``, the three trajectories, of a
    recorded episode ``log.carmen`` and ``bag/``, and last ``result.json``: a folder that has one
    is complete.
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
    map_file_kb = (folder / "map.pgm").stat().st_size / 1e3
    result = result_of(episode, map_file_kb)
    save_map_picture(
        folder / "map.png",
        episode.grid,
        path=trajectory.poses[:, :2],
        truth=episode.truth,
        title=title_of(result),
    )
    if episode.recorder is None:
        remove_recording(folder)
    else:
        episode.recorder.write(folder, episode.grid)
    write_json(folder / "result.json", result)
    return result


def start_run(folder: Path) -> None:
    """Make sure of the folder and take away an earlier run's result: it would vouch for this one.

    Raises:
        TestbedError: If it is a file, or nothing can be written there.
    """
    _make(folder)
    (folder / "result.json").unlink(missing_ok=True)


def title_of(result: dict[str, Any]) -> str:
    """One line that says what a picture of a run shows."""
    f1 = result["f1_5cm"]
    world = Path(result["world"]).stem
    return (
        f"{world}, {result['mapper']}, seed {result['seed']}: {result['stop_reason']} "
        f"after {result['sim_time_s']:.0f} s, coverage {result['coverage']:.3f}, "
        f"F1(5 cm) {'-' if f1 is None else format(f1, '.3f')}"
    )


def describe(config: EpisodeConfig | ReplayConfig) -> dict[str, Any]:
    """Everything that defines the run: the config, the versions, the commit."""
    told = asdict(config)
    return {
        **{key: str(value) if isinstance(value, Path) else value for key, value in told.items()},
        "versions": {name: version(name) for name in RECORDED_VERSIONS},
        "python": platform.python_version(),
        "git_commit": _git_commit(),
    }


def write_json(path: Path, content: dict[str, Any]) -> None:
    """Write JSON that any reader takes: no NaN, a key a line."""
    text = json.dumps(content, indent=2, allow_nan=False) + "\n"
    write_atomically(path, lambda file: file.write(text.encode()))


def _make(folder: Path) -> None:
    try:
        folder.mkdir(parents=True, exist_ok=True)
        probe = folder / ".writable"
        probe.touch()
        probe.unlink()
    except OSError as error:
        raise TestbedError(
            f"--out {folder}: cannot be written ({error.strerror}); must be a folder of yours"
        ) from None


def _git_commit() -> str | None:
    """The commit this code stands at, with ``+`` when files differ; None outside a checkout."""
    root = Path(__file__).resolve().parents[1]
    if not (root / ".git").exists():
        return None
    words = ["git", "-C", str(root), "describe", "--always", "--dirty=+", "--abbrev=12"]
    answer = subprocess.run(words, capture_output=True, text=True, check=False)
    return answer.stdout.strip() or None
