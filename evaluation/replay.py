"""Maps a recorded log: every scan and odometry message into a mapper, as fast as it goes."""

from collections.abc import Callable
from dataclasses import dataclass, fields, replace
from pathlib import Path
from time import perf_counter
from typing import Any

import numpy as np
from numpy.typing import NDArray

from evaluation.failure import RunError
from evaluation.held_interrupt import held_interrupt
from evaluation.log_feed import LogFeed
from evaluation.recording import Recording
from mapping.errors import TestbedError
from mapping.gap_filling import GapFilling, check_rule, with_gaps_filled
from mapping.geometry import Pose, compose
from mapping.grid import OccupancyGrid
from mapping.log_editing import reach_of, rebased
from mapping.mapper import Mapper
from mapping.mappers import CONFIGS, MAPPERS, NoSettings, check_resolution, make_mapper
from mapping.odometry_trajectory import odometry_at_scans, odometry_trajectory
from mapping.pose_graph import PoseGraph
from mapping.pose_history import PoseHistory
from mapping.sensor_model import LONG_RANGE, RANGE_NOISES, LidarName, noise_of_reach
from mapping.settings import parse_settings
from mapping.slam.keyframe_pose_graph import pose_graph_of
from mapping.trajectory import Trajectory, completed, poses_at

COMPLETE, INTERRUPTED, ERROR = "complete", "interrupted", "error"

COARSE_CELL = 0.05
"""Edge of a map cell [m] for a lidar that sees a hall; for one like the LDS-01 it is the mapper's
own."""

Progress = Callable[[int], None]
"""Told how many scans are mapped."""


@dataclass(frozen=True, slots=True, kw_only=True)
class ReplayConfig:
    """Everything that defines a replay; the same config gives the same map."""

    log: Path
    """The log: a CARMEN file, a ROS 2 bag (MCAP or folder), or a run folder with a recorded log."""
    mapper: str = "graph"
    """graph, scan_match, gmapping, ogm or occgridmapp."""
    relations: Path | None = None
    """Relative poses checked by hand, to score the trajectory by (Kümmerle et al. 2009)."""
    max_range: float | None = None
    """Cut the lidar's range to this [m]: what lies beyond becomes a beam without return."""
    resolution: float | None = None
    """Edge of a map cell [m]; default the mapper's own (0.01, gmapping 0.05) for a lidar that
    reaches up to 4 m, else 0.05."""
    lidar: LidarName | None = None
    """How noisy the readings are; default lds01 for a lidar that reaches up to 4 m, else sick."""
    period: float = 0.0
    """Give the mapper a scan at most every so many seconds of the log; 0 gives it all."""
    gap_filling: GapFilling = "none"
    """Closes holes of walls in the map that is written and scored: none, thesis or better."""
    seed: int = 0
    """Seed of the mapper's random numbers, if it draws any."""
    set: tuple[str, ...] = ()
    """Settings of the mapper, NAME=VALUE each."""

    def __post_init__(self) -> None:
        """Refuse figures that make no replay."""
        if self.max_range is not None and not 0.0 < self.max_range < np.inf:
            raise TestbedError(f"max_range: {self.max_range} m; must be finite and above 0")
        check_resolution(self.resolution)
        if not 0.0 <= self.period < np.inf:
            raise TestbedError(f"period: {self.period} s; must be finite, 0 or more")
        check_rule(self.gap_filling)
        if self.seed < 0:
            raise TestbedError(f"seed: {self.seed}; must be 0 or more")


@dataclass(frozen=True, slots=True, kw_only=True)
class Replay:
    """What a replay left behind: the map, the trajectories and the counts."""

    config: ReplayConfig
    """As it was run: with what it leaves open decided."""
    recording: Recording
    grid: OccupancyGrid
    trajectory: Trajectory
    """Where the mapper, in the end, takes the robot to have been, at the stamp of every scan for
    which there is odometry; those that it did not get are filled in by odometry."""
    online: Trajectory
    """Where it took the robot to be at the time, at the newest odometry after each scan."""
    odometry: Trajectory
    """What odometry said, in the frame where the robot started."""
    stop_reason: str
    log_time: float
    """Time from the first message to the last one mapped [s]."""
    wall_time: float
    """Wall time that the mapper took for all of it [s]."""
    map_updates: int
    scans_dropped: int
    map_update_seconds: NDArray[np.float64]
    """Wall time of each map update ``(n,)`` [s]."""
    map_update_stamps: NDArray[np.float64]
    """Stamp of the scan that each took in ``(n,)`` [s]."""
    pose_graph: PoseGraph | None = None
    """The mapper's keyframes and the matches between them, if it keeps such."""


