"""Codes for "nothing seen" among readings whose maximum no one tells."""

from pathlib import Path

import numpy as np
import pytest

from mapping.io.laser_codes import smallest_code
from tests.mapping.io.test_carmen_reader import flaser, read


@pytest.mark.parametrize(
    ("readings", "code"),
    [
        ([1.0, 8.17, 8.183, 8.191], 8.178),
        ([1.0, 8.18], 8.178),
        ([1.0, 8.19], 8.178),
        ([1.0, 16.38], 16.370),
        ([1.0, 32.767], 32.754),
        ([1.0, 8.17], np.inf),
        ([1.0, 8.20], np.inf),
        ([1.0, 8.19, 8.5], np.inf),
        ([1.0, 8.19, np.inf, np.nan], 8.178),
        ([np.inf, np.nan], np.inf),
        ([], np.inf),
    ],
)
def test_the_largest_numbers_of_a_sicks_modes_are_codes(readings: list[float], code: float) -> None:
    assert smallest_code([np.array([0.5]), np.float32(readings)]) == pytest.approx(code)


def test_a_log_without_readings_has_no_codes() -> None:
    assert smallest_code([]) == np.inf
    assert smallest_code([np.zeros(180, dtype=np.float32)] * 30) == np.inf


@pytest.mark.parametrize(("scans", "code"), [(20, 20.0), (19, np.inf)])
def test_a_largest_reading_that_comes_again_and_again_is_a_code(scans: int, code: float) -> None:
    readings = np.random.default_rng(0).uniform(0.5, 19.0, (100, 50)).astype(np.float32)
    readings[:scans, :5] = 20.0
    assert smallest_code(list(readings)) == code


def test_a_farthest_wall_is_no_code_however_many_beams_meet_it() -> None:
    rng = np.random.default_rng(0)
    readings = np.round(6.0 + rng.normal(0.0, 0.005, (100, 180)), 3).astype(np.float32)
    assert smallest_code(list(readings)) == np.inf


def test_codes_of_a_sick_that_sees_8_m_mean_that_nothing_was_there(tmp_path: Path) -> None:
    log = read(tmp_path, flaser([1.0, np.nan, 8.17]), flaser([1.0, 8.18, 8.19]))
    assert [scan.range_max for scan in log.scans] == pytest.approx([8.178, 8.178])
    np.testing.assert_allclose(log.scans[0].ranges, [1.0, np.nan, 8.17], rtol=1e-6)
    np.testing.assert_allclose(log.scans[1].ranges, [1.0, np.inf, np.inf], rtol=1e-6)


def test_a_maximum_that_the_log_tells_is_believed(tmp_path: Path) -> None:
    log = read(tmp_path, "PARAM robot_front_laser_max 50.0", flaser([1.0, 8.19]))
    assert log.scans[0].ranges.tolist() == pytest.approx([1.0, 8.19])
