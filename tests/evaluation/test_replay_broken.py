"""Logs with broken messages, replayed by every mapper."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from evaluation.recording import Recording
from evaluation.replay import run_replay
from evaluation.replay_folder import write_replay
from mapping.mappers import MAPPERS
from mapping.sensor_log import SensorLog
from tests.evaluation.arena_log import COARSE, EVERY_SCAN, LOG


def broken_log() -> SensorLog:
    """Scans without beams and without sense, a time that runs backwards, an odometry that jumps."""
    scans, odometry = list(LOG.scans), list(LOG.odometry)
    scans[3] = replace(scans[3], ranges=np.empty(0, dtype=np.float32))
    scans[5] = replace(scans[5], ranges=np.full(360, np.nan, dtype=np.float32))
    scans[7] = replace(scans[7], stamp=np.nan)
    scans[9] = replace(scans[9], stamp=0.3)
    scans[11] = replace(scans[11], range_max=np.nan)
    odometry[50] = replace(odometry[50], pose_odom=np.full(3, np.nan))
    odometry[60] = replace(odometry[60], stamp=1.0)
    jump = np.array([5.0, 0.0, 0.0])
    odometry[90:] = [replace(each, pose_odom=each.pose_odom + jump) for each in odometry[90:]]
    return replace(LOG, scans=scans, odometry=odometry)


@pytest.mark.parametrize("mapper", MAPPERS)
def test_every_mapper_survives_a_broken_log(mapper: str, tmp_path: Path) -> None:
    config = replace(COARSE, mapper=mapper, resolution=0.1, set=EVERY_SCAN.get(mapper, ()))
    replay = run_replay(config, Recording(log=broken_log()))
    assert replay.map_updates > 40
    assert np.all(np.isfinite(replay.grid.log_odds))
    assert 56 <= len(replay.trajectory.stamps) <= 58, "all but the two without a time of their own"
    write_replay(replay, tmp_path)


@pytest.mark.parametrize("mapper", MAPPERS)
@pytest.mark.parametrize("far", [1e6, 1e17, 1e300])
def test_an_odometry_that_jumps_to_the_end_of_the_world_takes_no_memory(
    mapper: str, far: float
) -> None:
    shift = np.array([far, -far, 0.0])
    odometry = list(LOG.odometry)
    odometry[90:] = [replace(each, pose_odom=each.pose_odom + shift) for each in odometry[90:]]
    recording = Recording(log=replace(LOG, odometry=odometry))
    config = replace(COARSE, mapper=mapper, resolution=0.1, set=EVERY_SCAN.get(mapper, ()))
    replay = run_replay(config, recording)
    # seen before the jump: a room of 4 x 3 m; the grid may have grown by a tile or two
    assert replay.grid.log_odds.size < 2_000_000
    assert np.all(np.isfinite(replay.grid.log_odds))
    assert np.all(np.isfinite(replay.trajectory.poses))
    assert np.count_nonzero(replay.grid.log_odds) > 500, "12 m2 in cells of 0.01 m2"


@pytest.mark.parametrize("mapper", MAPPERS)
@pytest.mark.parametrize("far", [1e30, 1e308])
def test_single_messages_from_beyond_the_world_are_left_out(mapper: str, far: float) -> None:
    odometry = [
        replace(each, pose_odom=np.array([far, -far, 0.0])) if i % 40 == 0 else each
        for i, each in enumerate(LOG.odometry)
    ]
    config = replace(COARSE, mapper=mapper, resolution=0.1)
    replay = run_replay(config, Recording(log=replace(LOG, odometry=odometry)))
    assert np.all(np.isfinite(replay.grid.log_odds))
    assert np.abs(replay.trajectory.poses).max() < 10.0


@pytest.mark.parametrize("range_max", [0.0, np.inf, np.nan])
def test_a_log_that_does_not_tell_its_range_is_mapped_with_one_that_is_given(
    range_max: float,
) -> None:
    scans = [replace(scan, range_max=range_max) for scan in LOG.scans]
    silent, told = (
        run_replay(replace(COARSE, max_range=3.0), Recording(log=replace(LOG, scans=each)))
        for each in (scans, LOG.scans)
    )
    assert silent.config.max_range == 3.0
    assert np.array_equal(silent.grid.log_odds, told.grid.log_odds)


def test_scans_of_one_time_are_counted_as_dropped() -> None:
    scans = [each for scan in LOG.scans for each in (scan, scan)]
    replay = run_replay(COARSE, Recording(log=replace(LOG, scans=scans)))
    assert (replay.map_updates, replay.scans_dropped) == (60, 60)
