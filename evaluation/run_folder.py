"""What the folders of all runs share: being writable, the description of the run, JSON."""

import json
import platform
import subprocess
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import asdict
from importlib.metadata import version
from pathlib import Path
from typing import TYPE_CHECKING, Any

from evaluation.failure import FAILURE_FILE
from evaluation.source_digest import digest_of_sources
from mapping.errors import TestbedError
from mapping.io.atomic import write_atomically
from mapping.io.g2o import write_g2o
from mapping.pose_graph import PoseGraph

if TYPE_CHECKING:  # a replay needs no simulator, which an episode imports
    from evaluation.calibration.experiment import CalibrationConfig
    from evaluation.episode import EpisodeConfig
    from evaluation.localization.config import LocalizationConfig
    from evaluation.replay import ReplayConfig

GOALS_FILE, ANIMATION_FILE = "goals.csv", "episode.gif"
"""Files that only some runs have."""

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
    except BaseException:
        if is_new and not any(folder.iterdir()):
            folder.rmdir()
        raise


def start_run(folder: Path) -> None:
    """Make sure of the folder and take away what would pass for this run's, the result first.

    Raises:
        TestbedError: If it is a file, or nothing can be written there.
    """
    _make(folder)
    for earlier in ("result.json", FAILURE_FILE, GOALS_FILE, ANIMATION_FILE):
        (folder / earlier).unlink(missing_ok=True)


def describe(
    config: "EpisodeConfig | ReplayConfig | CalibrationConfig | LocalizationConfig",
) -> dict[str, Any]:
    """Everything that defines the run: the config, the versions, the commit, the sources."""
    told = asdict(config)
    return {
        **{key: str(value) if isinstance(value, Path) else value for key, value in told.items()},
        "versions": {name: version(name) for name in RECORDED_VERSIONS},
        "python": platform.python_version(),
        "git_commit": _git_commit(),
        "source_digest": digest_of_sources(),
    }


def write_pose_graph(folder: Path, graph: PoseGraph | None) -> None:
    """Write the mapper's pose graph as ``graph.g2o``; without one take away an earlier run's."""
    if graph is None:
        (folder / "graph.g2o").unlink(missing_ok=True)
    else:
        write_g2o(folder / "graph.g2o", graph)


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
