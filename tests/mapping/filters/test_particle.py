"""The particle filter: its number, its recovery, and its agreement with Kalman."""

import math

import numpy as np
import pytest

from mapping.errors import TestbedError
from mapping.filters import kalman
from mapping.filters.gaussian import gaussian
from mapping.filters.particle import ParticleConfig, ParticleFilter, count_bins
from mapping.filters.resampling import kld_sample_size

Array = np.ndarray


def walk(way: float, sigma: float):
    def sample(states: Array, rng: np.random.Generator) -> Array:
        return states + way + sigma * rng.standard_normal(states.shape)

    return sample


def gaussian_logs(states: Array, measurement: float, sigma: float) -> Array:
    return -0.5 * ((states[:, 0] - measurement) / sigma) ** 2 - math.log(
        sigma * math.sqrt(2.0 * math.pi)
    )


@pytest.mark.parametrize("resampling", ["low_variance", "importance"])
def test_many_particles_are_the_kalman_filter(resampling: str) -> None:
    rng = np.random.default_rng(2)
    config = ParticleConfig(resampling=resampling)  # type: ignore[arg-type]
    particles = ParticleFilter(config, rng.normal(0.0, 2.0, (20_000, 1)), rng)
    belief = gaussian([0.0], [[4.0]])
    for measurement in (1.2, 1.9, 3.3, 3.8):
        particles.predict(walk(1.0, 0.5))
        particles.correct(gaussian_logs(particles.states, measurement, 0.7))
        belief = kalman.predict(belief, [[1.0]], [[0.25]], [[1.0]], [1.0])
        belief = kalman.correct(belief, [[1.0]], [measurement], [[0.49]])
        mean = particles.weights @ particles.states[:, 0]
        variance = particles.weights @ (particles.states[:, 0] - mean) ** 2
        # 20000 particles of deviation 0.5: the mean errs by 0.004, here up to five times that
        assert mean == pytest.approx(belief.mean[0], abs=0.02)
        assert variance == pytest.approx(belief.covariance[0, 0], rel=0.06)
        assert particles.resample()


def test_the_number_shrinks_as_the_belief_does() -> None:
    rng = np.random.default_rng(3)
    config = ParticleConfig(bins=(0.1,), least=50, most=5000)
    particles = ParticleFilter(config, rng.uniform(0.0, 100.0, (5000, 1)), rng)
    numbers = []
    for _ in range(6):
        particles.predict(walk(0.0, 0.02))
        particles.correct(gaussian_logs(particles.states, 42.0, 0.3))
        particles.resample()
        numbers.append(len(particles))
    assert numbers[-1] < 400 < 5000
    bins = count_bins(particles.states, (0.1,))
    assert numbers[-1] <= kld_sample_size(bins + 4, config.error, config.confidence)
    assert particles.states.mean() == pytest.approx(42.0, abs=0.1)


def test_random_particles_recover_a_kidnapped_state_and_without_them_it_stays_lost() -> None:
    def drawn_anywhere(count: int, rng: np.random.Generator) -> Array:
        return rng.uniform(0.0, 100.0, (count, 1))

    ends = {}
    for slow_rate in (0.0, 0.02):
        rng = np.random.default_rng(4)
        config = ParticleConfig(slow_rate=slow_rate, fast_rate=0.2)
        particles = ParticleFilter(config, rng.uniform(0.0, 100.0, (1000, 1)), rng)
        shares = []
        for k in range(120):
            true = 20.0 if k < 60 else 80.0
            particles.predict(walk(0.0, 0.1))
            share = particles.random_share
            particles.admit(drawn_anywhere(round(1000 * share), rng), share)
            # a floor, as every real sensor model has one
            likelihood = 1e-6 + np.exp(gaussian_logs(particles.states, true, 0.5))
            particles.correct(np.log(likelihood))
            particles.resample()
            shares.append(particles.random_share)
        ends[slow_rate] = np.median(particles.states)
        if slow_rate > 0.0:
            assert max(shares[20:60]) < 0.05, "no stranger while all goes well"
            assert max(shares[60:]) > 0.3
    assert ends[0.02] == pytest.approx(80.0, abs=0.5)
    assert ends[0.0] == pytest.approx(20.0, abs=10.0), "on its own it walks only"


def test_strangers_have_the_share_of_the_belief_that_they_are_given() -> None:
    """More of them change nothing but the noise: the posterior is that of a carried-off state."""
    ends = []
    for count in (200, 20_000):
        rng = np.random.default_rng(6)
        particles = ParticleFilter(ParticleConfig(), np.full((100, 1), 20.0), rng)
        particles.admit(np.linspace(0.0, 100.0, count)[:, None], 0.1)
        assert particles.weights.sum() == pytest.approx(1.0)
        logs = np.where(np.abs(particles.states[:, 0] - 80.0) < 10.0, 0.0, -2.0)
        expected = particles.correct(logs)
        ends.append(particles.weights[100:].sum())
    here, there = 0.9 * math.exp(-2.0), 0.1 * (0.2 + 0.8 * math.exp(-2.0))
    assert ends == pytest.approx([there / (here + there)] * 2, rel=0.02)
    assert math.exp(expected) == pytest.approx(here + there, rel=0.02)


def test_an_impossible_measurement_leaves_the_weights() -> None:
    particles = ParticleFilter(ParticleConfig(), np.zeros((4, 1)), np.random.default_rng(0))
    particles.correct(np.full(4, -np.inf))
    assert particles.weights == pytest.approx(np.full(4, 0.25))


def test_the_same_seed_draws_the_same_particles() -> None:
    ends = []
    for _ in range(2):
        rng = np.random.default_rng(9)
        particles = ParticleFilter(ParticleConfig(), rng.standard_normal((50, 2)), rng)
        particles.predict(walk(0.1, 0.1))
        particles.correct(gaussian_logs(particles.states, 0.5, 0.4))
        particles.resample()
        ends.append(particles.states.tobytes())
    assert ends[0] == ends[1]


def test_what_makes_no_filter_is_refused() -> None:
    with pytest.raises(TestbedError, match="least, most"):
        ParticleConfig(least=10, most=5)
    with pytest.raises(TestbedError, match="slow_rate"):
        ParticleConfig(slow_rate=0.5, fast_rate=0.1)
    with pytest.raises(TestbedError, match="bins"):
        ParticleConfig(bins=(0.0,))


@pytest.mark.parametrize("wrong", [np.nan, np.inf])
def test_a_likelihood_that_is_none_is_refused_and_harms_nothing(wrong: float) -> None:
    config = ParticleConfig(slow_rate=0.01, fast_rate=0.1)
    particles = ParticleFilter(config, np.zeros((2, 1)), np.random.default_rng(0))
    particles.correct([-1.0, -2.0])
    weights, usual = particles.weights.copy(), particles.usual_evidence
    with pytest.raises(TestbedError, match="log_likelihoods"):
        particles.correct([-1.0, wrong])
    with pytest.raises(TestbedError, match="evidence"):
        particles.correct([-1.0, -1.0], evidence=wrong)
    assert np.array_equal(particles.weights, weights)
    assert particles.usual_evidence == usual
    assert np.isfinite(particles.random_share)