def run_replay(
    config: ReplayConfig, recording: Recording, on_progress: Progress | None = None
) -> Replay:
    """Map a log to its end; Ctrl-C ends it early and keeps what there is.

    The map frame is the robot's pose at the first odometry message, or the world frame for a run
    folder. Every message of the log is given to the mapper, but for scans that are not due yet.

    Args:
        config: What to run.
        recording: The log and what it is scored against.
        on_progress: Called after each scan with how many there were.

    Raises:
        TestbedError: The config names something that does not exist or cannot be used.
        RunError: Anything raised an error after the first scan; it carries the replay up to there,
            and the error is its cause.
    """
    config, log = _decided(config, recording), recording.log
    assert config.max_range is not None
    odometry = log.odometry if recording.is_simulated else rebased(log.odometry)
    mapper = _mapper(config, recording)
    feed = LogFeed(mapper, max_range=config.max_range, period=config.period)
    stop_reason, error = COMPLETE, None
    try:
        with held_interrupt() as check_interrupt:
            for period in replace(log, odometry=odometry).periods():
                check_interrupt()
                feed.give(period)
                if on_progress is not None:
                    on_progress(feed.scans)
    except (KeyboardInterrupt, Exception) as early_end:
        if mapper.updates == 0 or feed.scans == 0:
            raise  # there is nothing to keep yet
        stop_reason = INTERRUPTED
        if isinstance(early_end, Exception):
            stop_reason, error = ERROR, early_end
    started = perf_counter()
    try:
        mapper.finish()
    except Exception as broken:
        stop_reason, error = ERROR, error or broken
    grid, known = mapper.grid, mapper.trajectory
    wall_time = feed.wall_time + perf_counter() - started
    told = odometry_at_scans(log.scans[: feed.scans], odometry)
    replay = Replay(
        config=config,
        recording=recording,
        grid=with_gaps_filled(grid, config.gap_filling),
        trajectory=_at_every_scan(known, told, recording.start_pose_map),
        online=Trajectory(stamps=feed.online.stamps, poses=feed.online.poses),
        odometry=odometry_trajectory(odometry),
        stop_reason=stop_reason,
        log_time=feed.newest - feed.oldest,
        wall_time=wall_time,
        map_updates=mapper.updates,
        scans_dropped=mapper.scans_dropped + feed.repeated,
        map_update_seconds=np.array(feed.map_update_seconds),
        map_update_stamps=np.array(feed.map_update_stamps),
        pose_graph=pose_graph_of(mapper),
    )
    if error is not None:
        raise RunError(replay) from error
    return replay


def check_replay(config: ReplayConfig, recording: Recording) -> None:
    """Refuse what `run_replay` would refuse, without mapping anything.

    Raises:
        TestbedError: The config names something that does not exist or cannot be used.
    """
    _mapper(_decided(config, recording), recording)


def _decided(config: ReplayConfig, recording: Recording) -> ReplayConfig:
    """The config with the defaults that depend on how far the log's lidar sees."""
    reach = reach_of(recording.log, config.max_range)
    names = {noise: name for name, noise in RANGE_NOISES.items()}
    own = COARSE_CELL if reach > LONG_RANGE else None
    return replace(
        config,
        max_range=reach if config.max_range is None else min(reach, config.max_range),
        resolution=own if config.resolution is None else config.resolution,
        lidar=names[noise_of_reach(reach)] if config.lidar is None else config.lidar,
    )


def _mapper(config: ReplayConfig, recording: Recording) -> Mapper:
    """The mapper, told about the lidar as far as it has settings for that."""
    if config.mapper not in MAPPERS:
        raise TestbedError(f"mapper: {config.mapper!r}; must be one of {', '.join(MAPPERS)}")
    assert config.lidar is not None
    kind = CONFIGS.get(config.mapper, NoSettings)
    told = {
        "max_range": config.max_range,
        "range_noise": RANGE_NOISES[config.lidar],
        "lidar_pose_base": recording.log.lidar_pose_base,
        "seed": config.seed,
    }
    known = {field.name for field in fields(kind)}
    settings: dict[str, Any] = {name: value for name, value in told.items() if name in known}
    return make_mapper(
        config.mapper,
        start_pose_map=recording.start_pose_map,
        resolution=config.resolution,
        settings=settings | parse_settings(kind, config.set),
    )


def _at_every_scan(known: PoseHistory, told: Trajectory, start_pose_map: Pose) -> Trajectory:
    """The mapper's poses, and between them what odometry tells of the scans that it did not get."""
    if len(known) == 0:
        return Trajectory(stamps=told.stamps, poses=compose(start_pose_map, told.poses))
    stamps = np.union1d(told.stamps, known.stamps)
    sparse = Trajectory(stamps=known.stamps, poses=known.poses)
    return completed(sparse, Trajectory(stamps=stamps, poses=poses_at(told, stamps)))
