"""Feeds a localiser with the messages of a drive, and turns what it says into a record."""

from dataclasses import dataclass
from time import perf_counter
from typing import Any

import numpy as np
from numpy.typing import NDArray

from evaluation.episode import CONTROL_PERIOD
from evaluation.localization.config import LocalizationConfig
from evaluation.track import Track
from mapping.geometry import Pose
from mapping.io.map_server import MapFile
from mapping.localization.localizer import Localizer
from mapping.messages import ODOMETRY_COLUMNS, Imu, LaserScan, Odometry

SNAPSHOT_TIMES = (0.2, 2.0, 10.0)
"""Moments after the start, and after a kidnapping, whose belief is kept for drawing [s]."""

SNAPSHOT_POSES = 3000
"""At most so many poses of a belief are kept."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Snapshot:
    """A belief at a moment."""

    time: float
    poses: Pose
    """Poses that stand for the belief ``(n, 3)``."""
    pose_map: Pose
    """The best guess ``(3,)``."""
    pose_world: Pose
    """The truth ``(3,)``."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class LocalizationRun:
    """What a run left behind."""

    config: LocalizationConfig
    map_file: MapFile
    track: Track
    weights: NDArray[np.float64]
    """Weight of the likeliest hypothesis at every control period ``(n,)``."""
    ambiguous: NDArray[np.bool_]
    """Whether the localiser said that it was ambiguous ``(n,)``."""
    sizes: NDArray[np.int64]
    """Particles, cells looked at, or landmarks ``(n,)``."""
    update_seconds: NDArray[np.float64]
    """Wall time of each update that used a scan ``(m,)`` [s]; none where no scan saw anything."""
    update_sizes: NDArray[np.int64]
    """The size of the belief after it ``(m,)``."""
    snapshots: tuple[Snapshot, ...]
    kidnapped_at: float | None
    wall_time: float


class LocalizationRecording:
    """Feeds the localiser and notes what it says."""

    def __init__(self, config: LocalizationConfig, map_file: MapFile, localizer: Localizer) -> None:
        self.config = config
        self.kidnapped_at: float | None = None
        self._map_file = map_file
        self._localizer = localizer
        self._track = Track()
        self._rows: list[tuple[float, bool, int]] = []
        self._updates: list[tuple[float, int]] = []
        self._snapshots: list[Snapshot] = []

    def take(self, time: float, scan: LaserScan | None, observation: Any, pose_world: Pose) -> None:
        """Take the messages of one control period."""
        localizer, before = self._localizer, self._localizer.updates
        odometry = Odometry.from_observation(observation)
        imu = Imu.from_observation(observation)
        started = perf_counter()
        localizer.update(scan, odometry, imu)
        took = perf_counter() - started
        if localizer.updates > before:
            self._updates.append((took, localizer.size))
        newest = observation["odometry"][-1]
        x = ODOMETRY_COLUMNS.index("x")
        self._track.note(time, localizer.pose_map, pose_world, newest[x : x + 3])
        best = localizer.hypotheses[0].weight if localizer.hypotheses else 0.0
        self._rows.append((best, localizer.is_ambiguous, localizer.size))
        if self._is_moment(time):
            poses = localizer.sample
            kept = poses[:: max(1, -(-len(poses) // SNAPSHOT_POSES))].copy()
            self._snapshots.append(
                Snapshot(
                    time=time,
                    poses=kept,
                    pose_map=localizer.pose_map,
                    pose_world=pose_world.copy(),
                )
            )

    def run(self, wall_time: float) -> LocalizationRun:
        """What there is now."""
        weights, ambiguous, sizes = zip(*self._rows, strict=True)
        seconds, update_sizes = np.array(self._updates, dtype=np.float64).reshape(-1, 2).T
        return LocalizationRun(
            config=self.config,
            map_file=self._map_file,
            track=self._track,
            weights=np.array(weights, dtype=np.float64),
            ambiguous=np.array(ambiguous, dtype=np.bool_),
            sizes=np.array(sizes, dtype=np.int64),
            update_seconds=seconds,
            update_sizes=update_sizes.astype(np.int64),
            snapshots=tuple(self._snapshots),
            kidnapped_at=self.kidnapped_at,
            wall_time=wall_time,
        )

    def _is_moment(self, time: float) -> bool:
        """Whether the belief of now is to be kept."""
        since = time if self.kidnapped_at is None else time - self.kidnapped_at
        return any(abs(since - moment) < 0.5 * CONTROL_PERIOD for moment in SNAPSHOT_TIMES)
