"""Logs made in code, replayed: frames, gaps, cut ranges, scores, files, Ctrl-C, broken data."""

import json
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from envs.floor_plan import Cylinder, FloorPlan, Wall
from envs.plan_yaml import write_plan
from evaluation.episode import EpisodeConfig, run_episode
from evaluation.episode_folder import write_run
from evaluation.recorder import Recorder
from evaluation.recording import Recording, check_recording, load_recording
from evaluation.replay import ReplayConfig, run_replay
from evaluation.replay_folder import write_replay
from evaluation.result import TIMING_KEYS
from evaluation.warm_up import TINY_ROOM
from mapping.burger import LIDAR_POSE_BASE
from mapping.errors import TestbedError
from mapping.geometry import between, compose
from mapping.grid import UNKNOWN
from mapping.io.carmen_writer import write_carmen
from mapping.io.g2o import read_g2o
from mapping.io.map_server import read_map
from mapping.io.tum import read_tum, write_tum
from mapping.mappers import MAPPERS
from mapping.messages import LaserScan, Odometry, Twist
from mapping.relations import Relations
from mapping.sensor_log import SensorLog
from mapping.trajectory import Trajectory, poses_at
from tests.evaluation.test_episode import DESIGN_KEYS
from tests.mapping.arena import HALF_HEIGHT, HALF_WIDTH, POSTS, circling, drive

ROOT = Path(__file__).resolve().parents[2]

SECONDS = 12.0
START = (1.45, 0.0, np.pi / 2)
"""Where a drive around the arena starts."""

RELATION_KEYS = {
    f"relations_{key}"
    for key in ("used", "trans_mean_m", "trans_std_m", "trans_max_m", "rot_mean_deg")
}

X, Y = HALF_WIDTH + 0.05, HALF_HEIGHT + 0.05
ARENA = FloorPlan(
    name="arena",
    start=START,
    walls=(Wall(points=((-X, -Y), (X, -Y), (X, Y), (-X, Y)), closed=True, thickness=0.1),),
    cylinders=tuple(Cylinder(center=(x, y), radius=radius) for x, y, radius in POSTS),
)


def true_trajectory() -> Trajectory:
    stamps = 0.1 * np.arange(round(SECONDS / 0.1) + 1)
    return Trajectory(stamps=stamps, poses=compose(np.zeros(3), circling()(stamps)))


def log_in_frame(frame: tuple[float, float, float]) -> SensorLog:
    """A drive around the arena with odometry without error, told in a frame of its own."""
    scans, odometry = [], []
    for scan, messages in drive(circling(), SECONDS):
        scans += [] if scan is None else [scan]
        odometry += messages
    return SensorLog(
        source="arena.log",
        scans=scans,
        odometry=[
            replace(each, pose_odom=compose(frame, between(START, each.pose_odom)))
            for each in odometry
        ],
        lidar_pose_base=LIDAR_POSE_BASE,
    )


LOG = log_in_frame((0.0, 0.0, 0.0))
RECORDING = Recording(log=LOG)
RUN = Recording(log=LOG, ground_truth=true_trajectory(), plan=ARENA, world="arena")
COARSE = ReplayConfig(log=Path("arena.log"), mapper="ogm", resolution=0.05)


def test_the_map_frame_is_the_pose_of_the_first_odometry() -> None:
    replay = run_replay(COARSE, Recording(log=log_in_frame((200.0, -30.0, 2.0))))
    expected = between(START, circling()(replay.trajectory.stamps))
    assert np.allclose(between(replay.trajectory.poses, expected), 0.0, atol=1e-9)
    assert replay.odometry.poses[0] == pytest.approx([0.0, 0.0, 0.0], abs=1e-12)
    # the grid starts 25.6 m wide around the start; in the log's frame it would be 200 m away
    assert np.all(np.abs(replay.grid.origin) < 13.0)


def test_a_run_folder_is_mapped_in_the_frame_of_its_world_and_scored(tmp_path: Path) -> None:
    result = write_replay(run_replay(replace(COARSE, resolution=0.01), RUN), tmp_path)
    # arithmetic in float32 and true poses interpolated between tenths of a second, 2 cm apart
    assert result["ate_max_m"] < 1e-3
    assert result["ate_online_rmse_m"] < 1e-3
    assert result["rpe_trans_rmse_m"] < 1e-3
    assert result["f1_5cm"] > 0.9, "in the frame of the truth, unaligned"
    assert result["coverage"] > 0.5
    assert result["world"] == "arena"
    assert read_tum(tmp_path / "ground_truth.tum").stamps.tolist() == pytest.approx(
        RUN.ground_truth.stamps.tolist()  # type: ignore[union-attr]
    )


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


