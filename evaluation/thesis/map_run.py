"""Maps a recorded drive with one mapper and keeps what figures are made of: small, and by value."""

import tempfile
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from envs.floor_plan import FloorPlan
from envs.truth import truth_of_plan
from evaluation.replay import ReplayConfig, run_replay
from evaluation.replay_result import result_of_replay
from evaluation.thesis.drive import Drive
from mapping.grid import OCCUPIED, UNKNOWN, OccupancyGrid
from mapping.io.map_server import MapFile, write_map
from mapping.trajectory import Trajectory
from mapping.truth import TruthMap

Until = Literal["farthest", "turned", "end"]
"""How much of a drive is mapped: up to its farthest place, up to when it left that, or all."""


@dataclass(frozen=True, slots=True, kw_only=True)
class MapSpec:
    """Which drive a mapper maps, how far, and with which settings."""

    drive: Literal["hallway", "room"]
    until: Until
    mapper: str
    settings: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class MapRun:
    """A finished map."""

    spec: MapSpec
    map: MapFile
    """The states of all cells around what is known."""
    trajectory: Trajectory
    """Where the mapper, in the end, takes the robot to have been."""
    update_stamps: NDArray[np.float64]
    """Stamps of the scans that went into the map ``(n,)`` [s]."""
    update_seconds: NDArray[np.float64]
    """Wall time of each of these updates ``(n,)`` [s]: no two runs agree on it."""
    result: dict[str, Any]
    """Scores and counts, those of ``result.json``."""

    @property
    def occupied(self) -> NDArray[np.float64]:
        """Centres ``(n, 2)`` of the occupied cells in the map frame [m]."""
        return self.centres(self.map.states == OCCUPIED)

    def centres(self, cells: NDArray[np.bool_]) -> NDArray[np.float64]:
        """Centres ``(n, 2)`` of the cells of a mask of the map's shape [m]."""
        places = (np.argwhere(cells)[:, ::-1] + 0.5) * self.map.resolution
        return np.asarray(places + np.asarray(self.map.origin))


def run_map(drive: Drive, spec: MapSpec) -> MapRun:
    """Map a drive, score the map.

    Raises:
        TestbedError: The mapper or a setting of it does not exist, or there is no scan.
    """
    recording = drive.recording(getattr(drive, spec.until))
    config = ReplayConfig(
        log=Path(drive.config.world),
        mapper=spec.mapper,
        seed=drive.config.seed,
        set=spec.settings,
    )
    replay = run_replay(config, recording)
    with tempfile.TemporaryDirectory() as folder:
        write_map(Path(folder) / "map.yaml", replay.grid)
        map_file_kb = (Path(folder) / "map.pgm").stat().st_size / 1e3
    truth = truth_at(drive.plan, replay.grid.resolution)
    return MapRun(
        spec=spec,
        map=_known_part(replay.grid),
        trajectory=replay.trajectory,
        update_stamps=replay.map_update_stamps,
        update_seconds=replay.map_update_seconds,
        result=result_of_replay(replay, truth, map_file_kb),
    )


@lru_cache(maxsize=4)
def truth_at(plan: FloorPlan, resolution: float) -> TruthMap:
    """What a plan's maps are scored against; made once a process."""
    return truth_of_plan(plan, resolution=resolution)


def _known_part(grid: OccupancyGrid) -> MapFile:
    """The states of the smallest part of a grid that holds all it knows; one cell of none."""
    known = grid.log_odds != 0.0
    rows, columns = np.flatnonzero(known.any(axis=1)), np.flatnonzero(known.any(axis=0))
    if rows.size == 0:
        part, row, column = np.full((1, 1), UNKNOWN, dtype=np.int8), 0, 0
    else:
        row, column = int(rows[0]), int(columns[0])
        part = grid.states()[row : rows[-1] + 1, column : columns[-1] + 1]
    return MapFile(
        resolution=grid.resolution,
        origin=(
            float(grid.origin[0] + column * grid.resolution),
            float(grid.origin[1] + row * grid.resolution),
        ),
        states=part.copy(),
    )
