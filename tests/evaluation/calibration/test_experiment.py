"""The two sensor experiments of appendix A: the readings, how they are counted, the files."""

import csv
import json
import math
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from evaluation.calibration.experiment import CalibrationConfig, Readings, hallway, take_readings
from evaluation.calibration.fit import fit_sensor_model, log_odds_of, proportion
from evaluation.calibration.folder import write_calibration
from mapping.burger import LIDAR_RANGE_MAX
from mapping.errors import TestbedError

FEW = CalibrationConfig(scans=40)


def thesis_readings() -> Readings:
    """As appendix A counts: 991 of three values, 9 wrong or failed; 994 times inf, 6 failures."""
    wall = [0.5] * 700 + [0.501] * 281 + [0.502] * 10 + [0.0] * 6 + [0.497, 0.511, 0.493]
    return Readings(wall=np.array(wall), open=np.array([math.inf] * 994 + [0.0] * 6))


def test_the_thesiss_readings_give_the_thesiss_figures() -> None:
    fit = fit_sensor_model(thesis_readings())
    assert fit.p_m1_given_z1.value == 0.991
    assert fit.p_m0_given_z0.value == 0.994
    assert fit.lo1.value == pytest.approx(4.7015, abs=5e-5)
    assert fit.lo0.value == pytest.approx(5.1100, abs=5e-5)
    assert sum(row.count for row in fit.rows("wall")) == 1000


def test_a_failure_is_never_a_right_distance_however_frequent() -> None:
    wall = np.array([0.0] * 6 + [math.inf] * 5 + [0.5, 0.5, 0.5])
    fit = fit_sensor_model(Readings(wall=wall, open=np.array([0.0, 3.4, math.inf])))
    assert fit.p_m1_given_z1.value == pytest.approx(3 / 14)
    assert fit.p_m0_given_z0.value == pytest.approx(1 / 3)
    kinds = {(row.experiment, row.reading): row.counts_as for row in fit.table}
    assert kinds[("wall", 0.0)] == "failed"
    assert kinds[("wall", math.inf)] == "wrong"
    assert kinds[("open", 3.4)] == "wrong"
    assert fit.mean_m == 0.5


@pytest.mark.parametrize(("right", "total"), [(991, 1000), (0, 7), (7, 7), (1, 3)])
def test_an_interval_is_wilsons(right: int, total: int) -> None:
    z, p = 1.959963984540054, right / total  # two-sided 95 % of the normal distribution
    middle = (p + z * z / (2 * total)) / (1 + z * z / total)
    half = z / (1 + z * z / total) * math.sqrt(p * (1 - p) / total + z * z / (4 * total**2))
    estimate = proportion(right, total)
    assert estimate.value == p
    assert estimate.low == pytest.approx(middle - half, abs=1e-12)
    assert estimate.high == pytest.approx(middle + half, abs=1e-12)


def test_log_odds_that_are_infinite_are_none() -> None:
    sure = log_odds_of(proportion(5, 5))
    assert sure.value is None
    assert sure.high is None
    assert sure.low is not None
    never = log_odds_of(proportion(0, 5))
    assert never.value is None
    assert never.low is None


def test_the_robot_stands_half_a_metre_from_the_wall_and_then_before_nothing() -> None:
    readings = take_readings(CalibrationConfig(lidar="ideal", scans=3))
    np.testing.assert_allclose(readings.wall, 0.5, atol=1e-4)  # it settles on its tyres
    assert np.all(np.isinf(readings.open))
    left, *_ = hallway().bounds
    assert -left > 3.0 * LIDAR_RANGE_MAX


def test_a_thousand_scans_of_the_measured_lidar_repeat_appendix_a() -> None:
    fit = fit_sensor_model(take_readings(CalibrationConfig(seed=3)))
    assert fit.p_m1_given_z1.value == pytest.approx(0.991, abs=0.006)  # two sigma of 1000 draws
    assert fit.p_m0_given_z0.value == pytest.approx(0.994, abs=0.005)
    low, high = fit.lo1.low, fit.lo1.high
    assert low is not None
    assert high is not None
    assert low < 4.7015 < high


def test_every_scan_is_a_new_one_and_told() -> None:
    told: list[int] = []
    readings = take_readings(FEW, lambda: told.append(1))
    assert len(told) == 2 * FEW.scans
    assert readings.wall.shape == readings.open.shape == (FEW.scans,)
    noisy = take_readings(CalibrationConfig(lidar="datasheet", scans=40)).wall
    assert len(set(noisy)) > 8, "a sigma of 4 mm in steps of 1 mm"


def test_the_same_seed_writes_the_same_bytes_and_another_seed_others(tmp_path: Path) -> None:
    for name, seed in (("a", 1), ("b", 1), ("c", 2)):
        config = CalibrationConfig(lidar="datasheet", scans=40, seed=seed)
        write_calibration(fit_sensor_model(take_readings(config)), config, tmp_path / name)
    for file in ("readings.csv", "histogram.png", "calibration.json"):
        first = (tmp_path / "a" / file).read_bytes()
        assert first == (tmp_path / "b" / file).read_bytes()
        assert first != (tmp_path / "c" / file).read_bytes()


def test_the_files_say_what_was_measured(tmp_path: Path) -> None:
    write_calibration(fit_sensor_model(thesis_readings()), CalibrationConfig(), tmp_path)
    with (tmp_path / "readings.csv").open() as file:
        rows = {(row["experiment"], float(row["reading_m"])): row for row in csv.DictReader(file)}
    assert rows[("wall", 0.501)]["count"] == "281"
    assert rows[("wall", 0.0)]["counts_as"] == "failed"
    assert rows[("open", math.inf)]["counts_as"] == "right"
    figures = json.loads((tmp_path / "calibration.json").read_text())
    assert figures["p_m1_given_z1"]["value"] == 0.991
    assert figures["right_values_m"] == [0.5, 0.501, 0.502]
    assert figures["lidar_settings"]["dropout"] == 0.006
    assert figures["settings"]["scans"] == 1000
    with Image.open(tmp_path / "histogram.png") as picture:
        colours = {colour for _, colour in picture.convert("RGB").getcolors(10**6) or []}
    assert {(0x00, 0x72, 0xB2), (0xE6, 0x9F, 0x00), (0xD5, 0x5E, 0x00)} <= colours


@pytest.mark.parametrize(
    ("wrong", "field"), [({"seed": -1}, "seed"), ({"scans": 0}, "scans"), ({"lidar": "x"}, "lidar")]
)
def test_what_makes_no_experiment_is_refused(wrong: dict[str, object], field: str) -> None:
    with pytest.raises(TestbedError, match=rf"{field}: .*must be"):
        CalibrationConfig(**wrong)  # type: ignore[arg-type]
