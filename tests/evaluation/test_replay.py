"""Logs made in code, replayed: frames, periods, cut ranges, settings, Ctrl-C, bad options."""

import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from evaluation.failure import RunError
from evaluation.recording import Recording
from evaluation.replay import Replay, ReplayConfig, run_replay
from evaluation.replay_folder import write_replay
from mapping.errors import TestbedError
from mapping.geometry import between
from mapping.grid import UNKNOWN
from mapping.mappers import MAPPERS
from mapping.occ_grid_mapp import OccGridMapp
from tests.evaluation.arena_log import COARSE, LOG, RECORDING, RUN, START, log_in_frame
from tests.mapping.arena import circling

ROOT = Path(__file__).resolve().parents[2]


def test_the_map_frame_is_the_pose_of_the_first_odometry() -> None:
    replay = run_replay(COARSE, Recording(log=log_in_frame((200.0, -30.0, 2.0))))
    expected = between(START, circling()(replay.trajectory.stamps))
    assert np.allclose(between(replay.trajectory.poses, expected), 0.0, atol=1e-9)
    assert replay.odometry.poses[0] == pytest.approx([0.0, 0.0, 0.0], abs=1e-12)
    # the grid starts 25.6 m wide around the start; in the log's frame it would be 200 m away
    assert np.all(np.abs(replay.grid.origin) < 13.0)


def test_a_mapper_gets_a_scan_at_most_every_period_and_every_scan_gets_a_pose() -> None:
    every = run_replay(COARSE, RECORDING)
    seldom = run_replay(replace(COARSE, period=2.0), RECORDING)
    assert every.map_updates == len(LOG.scans) == 60
    assert seldom.map_updates == 6
    assert np.array_equal(seldom.trajectory.stamps, every.trajectory.stamps)
    assert len(every.trajectory.stamps) == 60
    errors = between(seldom.trajectory.poses, every.trajectory.poses)
    assert np.allclose(errors, 0.0, atol=1e-9), "true odometry fills the gaps exactly"


def test_a_period_that_the_scans_just_keep_leaves_none_out() -> None:
    rounded = [replace(scan, stamp=round(scan.stamp + 4e-7, 6)) for scan in LOG.scans]
    replay = run_replay(replace(COARSE, period=0.2), Recording(log=replace(LOG, scans=rounded)))
    assert replay.map_updates == 60


def test_what_lies_beyond_the_cut_range_is_not_on_the_map() -> None:
    replay = run_replay(replace(COARSE, max_range=0.5), RECORDING)
    cells = np.argwhere(replay.grid.states() != UNKNOWN)
    assert len(cells) > 100
    known, path = replay.grid.cell_to_world(cells), replay.trajectory.poses[:, :2]
    distance = np.min(np.hypot(*(known[:, None] - path[None]).transpose(2, 0, 1)), axis=1)
    # the lidar stands 3 cm behind, the robot goes 4 cm in a scan, a cell's half diagonal is 3.5 cm
    assert distance.max() < 0.5 + 0.03 + 0.04 + 0.035


@pytest.mark.parametrize(
    ("range_max", "lidar", "resolution", "cut"),
    [(3.5, "lds01", None, 3.5), (81.0, "sick", 0.05, 5.0)],
)
def test_a_lidars_reach_decides_on_its_noise_and_the_cells(
    range_max: float, lidar: str, resolution: float | None, cut: float
) -> None:
    scans = [replace(LOG.scans[0], range_max=range_max)]
    config = replace(COARSE, resolution=None, max_range=5.0)
    decided = run_replay(config, Recording(log=replace(LOG, scans=scans))).config
    assert (decided.lidar, decided.resolution, decided.max_range) == (lidar, resolution, cut)
    told = replace(config, lidar="lds01", resolution=0.1)
    decided = run_replay(told, Recording(log=replace(LOG, scans=scans))).config
    assert (decided.lidar, decided.resolution) == ("lds01", 0.1)


def test_ctrl_c_ends_a_replay_and_keeps_the_map(tmp_path: Path) -> None:
    def stop(scans: int) -> None:
        if scans == 20:
            raise KeyboardInterrupt

    replay = run_replay(COARSE, RUN, stop)
    assert replay.stop_reason == "interrupted"
    assert len(replay.trajectory.stamps) == 20
    assert replay.map_updates == 20
    assert write_replay(replay, tmp_path)["coverage"] > 0.1


def test_an_error_ends_a_replay_and_keeps_its_map(tmp_path: Path) -> None:
    def fail(scans: int) -> None:
        if scans == 20:
            raise ZeroDivisionError("a defect of one's own")

    with pytest.raises(RunError) as caught:
        run_replay(COARSE, RUN, fail)
    assert isinstance(caught.value.__cause__, ZeroDivisionError)
    assert isinstance(caught.value.left, Replay)
    result = write_replay(caught.value.left, tmp_path)
    assert result["stop_reason"] == "error"
    assert result["coverage"] > 0.1


def test_ctrl_c_before_the_first_scan_leaves_nothing_to_keep() -> None:
    def stop(scans: int) -> None:
        raise KeyboardInterrupt

    blind = [replace(LOG.scans[0], ranges=np.zeros(360, dtype=np.float32))]
    with pytest.raises(KeyboardInterrupt):
        run_replay(COARSE, Recording(log=replace(LOG, scans=blind)), stop)


def test_progress_is_told_scan_by_scan() -> None:
    told: list[int] = []
    run_replay(COARSE, RECORDING, told.append)
    assert sorted(set(told)) == list(range(1, 61))


def test_a_replay_needs_no_simulator() -> None:
    code = (
        "import sys, scripts.replay;"
        "sys.exit(','.join({'mujoco', 'gtsam', 'evaluation.episode'} & set(sys.modules)) or 0)"
    )
    outcome = subprocess.run(
        [sys.executable, "-c", code], cwd=ROOT, capture_output=True, text=True, check=False
    )
    assert outcome.returncode == 0, outcome.stderr


@pytest.mark.parametrize(
    "wrong",
    [
        {"max_range": 0.0},
        {"max_range": float("inf")},
        {"resolution": 0.0},
        {"period": -1.0},
        {"period": float("nan")},
        {"seed": -1},
    ],
)
def test_a_config_that_makes_no_replay_is_refused(wrong: dict[str, float]) -> None:
    with pytest.raises(TestbedError, match=next(iter(wrong))):
        ReplayConfig(log=Path("a.log"), **wrong)  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("wrong", "told"),
    [({"mapper": "nonsense"}, "nonsense.*ogm"), ({"set": ("hits=1",)}, "hits.*must be one of")],
)
def test_an_unknown_name_is_refused_with_the_known_ones(
    wrong: dict[str, object], told: str
) -> None:
    with pytest.raises(TestbedError, match=told):
        run_replay(replace(COARSE, **wrong), RECORDING)  # type: ignore[arg-type]


def test_settings_reach_the_mapper() -> None:
    config = replace(COARSE, set=("highest=3.5", "lowest=-3.5"))
    assert run_replay(config, RECORDING).grid.log_odds.max() == 3.5


def test_a_mapper_of_ones_own_enters_by_its_name_alone(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(MAPPERS, "mine", lambda start, *_: OccGridMapp(start_pose_map=start))
    assert run_replay(replace(COARSE, mapper="mine", set=()), RECORDING).map_updates > 0
    with pytest.raises(TestbedError, match="hits"):
        run_replay(replace(COARSE, mapper="mine", set=("hits=1",)), RECORDING)
