import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mapping.slam.particle_resampling import (
    effective_number,
    low_variance_sample,
    normalised_weights,
)

WEIGHTS = st.lists(st.floats(0.0, 1.0), min_size=1, max_size=40).filter(lambda w: sum(w) > 1e-3)
OFFSETS = 200
OFFSET = st.floats(0.0, 1.0, exclude_max=True)


@given(WEIGHTS, OFFSET)
def test_a_particle_gets_its_share_of_offspring_rounded_up_or_down(
    weights: list[float], offset: float
) -> None:
    shares = np.array(weights) / np.sum(weights)
    survivors = low_variance_sample(shares, offset)
    counts = np.bincount(survivors, minlength=len(shares))
    assert len(survivors) == len(shares)
    assert np.all(np.abs(counts - len(shares) * shares) < 1.0 + 1e-9)
    assert np.all(counts[shares == 0.0] == 0)
    assert np.all(np.diff(survivors) >= 0)


@given(WEIGHTS, st.integers(0, 10_000))
def test_resampling_keeps_the_mean(weights: list[float], seed: int) -> None:
    shares = np.array(weights) / np.sum(weights)
    values = np.random.default_rng(seed).uniform(-1.0, 1.0, len(shares))
    offsets = (np.arange(OFFSETS) + 0.5) / OFFSETS  # every offset alike, so no chance is left
    means = [values[low_variance_sample(shares, offset)].mean() for offset in offsets]
    # offspring change at n places, each off by at most half a step of the offset
    assert np.mean(means) == pytest.approx(shares @ values, abs=2.0 / OFFSETS)


def test_one_particle_with_all_the_weight_is_the_parent_of_all() -> None:
    assert low_variance_sample([0.0, 0.0, 1.0, 0.0], 0.999999).tolist() == [2, 2, 2, 2]


def test_the_effective_number_is_the_number_of_those_that_share_the_weight() -> None:
    assert effective_number(np.full(30, 1.0 / 30.0)) == pytest.approx(30.0)
    assert effective_number([0.0, 1.0, 0.0]) == pytest.approx(1.0)
    assert effective_number([0.5, 0.5, 0.0, 0.0]) == pytest.approx(2.0)


def test_weights_are_shares_however_unlikely_everything_was() -> None:
    weights = normalised_weights([-1e6, -1e6 - np.log(3.0), -1e7])
    assert weights == pytest.approx([0.75, 0.25, 0.0])
