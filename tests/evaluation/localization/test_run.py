"""A localisation from the command's side: when the robot counts as located, and its files."""

import json
from pathlib import Path
from unittest.mock import patch

import numpy as np
import pytest

from envs.floor_plan import FloorPlan, Wall
from evaluation.kernels.warm_up import TINY_ROOM
from evaluation.localization.config import LocalizationConfig
from evaluation.localization.folder import BELIEF_COLUMNS, write_localization
from evaluation.localization.places import Places
from evaluation.localization.recording import LocalizationRun
from evaluation.localization.result import (
    TIMING_KEYS,
    Errors,
    is_found,
    located_at,
)
from evaluation.localization.run import run_localization
from evaluation.localization.warm_up import tiny_map
from mapping.errors import TestbedError
from mapping.grid import FREE, OCCUPIED
from mapping.io.map_server import MapFile
from mapping.io.tum import read_tum
from mapping.localization.localizers import FilterName
from scripts.localize import summary


def errors(meters: list[float], degrees: list[float] | None = None) -> Errors:
    """One error every half second."""
    count = len(meters)
    return Errors(
        stamps=0.5 * np.arange(count),
        meters=np.array(meters),
        degrees=np.array([0.0] * count if degrees is None else degrees),
    )


def test_located_is_near_for_five_seconds_counted_from_its_beginning() -> None:
    assert located_at(errors([1.0, 1.0] + [0.1] * 11), 0.0, np.inf) == 1.0
    assert located_at(errors([1.0, 1.0] + [0.1] * 9), 0.0, np.inf) is None, "4 s only"
    broken = [1.0] + [0.1] * 8 + [0.3] + [0.1] * 11
    assert located_at(errors(broken), 0.0, np.inf) == 5.0
    assert located_at(errors([0.1] * 20, [15.0] * 20), 0.0, np.inf) is None, "it looks elsewhere"


def test_only_what_lies_in_the_interval_counts() -> None:
    early = [0.1] * 12 + [1.0] * 12
    assert located_at(errors(early), 0.0, 6.0) == 0.0
    assert located_at(errors(early), 3.0, np.inf) is None


@pytest.fixture(scope="module")
def run() -> LocalizationRun:
    return tiny_run(seed=2)


def tiny_run(seed: int) -> LocalizationRun:
    config = LocalizationConfig(
        map=Path("tiny.yaml"), world="tiny_room", kidnap=7.0, seed=seed, time_limit=14.0
    )
    return run_localization(config, plan=TINY_ROOM, map_file=tiny_map())


def test_a_run_finds_the_robot_and_finds_it_again(run: LocalizationRun, tmp_path: Path) -> None:
    result = write_localization(run, tmp_path)
    assert is_found(result)
    assert result["localized_at_s"] <= 1.0
    assert result["relocalized_after_s"] <= 2.0
    assert result["error_rmse_m"] < 0.05
    assert result["yaw_rmse_deg"] < 1.0
    assert result["size_first"] == 200_000
    assert result["size_median"] < 5000
    written = json.loads((tmp_path / "result.json").read_text())
    assert written == result
    estimate, truth = read_tum(tmp_path / "trajectory.tum"), read_tum(tmp_path / "ground_truth.tum")
    assert len(estimate.stamps) == len(truth.stamps) == len(run.sizes)
    lines = (tmp_path / "belief.csv").read_text().splitlines()
    assert lines[0] == ",".join(BELIEF_COLUMNS)
    assert len(lines) == len(run.sizes) + 1
    assert (tmp_path / "localize.png").stat().st_size > 10_000
    assert json.loads((tmp_path / "config.json").read_text())["kidnap"] == 7.0


def test_the_kidnapping_is_real(run: LocalizationRun) -> None:
    track = run.track
    k = int(np.argmin(np.abs(track.stamps - run.kidnapped_at)))
    jump = np.hypot(*(track.pose_world[k + 1, :2] - track.pose_world[k, :2]))
    told = np.hypot(*(track.pose_odom[k + 1, :2] - track.pose_odom[k, :2]))
    assert jump > 0.3
    assert told < 0.05


def test_the_same_seed_gives_the_same_run(run: LocalizationRun, tmp_path: Path) -> None:
    first = write_localization(run, tmp_path / "first")
    second = write_localization(tiny_run(seed=2), tmp_path / "second")
    for key in first.keys() - set(TIMING_KEYS):
        assert first[key] == second[key], key
    for name in ("trajectory.tum", "belief.csv", "localize.png"):
        one, other = (tmp_path / folder / name for folder in ("first", "second"))
        assert one.read_bytes() == other.read_bytes(), name


def test_what_makes_no_run_is_refused() -> None:
    def config(**changes: object) -> LocalizationConfig:
        return LocalizationConfig(map=Path("map.yaml"), world="lim_room", **changes)  # type: ignore[arg-type]

    with pytest.raises(TestbedError, match="kidnap"):
        config(kidnap=70.0, time_limit=60.0)
    with pytest.raises(TestbedError, match="kidnap"):
        config(kidnap=float("nan"))
    with pytest.raises(TestbedError, match="seed"):
        config(seed=-1)
    with pytest.raises(TestbedError, match="start"):
        config(filter="ekf")
    assert config(kidnap=60.0).end == 120.0
    assert config().end == 60.0


@pytest.mark.parametrize("name", ["particle", "histogram", "ekf"])
def test_where_no_scan_sees_anything_the_result_says_so(name: FilterName, tmp_path: Path) -> None:
    far = ((-9.0, -9.0), (9.0, -9.0), (9.0, 9.0), (-9.0, 9.0))
    hall = FloorPlan(name="hall", start=(0.0, 0.0, 0.0), walls=(Wall(points=far, closed=True),))
    states = np.full((180, 180), FREE, dtype=np.int8)
    states[[0, -1]] = states[:, [0, -1]] = OCCUPIED
    config = LocalizationConfig(
        map=Path("hall.yaml"), world="hall", filter=name, start="known", seed=1, time_limit=1.0
    )
    with patch.object(Places, "draw", return_value=(0.5, 0.5, 0.3)):
        run = run_localization(
            config, plan=hall, map_file=MapFile(resolution=0.1, origin=(-9.0, -9.0), states=states)
        )
    result = write_localization(run, tmp_path)
    assert result["updates"] == 0
    assert result["update_ms_p50"] is None
    assert result["localized_at_s"] is None
    assert "no scan saw anything" in summary(result)
