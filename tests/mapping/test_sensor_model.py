import numpy as np
import pytest

from mapping.messages import LaserScan
from mapping.sensor_model import (
    LOG_ODDS_FREE,
    LOG_ODDS_OCCUPIED,
    log_odds,
    range_sigma,
    read_beams,
)


def test_the_log_odds_are_the_thesis_figures() -> None:
    assert pytest.approx(4.7015, abs=5e-5) == LOG_ODDS_OCCUPIED
    assert pytest.approx(5.1100, abs=5e-5) == LOG_ODDS_FREE
    assert log_odds(0.5) == 0.0


def test_the_noise_is_a_third_of_the_datasheets_precision() -> None:
    assert range_sigma([0.2, 1.0, 3.0]) == pytest.approx([0.01 / 3, 0.035 / 3, 0.105 / 3])


def test_each_kind_of_reading_is_told_from_the_others() -> None:
    ranges = [1.0, np.inf, 0.0, np.nan, -np.inf, -1.0, 0.05, 3.6, 3.5]
    scan = LaserScan(stamp=0.0, ranges=np.array(ranges, dtype=np.float32))
    beams = read_beams(scan, 3.5)
    assert beams.indices.tolist() == [0, 1, 7, 8]
    assert beams.lengths.tolist() == [1.0, 3.5, 3.5, 3.5]
    assert beams.hits.tolist() == [True, False, False, True]


def test_a_scan_without_beams_has_none() -> None:
    assert read_beams(LaserScan(stamp=0.0, ranges=np.empty(0, np.float32)), 3.5).indices.size == 0
