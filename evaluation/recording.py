"""Reads a recorded run and what is known about it besides: relations, true poses, floor plan."""

import hashlib
import json
import logging
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from envs.floor_plan import FloorPlan
from envs.worlds import load_world
from mapping.errors import TestbedError
from mapping.geometry import Pose
from mapping.io.relations import read_relations
from mapping.io.sensor_log_file import RECORDED_BAG, RECORDED_LOG, read_log
from mapping.io.tum import read_tum
from mapping.odometry_trajectory import odometry_at_scans
from mapping.relations import STAMP_TOLERANCE, Relations, match_relations
from mapping.sensor_log import SensorLog
from mapping.trajectory import Trajectory

logger = logging.getLogger(__name__)

HASH_BLOCK = 1 << 20
"""Bytes of a file that are hashed at a time."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Recording:
    """A log that can be mapped, and what its map and trajectory can be scored against."""

    log: SensorLog
    sha256: str | None = None
    """Hash of the log's file, or of all files of a bag's folder; None for a log made in code."""
    relations: Relations | None = None
    """Relative poses checked by hand; at least one has both of its moments in the log."""
    ground_truth: Trajectory | None = None
    """The true poses in the world frame, of a run folder."""
    world: str | None = None
    """The world that the run folder names."""
    plan: FloorPlan | None = None
    """Its floor plan; None when it is no longer there."""

    @property
    def start_pose_map(self) -> Pose:
        """The pose in the map frame that odometry counts from.

        Of a run folder the start in its world, so that the two frames agree; else zeros.
        """
        if self.plan is not None:
            return np.array(self.plan.start, dtype=np.float64)
        if self.ground_truth is not None:
            return np.array(self.ground_truth.poses[0])
        return np.zeros(3)

    @property
    def is_simulated(self) -> bool:
        """Whether it is a run folder, where odometry counts from the start pose by definition."""
        return self.ground_truth is not None


def load_recording(log: Path, relations: Path | None = None) -> Recording:
    """Read a log and all that is known about it.

    Args:
        log: A log file, or a folder: a ROS 2 bag, or a run folder with a recorded log.
        relations: A file of relative poses to score the trajectory by.

    Raises:
        TestbedError: A file is missing or broken, there is no scan with odometry near its time, or
            no relation has both of its moments in the log.
    """
    world = _world(log)
    recording = Recording(
        log=read_log(log),
        sha256=_sha256(log),
        relations=None if relations is None else read_relations(relations),
        ground_truth=_ground_truth(log),
        world=world,
        plan=None if world is None else _plan(world),
    )
    check_recording(recording, relations)
    return recording


def check_recording(recording: Recording, relations: Path | None = None) -> None:
    """Refuse a log of which no map can be made, or that its relations do not fit.

    Raises:
        TestbedError: As told.
    """
    log = recording.log
    if not log.scans:
        raise TestbedError(f"{log.source}: there is no laser scan; must have at least one")
    stamps = odometry_at_scans(log.scans, log.odometry).stamps
    if len(stamps) == 0:
        raise TestbedError(
            f"{log.source}: no odometry near the time of any of its {len(log.scans)} scans; "
            "one scan must have some"
        )
    truth = recording.ground_truth
    if truth is not None and not np.any((stamps >= truth.stamps[0]) & (stamps <= truth.stamps[-1])):
        raise TestbedError(f"{log.source}: no scan lies within the time of ground_truth.tum")
    if recording.relations is not None:
        *_, usable = match_relations(stamps, recording.relations)
        if not usable.any():
            raise TestbedError(
                f"{relations}: none of {len(usable)} relations has both of its moments within "
                f"{STAMP_TOLERANCE} s of scans of {log.source}; one must"
            )


def _sha256(log: Path) -> str:
    """Hash of a file's bytes, or of the names and bytes of all files in a bag's folder."""
    parts = [log / RECORDED_LOG, log / RECORDED_BAG, log]
    path = next((part for part in parts if part.exists()), log)
    digest = hashlib.sha256()
    for file in [path] if path.is_file() else sorted(path.rglob("*")):
        if not file.is_file():
            continue
        if file != path:
            digest.update(str(file.relative_to(path)).encode())
        with file.open("rb") as content:
            while block := content.read(HASH_BLOCK):
                digest.update(block)
    return digest.hexdigest()


def _ground_truth(log: Path) -> Trajectory | None:
    """The true poses of a run folder; None for any other log."""
    file = log / "ground_truth.tum"
    if not file.is_file():
        return None
    truth = read_tum(file)
    if len(truth.stamps) == 0:
        raise TestbedError(f"{file}: there is no pose; must have at least one")
    return truth


def _world(log: Path) -> str | None:
    """The world that a run folder was recorded in; None for any other log."""
    file = log / "config.json"
    if not (log / "ground_truth.tum").is_file() or not file.is_file():
        return None
    try:
        world = json.loads(file.read_text(encoding="utf-8")).get("world")
    except (OSError, ValueError, AttributeError) as error:
        raise TestbedError(f"{file}: cannot be read ({error}); must be a run's config") from error
    return None if world is None else str(world)


def _plan(world: str) -> FloorPlan | None:
    """The floor plan of a world; None, with a warning, when its file is no longer there."""
    try:
        return load_world(world)
    except TestbedError as error:
        logger.warning("the map is not scored: %s", " ".join(str(error).split()))
        return None
