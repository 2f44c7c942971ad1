"""The linear filters: Kalman, information and both extended ones are one and the same there."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mapping.errors import TestbedError
from mapping.filters import extended_information, extended_kalman, information, kalman
from mapping.filters.gaussian import Gaussian, gaussian, to_gaussian, to_information
from tests.mapping.filters.systems import Array, LinearSystem, random_system

seeds = st.integers(0, 2**32 - 1)


def kalman_track(system: LinearSystem) -> list[Gaussian]:
    belief, track = system.start, []
    for control, measurement in zip(system.controls, system.measurements, strict=True):
        belief = kalman.predict(belief, system.a, system.motion_noise, system.b, control)
        belief = kalman.correct(belief, system.c, measurement, system.sensor_noise)
        track.append(belief)
    return track


def assert_same(found: Gaussian, expected: Gaussian, tolerance: float = 1e-9) -> None:
    assert found.mean == pytest.approx(expected.mean, abs=tolerance, rel=tolerance)
    assert found.covariance == pytest.approx(expected.covariance, abs=tolerance, rel=tolerance)


@given(seeds)
def test_the_information_filter_is_the_kalman_filter(seed: int) -> None:
    system = random_system(seed)
    belief = to_information(system.start)
    for k, expected in enumerate(kalman_track(system)):
        belief = information.predict(
            belief, system.a, system.motion_noise, system.b, system.controls[k]
        )
        belief = information.correct(belief, system.c, system.measurements[k], system.sensor_noise)
        assert_same(to_gaussian(belief), expected)


@given(seeds)
def test_the_extended_filters_on_a_linear_system_are_the_kalman_filter(seed: int) -> None:
    system = random_system(seed)
    belief, dual = system.start, to_information(system.start)
    for k, expected in enumerate(kalman_track(system)):

        def motion(state: Array, k: int = k) -> tuple[Array, Array]:
            return system.a @ state + system.b @ system.controls[k], system.a

        def sensor(state: Array) -> tuple[Array, Array]:
            return system.c @ state, system.c

        z, noise = system.measurements[k], system.sensor_noise
        belief = extended_kalman.predict(belief, motion, system.motion_noise)
        belief = extended_kalman.correct(belief, sensor, z, noise)
        dual = extended_information.predict(dual, motion, system.motion_noise)
        dual = extended_information.correct(dual, sensor, z, noise)
        assert_same(belief, expected)
        assert_same(to_gaussian(dual), expected)


def test_the_posterior_is_the_conditional_of_the_joint_gaussian() -> None:
    """The oracle: least squares over everything that was measured, all at once."""
    system = random_system(7, steps=4)
    # unknowns x_0..x_4; every prior, motion and measurement is a row block, whitened
    blocks, targets = [], []
    size = len(system.start.mean)

    def whiten(covariance: Array) -> Array:
        return np.asarray(np.linalg.inv(np.linalg.cholesky(covariance)))

    def block(entries: dict[int, Array], target: Array, covariance: Array) -> None:
        row = np.zeros((len(target), 5 * size))
        for place, matrix in entries.items():
            row[:, place * size : (place + 1) * size] = matrix
        blocks.append(whiten(covariance) @ row)
        targets.append(whiten(covariance) @ target)

    block({0: np.eye(size)}, system.start.mean, system.start.covariance)
    for k in range(4):
        pushed = system.b @ system.controls[k]
        block({k + 1: np.eye(size), k: -system.a}, pushed, system.motion_noise)
        block({k + 1: system.c}, system.measurements[k], system.sensor_noise)
    rows, right = np.vstack(blocks), np.concatenate(targets)
    solution = np.linalg.lstsq(rows, right, rcond=None)[0]
    covariance = np.linalg.inv(rows.T @ rows)
    last = kalman_track(system)[-1]
    assert last.mean == pytest.approx(solution[-size:], abs=1e-9)
    assert last.covariance == pytest.approx(covariance[-size:, -size:], abs=1e-9)


def test_one_dimension_by_hand() -> None:
    """N(0, 4), seen at 2 with variance 4: half way, half the variance."""
    found = kalman.correct(gaussian([0.0], [[4.0]]), [[1.0]], [2.0], [[4.0]])
    assert found.mean == pytest.approx([1.0])
    assert found.covariance == pytest.approx(np.array([[2.0]]))


@given(seeds)
def test_a_measurement_never_makes_the_belief_less_sure(seed: int) -> None:
    system = random_system(seed)
    after = kalman.correct(system.start, system.c, system.measurements[0], system.sensor_noise)
    gained = np.linalg.eigvalsh(system.start.covariance - after.covariance)
    assert gained.min() > -1e-9
    assert np.linalg.eigvalsh(after.covariance).min() > 0.0


def test_noise_that_enters_state_and_measurement_is_counted_once() -> None:
    """A step of unknown size that is also what is measured: the oracle has it as a state."""
    shared_variance, other = 0.5, 0.2
    wide = gaussian([0.0, 0.0], np.diag([1.0, shared_variance]))  # x before, and the step
    stepped = kalman.predict(wide, [[1.0, 1.0], [0.0, 1.0]], np.zeros((2, 2)))
    expected = kalman.correct(stepped, [[0.0, 1.0]], [0.3], [[other]])
    prior = gaussian([0.0], [[1.0 + shared_variance]])
    found = kalman.updated(
        prior,
        np.zeros((1, 1)),
        np.array([0.3]),
        np.array([[shared_variance + other]]),
        np.array([[shared_variance]]),
    )
    assert found.mean == pytest.approx(expected.mean[:1])
    assert found.covariance == pytest.approx(expected.covariance[:1, :1])


def test_what_makes_no_gaussian_is_refused() -> None:
    with pytest.raises(TestbedError, match="shape"):
        gaussian([0.0, 0.0], np.eye(3))
    with pytest.raises(TestbedError, match="finite"):
        gaussian([np.nan], [[1.0]])
    with pytest.raises(TestbedError, match="singular"):
        to_information(gaussian([0.0], [[0.0]]))