def test_the_relations_of_a_true_trajectory_have_no_error(tmp_path: Path) -> None:
    stamps = np.array([[0.0, 10.0], [2.0, 4.0], [3.0, 300.0]])
    poses = between(circling()(stamps[:, 0]), circling()(stamps[:, 1]))
    recording = Recording(log=LOG, relations=Relations(stamps=stamps, poses=poses))
    result = write_replay(run_replay(COARSE, recording), tmp_path)
    assert result["relations_used"] == 2
    assert result["relations_trans_max_m"] == pytest.approx(0.0, abs=1e-6)
    assert result["relations_rot_mean_deg"] == pytest.approx(0.0, abs=1e-4)
    assert result["ate_rmse_m"] is None


def test_a_replay_writes_the_files_and_keys_of_an_episode_and_the_same_bytes_again(
    tmp_path: Path,
) -> None:
    results = []
    for name in ("a", "b"):
        (tmp_path / name).mkdir()
        (tmp_path / name / "ground_truth.tum").write_text("of an earlier run")
        results.append(write_replay(run_replay(COARSE, RECORDING), tmp_path / name))
    assert set(results[0]) == DESIGN_KEYS | RELATION_KEYS | {"log"}
    for key in TIMING_KEYS:
        for result in results:
            result.pop(key)
    assert results[0] == results[1]
    files = {"config.json", "map.pgm", "map.yaml", "map.png", "trajectory.tum", "odometry.tum"}
    assert {path.name for path in (tmp_path / "a").iterdir()} == files | {"result.json"}
    for file in files:
        assert (tmp_path / "a" / file).read_bytes() == (tmp_path / "b" / file).read_bytes(), file
    assert (read_map(tmp_path / "a" / "map.yaml").states == 0).any()
    assert json.loads((tmp_path / "a" / "config.json").read_text())["resolution"] == 0.05


def test_ctrl_c_ends_a_replay_and_keeps_the_map(tmp_path: Path) -> None:
    def stop(scans: int) -> None:
        if scans == 20:
            raise KeyboardInterrupt

    replay = run_replay(COARSE, RUN, stop)
    assert replay.stop_reason == "interrupted"
    assert len(replay.trajectory.stamps) == 20
    assert replay.map_updates == 20
    assert write_replay(replay, tmp_path)["coverage"] > 0.1


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


EVERY_SCAN = {"gmapping": ("temporalUpdate=0",), "occgridmapp": ("turn_gate=none",)}
"""Settings of mappers that else leave out scans: of a robot that hardly moves, or that turns."""


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


def test_the_graph_mapper_leaves_its_pose_graph(tmp_path: Path) -> None:
    replay = run_replay(replace(COARSE, mapper="graph"), RECORDING)
    write_replay(replay, tmp_path)
    written, known = read_g2o(tmp_path / "graph.g2o"), replay.pose_graph
    assert known is not None
    assert len(written.ids) > 1
    assert np.array_equal(written.poses, known.poses)
    assert np.array_equal(written.information, known.information)
    keyframes = [poses_at(replay.trajectory, [s])[0] for s in replay.trajectory.stamps]
    away = between(written.poses[:, None], np.array(keyframes)[None])
    assert np.hypot(*away[..., :2].transpose(2, 0, 1)).min(axis=1).max() < 1e-6, "of some scan each"
    write_replay(run_replay(COARSE, RECORDING), tmp_path)
    assert not (tmp_path / "graph.g2o").exists(), "of an earlier run"


def test_a_replay_needs_no_simulator() -> None:
    code = (
        "import sys, scripts.replay;"
        "sys.exit(','.join({'mujoco', 'gtsam', 'evaluation.episode'} & set(sys.modules)) or 0)"
    )
    outcome = subprocess.run(
        [sys.executable, "-c", code], cwd=ROOT, capture_output=True, text=True, check=False
    )
    assert outcome.returncode == 0, outcome.stderr


