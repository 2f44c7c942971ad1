import numpy as np
import pytest

from mapping.errors import TestbedError
from mapping.messages import LaserScan
from mapping.sensor_model import (
    LDS_01,
    LOG_ODDS_FREE,
    LOG_ODDS_OCCUPIED,
    NO_RETURN_CLEARS,
    SICK_LMS,
    RangeNoise,
    log_odds,
    noise_of_reach,
    range_sigma,
    read_beams,
)


def test_the_log_odds_are_the_thesis_figures() -> None:
    assert pytest.approx(4.7015, abs=5e-5) == LOG_ODDS_OCCUPIED
    assert pytest.approx(5.1100, abs=5e-5) == LOG_ODDS_FREE
    assert log_odds(0.5) == 0.0


def test_the_noise_is_a_third_of_the_datasheets_precision() -> None:
    assert range_sigma([0.2, 1.0, 3.0]) == pytest.approx([0.01 / 3, 0.035 / 3, 0.105 / 3])


def test_a_sick_scatters_by_5_mm_up_to_8_m_and_by_a_share_of_the_range_beyond() -> None:
    expected = [0.005, 0.005, 0.002 * 8 / 3, 0.04 / 3]
    assert range_sigma([0.2, 7.9, 8.0, 20.0], SICK_LMS) == pytest.approx(expected)


@pytest.mark.parametrize(("reach", "noise"), [(3.5, LDS_01), (4.0, LDS_01), (8.0, SICK_LMS)])
def test_the_noise_goes_by_how_far_the_lidar_reaches(reach: float, noise: RangeNoise) -> None:
    assert noise_of_reach(reach) is noise


@pytest.mark.parametrize("field", ["near_range", "near_precision", "far_precision"])
@pytest.mark.parametrize("value", [0.0, -1.0, np.nan, np.inf])
def test_figures_that_make_no_noise_are_told(field: str, value: float) -> None:
    figures = {"near_range": 1.0, "near_precision": 0.01, "far_precision": 0.01}
    with pytest.raises(TestbedError, match=field):
        RangeNoise(**(figures | {field: value}))


def test_each_kind_of_reading_is_told_from_the_others() -> None:
    ranges = [1.0, np.inf, 0.0, np.nan, -np.inf, -1.0, 0.05, 3.6, 3.5]
    scan = LaserScan(stamp=0.0, ranges=np.array(ranges, dtype=np.float32))
    beams = read_beams(scan, 3.5)
    assert beams.indices.tolist() == [0, 1, 7, 8]
    assert beams.lengths.tolist() == [1.0, 3.5, 3.5, 3.5]
    assert beams.hits.tolist() == [True, False, False, True]


def test_a_scan_without_beams_has_none() -> None:
    assert read_beams(LaserScan(stamp=0.0, ranges=np.empty(0, np.float32)), 3.5).indices.size == 0


@pytest.mark.parametrize(
    ("max_range", "range_max", "free"),
    [
        (80.0, 81.83, NO_RETURN_CLEARS),
        (3.0, 81.83, 3.0),
        (80.0, 2.5, 2.5),
        (80.0, np.nan, NO_RETURN_CLEARS),
        (80.0, 0.0, NO_RETURN_CLEARS),
        (2.0, 3.5, 2.0),
    ],
)
def test_no_return_clears_as_far_as_sensor_trust_and_physics_allow(
    max_range: float, range_max: float, free: float
) -> None:
    ranges = np.array([np.inf, 1.0], dtype=np.float32)
    beams = read_beams(LaserScan(stamp=0.0, ranges=ranges, range_max=range_max), max_range)
    assert beams.lengths.tolist() == [free, 1.0]
    assert beams.hits.tolist() == [False, True]


def test_a_reading_beyond_what_is_trusted_clears_up_to_there() -> None:
    ranges = np.array([40.0, 60.0], dtype=np.float32)
    beams = read_beams(LaserScan(stamp=0.0, ranges=ranges, range_max=81.0), 50.0)
    assert beams.lengths.tolist() == [40.0, 50.0]
    assert beams.hits.tolist() == [True, False]
