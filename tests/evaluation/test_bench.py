import numpy as np
import pytest

from evaluation.bench import loop_of, record_drive
from evaluation.episode import EpisodeConfig, run_episode
from evaluation.kernels.warm_up import TINY_ROOM


def test_a_drive_has_every_message_once() -> None:
    drive = record_drive("empty_room", 30)
    assert len(drive) == 30
    stamps = np.array([each.stamp for _, odometry, _ in drive for each in odometry])
    assert np.all(np.diff(stamps) > 0.0)
    scans = {scan.stamp for scan, *_ in drive if scan is not None}
    # 3 s at 5 scans a second, but for the sweep that is not over yet and the turn at the start
    assert 12 <= len(scans) <= 15
    assert all(len(imu) for _, _, imu in drive)


def test_the_shares_of_a_loop_make_its_wall_time() -> None:
    episode = run_episode(EpisodeConfig(mapper="ogm", time_limit=2.0), plan=TINY_ROOM)
    loop = loop_of(episode)
    spent = loop.simulation_ms + loop.mapping_ms + loop.navigation_ms
    assert spent == pytest.approx(1e3 * episode.wall_time / episode.sim_time)
    assert min(loop.simulation_ms, loop.mapping_ms, loop.navigation_ms) > 0.0
    assert loop.decision_ms is not None
    assert 0.0 < loop.decision_ms < 1e3 * episode.navigator_seconds.sum()