def test_a_log_of_one_scan_is_mapped(tmp_path: Path) -> None:
    log = SensorLog(
        source="one.log",
        scans=[LaserScan(stamp=5.0, ranges=np.ones(4, dtype=np.float32), time_increment=0.0)],
        odometry=[Odometry(stamp=5.0, pose_odom=np.zeros(3), twist=Twist())],
    )
    result = write_replay(run_replay(COARSE, Recording(log=log)), tmp_path)
    assert result["map_updates"] == 1
    assert result["sim_time_s"] == 0.0
    assert result["map_update_rate_hz"] is None


def far_away(trajectory: Trajectory) -> Trajectory:
    return Trajectory(stamps=trajectory.stamps + 1e6, poses=trajectory.poses)


ELSEWHERE = Relations(stamps=np.array([[1e6, 2e6]]), poses=np.zeros((1, 3)))


@pytest.mark.parametrize(
    ("recording", "told"),
    [
        (Recording(log=replace(LOG, scans=[])), r"arena\.log: there is no laser scan"),
        (Recording(log=replace(LOG, odometry=[])), "no odometry near"),
        (Recording(log=LOG, relations=ELSEWHERE), "none of 1 relations"),
        (Recording(log=LOG, ground_truth=far_away(true_trajectory())), "ground_truth"),
    ],
)
def test_a_log_that_cannot_be_mapped_or_scored_is_refused_before_it_is_mapped(
    recording: Recording, told: str
) -> None:
    with pytest.raises(TestbedError, match=told):
        check_recording(recording, Path("a.relations"))


def run_folder_of(folder: Path, world: str) -> Path:
    write_carmen(folder / "log.carmen", LOG)
    truth = true_trajectory()
    write_tum(folder / "ground_truth.tum", truth.stamps, truth.poses)
    (folder / "config.json").write_text(json.dumps({"world": world}))
    return folder


def test_a_run_folder_tells_its_world_and_the_truth(tmp_path: Path) -> None:
    write_plan(ARENA, tmp_path / "arena.yaml")
    recording = load_recording(run_folder_of(tmp_path, str(tmp_path / "arena.yaml")))
    assert recording.plan == ARENA
    assert recording.start_pose_map.tolist() == list(START)
    assert recording.ground_truth is not None
    assert len(recording.log.scans) == 60
    assert recording.sha256 is not None
    before = recording.sha256
    (tmp_path / "result.json").write_text("{}")
    assert load_recording(tmp_path).sha256 == before, "the log is hashed, not the whole folder"
    log = tmp_path / "log.carmen"
    log.write_text(log.read_text() + "# one more line\n")
    assert load_recording(tmp_path).sha256 != before


@pytest.mark.parametrize("mapper", ["ogm", "occgridmapp"])
def test_a_recorded_episode_replays_to_the_same_map_and_trajectory(
    mapper: str, tmp_path: Path
) -> None:
    write_plan(TINY_ROOM, tmp_path / "tiny.yaml")
    world = str(tmp_path / "tiny.yaml")
    config = EpisodeConfig(world=world, mapper=mapper, time_limit=10.0)
    explored = write_run(run_episode(config, recorder=Recorder()), tmp_path / "explored")
    recording = load_recording(tmp_path / "explored")
    again = ReplayConfig(log=tmp_path / "explored", mapper=mapper)
    replayed = write_replay(run_replay(again, recording), tmp_path / "replayed")
    for file in ("map.pgm", "map.yaml", "trajectory.tum"):
        one, other = (tmp_path / folder / file for folder in ("explored", "replayed"))
        assert one.read_bytes() == other.read_bytes(), file
    assert replayed["f1_5cm"] == explored["f1_5cm"]
    assert replayed["ate_rmse_m"] == pytest.approx(explored["ate_rmse_m"], abs=1e-6)


def test_a_run_folder_whose_world_is_gone_is_scored_by_its_trajectory_alone(
    tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    recording = load_recording(run_folder_of(tmp_path, "/gone/arena.yaml"))
    assert "/gone/arena.yaml" in caplog.text
    assert recording.start_pose_map == pytest.approx(START)
    result = write_replay(run_replay(COARSE, recording), tmp_path / "out")
    assert result["ate_rmse_m"] is not None
    assert result["f1_5cm"] is None


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
