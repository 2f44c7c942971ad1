"""Drawing by weight: shares of offspring, the effective number, the number that KLD asks for."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.stats import chi2

from mapping.errors import TestbedError
from mapping.filters.resampling import (
    effective_number,
    importance_sample,
    kld_sample_size,
    low_variance_sample,
    normalised,
)

OFFSETS = 200

weight_lists = st.lists(st.floats(0.0, 1.0), min_size=1, max_size=30).filter(lambda w: sum(w) > 0)


@given(weight_lists, st.integers(1, 60), st.floats(0.0, 1.0, exclude_max=True))
def test_low_variance_gives_every_particle_its_share_rounded_up_or_down(
    listed: list[float], count: int, offset: float
) -> None:
    weights = np.array(listed) / np.sum(listed)
    survivors = low_variance_sample(weights, count, offset)
    offspring = np.bincount(survivors, minlength=len(weights))
    assert np.all(np.diff(survivors) >= 0)
    assert offspring.sum() == count
    assert np.all(offspring >= np.floor(count * weights - 1e-9))
    assert np.all(offspring <= np.ceil(count * weights + 1e-9))
    assert np.all(offspring[weights == 0.0] == 0)


@given(weight_lists, st.floats(0.0, 1.0, exclude_max=True))
def test_low_variance_never_loses_a_particle_heavier_than_the_mean(
    listed: list[float], offset: float
) -> None:
    weights = np.array(listed) / np.sum(listed)
    survivors = low_variance_sample(weights, len(weights), offset)
    heavy = np.flatnonzero(weights > (1.0 + 1e-9) / len(weights))
    assert set(heavy) <= set(survivors)


@pytest.mark.parametrize("kind", ["low_variance", "importance"])
def test_the_expected_number_of_offspring_is_the_weight(kind: str) -> None:
    rng = np.random.default_rng(0)
    weights = normalised(rng.standard_normal(8))
    rounds, count = 4000, 8
    total = np.zeros(8)
    for _ in range(rounds):
        if kind == "low_variance":
            drawn = low_variance_sample(weights, count, rng.random())
        else:
            drawn = importance_sample(weights, count, rng)
        total += np.bincount(drawn, minlength=8)
    # the standard error of importance sampling, the larger of the two; four of them
    error = 4.0 * np.sqrt(count * weights * (1.0 - weights) / rounds)
    assert np.all(np.abs(total / rounds - count * weights) < error)


@given(weight_lists, st.integers(0, 10_000))
def test_low_variance_keeps_the_mean(listed: list[float], seed: int) -> None:
    weights = np.array(listed) / np.sum(listed)
    values = np.random.default_rng(seed).uniform(-1.0, 1.0, len(weights))
    offsets = (np.arange(OFFSETS) + 0.5) / OFFSETS  # every offset alike, so no chance is left
    means = [values[low_variance_sample(weights, len(weights), each)].mean() for each in offsets]
    # offspring change at n places, each off by at most half a step of the offset
    assert np.mean(means) == pytest.approx(weights @ values, abs=2.0 / OFFSETS)


def test_one_particle_with_all_the_weight_is_the_parent_of_all() -> None:
    assert low_variance_sample([0.0, 0.0, 1.0, 0.0], 4, 0.999999).tolist() == [2, 2, 2, 2]


def test_weights_are_shares_however_unlikely_everything_was() -> None:
    weights = normalised([-1e6, -1e6 - np.log(3.0), -1e7])
    assert weights == pytest.approx([0.75, 0.25, 0.0])


def test_weights_that_are_all_impossible_are_refused() -> None:
    with pytest.raises(TestbedError, match="weight"):
        normalised([-np.inf, -np.inf])


def test_effective_number_of_known_weights() -> None:
    assert effective_number(np.full(10, 0.1)) == pytest.approx(10.0)
    assert effective_number([1.0, 0.0, 0.0]) == pytest.approx(1.0)
    assert effective_number([2.0, 2.0, 0.0]) == pytest.approx(2.0)


@given(st.integers(2, 3000), st.floats(0.01, 0.5), st.sampled_from([0.9, 0.95, 0.99]))
def test_the_kld_number_is_the_chi_square_quantile_over_twice_the_error(
    bins: int, error: float, confidence: float
) -> None:
    exact = chi2.ppf(confidence, bins - 1) / (2.0 * error)
    found = kld_sample_size(bins, error, confidence)
    # Wilson and Hilferty's approximation is within 1 % above one degree of freedom, 2.5 % at one
    tolerance = 0.025 if bins == 2 else 0.01
    assert exact * (1.0 - tolerance) <= found <= exact * (1.0 + tolerance) + 1.0


def test_kld_keeps_its_promise() -> None:
    """So many draws from 50 equal bins are within 0.05 nats of them in 99 of 100 trials."""
    rng = np.random.default_rng(1)
    bins, error = 50, 0.05
    count = kld_sample_size(bins, error, 0.99)
    drawn = rng.multinomial(count, np.full(bins, 1.0 / bins), size=2000) / count
    with np.errstate(divide="ignore", invalid="ignore"):
        terms = np.where(drawn > 0.0, drawn * np.log(drawn * bins), 0.0)
    kept = np.mean(terms.sum(axis=1) <= error)
    assert 0.98 <= kept <= 1.0
