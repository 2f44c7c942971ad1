"""The reported ranges have the statistics that the presets promise."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from envs.lidar_noise import LIDAR_PRESETS, LidarConfig, LidarUnit, draw_unit, report
from mapping.burger import LIDAR_RANGE_MAX, LIDAR_RANGE_MIN
from mapping.errors import TestbedError

N = 100_000
EXACT_UNIT = LidarUnit(scale=0.0, bias_sign=1.0)


def readings(config: LidarConfig, distance: float, unit: LidarUnit = EXACT_UNIT) -> np.ndarray:
    ranges = report(np.full(N, distance), config, unit, np.random.default_rng(1))
    return ranges.astype(np.float64)


@pytest.mark.parametrize(
    ("distance", "sigma"), [(0.3, 0.010 / 3), (1.0, 0.035 / 3), (2.5, 2.5 * 0.035 / 3)]
)
def test_the_datasheets_precision_is_three_sigma(distance: float, sigma: float) -> None:
    ranges = readings(LIDAR_PRESETS["datasheet"], distance)
    assert ranges.std() == pytest.approx(sigma, rel=0.02)  # 100 000 draws: 0.2 % is one sigma
    assert ranges.mean() == pytest.approx(distance, abs=5 * sigma / math.sqrt(N) + 1e-6)


def test_units_of_the_datasheet_differ_in_scale_by_half_a_percent() -> None:
    rng = np.random.default_rng(2)
    scales = [draw_unit(LIDAR_PRESETS["datasheet"], rng).scale for _ in range(4000)]
    assert np.std(scales) == pytest.approx(0.005, rel=0.05)
    assert np.mean(scales) == pytest.approx(0.0, abs=0.0004)


@pytest.mark.parametrize(("distance", "bias"), [(0.3, 0.015), (0.6, 0.030), (3.0, 0.150)])
def test_a_worst_case_unit_is_off_by_the_full_accuracy_figure(distance: float, bias: float) -> None:
    config = LIDAR_PRESETS["worst_case"]
    for sign in (1.0, -1.0):
        ranges = readings(config, distance, LidarUnit(scale=0.0, bias_sign=sign))
        assert ranges.mean() == pytest.approx(distance + sign * bias, abs=5e-4)
    rng = np.random.default_rng(3)
    assert {draw_unit(config, rng).bias_sign for _ in range(50)} == {1.0, -1.0}


def test_the_measured_preset_repeats_appendix_a() -> None:
    config = LIDAR_PRESETS["measured"]
    ranges = readings(config, 0.501)
    good = np.isin(np.round(ranges, 3), (0.500, 0.501, 0.502))
    # 991 of 1000 there; of the 3 wrong ones some fall inside.
    assert good.mean() == pytest.approx(0.991, abs=0.001)
    assert (ranges == 0.0).mean() == pytest.approx(0.006, abs=0.001)
    open_space = readings(config, math.inf)
    assert np.isinf(open_space).mean() == pytest.approx(0.994, abs=0.001)
    assert (open_space == 0.0).mean() == pytest.approx(0.006, abs=0.001)


def test_ideal_ranges_are_the_true_ones() -> None:
    distances = np.random.default_rng(4).uniform(LIDAR_RANGE_MIN, LIDAR_RANGE_MAX, 1000)
    unit = draw_unit(LIDAR_PRESETS["ideal"], np.random.default_rng(5))
    ranges = report(distances, LIDAR_PRESETS["ideal"], unit, np.random.default_rng(6))
    np.testing.assert_array_equal(ranges, distances.astype(np.float32))


def test_ranges_come_in_whole_millimetres() -> None:
    for name in ("datasheet", "worst_case", "measured"):
        thousandths = readings(LIDAR_PRESETS[name], 1.2345) * 1000.0
        np.testing.assert_allclose(thousandths, np.round(thousandths), atol=1e-3)


@settings(deadline=None, max_examples=100)
@given(
    distances=st.lists(st.one_of(st.floats(0.0, 10.0), st.just(math.inf)), min_size=1, max_size=50),
    name=st.sampled_from(sorted(LIDAR_PRESETS)),
    seed=st.integers(0, 2**32 - 1),
)
def test_a_range_is_within_the_devices_limits_or_no_return_or_failed(
    distances: list[float], name: str, seed: int
) -> None:
    rng = np.random.default_rng(seed)
    config = LIDAR_PRESETS[name]
    ranges = report(np.array(distances), config, draw_unit(config, rng), rng)
    assert ranges.dtype == np.float32
    low, high = np.float32(LIDAR_RANGE_MIN), np.float32(LIDAR_RANGE_MAX)
    assert np.all((ranges == 0.0) | np.isinf(ranges) | ((ranges >= low) & (ranges <= high)))
    beyond = np.array(distances) > 2.0 * LIDAR_RANGE_MAX  # farther than any error reaches
    assert not np.isfinite(ranges[beyond & (ranges != 0.0)]).any()


def test_what_is_too_near_reads_zero_and_what_is_too_far_infinite() -> None:
    ideal = LIDAR_PRESETS["ideal"]
    ranges = report(np.array((0.119, 0.12, 3.5, 3.501, math.inf)), ideal, EXACT_UNIT, _rng())
    np.testing.assert_allclose(ranges, (0.0, 0.12, 3.5, math.inf, math.inf), rtol=1e-6)


def test_no_return_can_read_zero_as_the_real_driver_has_it() -> None:
    config = LidarConfig(no_return="zero")
    ranges = report(np.array((1.0, 3.9, math.inf)), config, EXACT_UNIT, _rng())
    assert ranges[0] > 0.9
    assert ranges[1:].tolist() == [0.0, 0.0]


def test_dropouts_are_as_frequent_as_asked() -> None:
    ranges = readings(LidarConfig(dropout=0.1, open_dropout=0.3), 1.0)
    assert (ranges == 0.0).mean() == pytest.approx(0.1, abs=0.005)
    ranges = readings(LidarConfig(dropout=0.1, open_dropout=0.3), math.inf)
    assert (ranges == 0.0).mean() == pytest.approx(0.3, abs=0.005)


def test_of_the_preset_dropouts_a_tenth_of_all_beams_fail() -> None:
    for distance in (1.0, math.inf):
        ranges = readings(LIDAR_PRESETS["dropouts"], distance)
        assert np.mean(ranges == 0.0) == pytest.approx(0.1, abs=0.004)  # 4 sigma of 100 000 draws
    near = readings(LIDAR_PRESETS["dropouts"], 1.0)
    assert near[near > 0.0].std() == pytest.approx(0.035 / 3, rel=0.02)


@pytest.mark.parametrize(
    ("field", "value"),
    [("far_sigma", -0.1), ("near_sigma", math.nan), ("dropout", 1.5), ("no_return", "nan"),
     ("resolution", math.inf), ("near_bias", 9.0)],
)  # fmt: skip
def test_figures_that_make_no_sense_are_refused(field: str, value: object) -> None:
    with pytest.raises(TestbedError, match=rf"lidar {field}: .*must be"):
        LidarConfig(**{field: value})  # type: ignore[arg-type]


def _rng() -> np.random.Generator:
    return np.random.default_rng(7)
