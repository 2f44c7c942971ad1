import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

from mapping.slam.fuse_kernel import LEAST_SCATTER, fuse, scan_information

Array = NDArray[np.float64]
SEEDS = st.integers(0, 10_000)
SHARPEST = np.diag([4e-6, 4e-6, 1e-6])
NOTHING, SURPRISING = 1.0, 11.3


def positive(rng: np.random.Generator, sizes: Array) -> Array:
    root = np.diag(sizes) @ (np.eye(3) + 0.5 * rng.uniform(-1.0, 1.0, (3, 3)))
    return np.asarray(root @ root.T)


@given(seed=SEEDS)
def test_a_scans_information_is_that_of_the_sandwich_covariance(seed: int) -> None:
    rng = np.random.default_rng(seed)
    curvature, scatter = positive(rng, np.full(3, 200.0)), positive(rng, np.full(3, 80.0))
    bread = np.linalg.inv(curvature)
    meat = scatter + LEAST_SCATTER * curvature
    expected = np.linalg.inv(bread @ meat @ bread + SHARPEST)
    found = scan_information(curvature, scatter, SHARPEST)
    # the ridge is 1e-9 of the scatter, whose elements differ by up to a hundred
    assert found == pytest.approx(expected, rel=1e-4, abs=1e-4 * np.abs(expected).max())


@given(seed=SEEDS, dropped=st.floats(-3.0, 3.0))
def test_a_direction_without_curvature_has_no_information(seed: int, dropped: float) -> None:
    rng = np.random.default_rng(seed)
    flat = np.array([np.cos(dropped), np.sin(dropped), 0.0])
    keep = np.eye(3) - np.outer(flat, flat)
    curvature = keep @ positive(rng, np.full(3, 200.0)) @ keep
    found = scan_information(curvature, positive(rng, np.full(3, 80.0)), SHARPEST)
    assert flat @ found @ flat < 1e-6 * np.trace(found)
    assert np.linalg.eigvalsh(found)[1] > 0.0


def test_a_scan_without_curvature_has_no_information_and_no_nan() -> None:
    scatter = positive(np.random.default_rng(0), np.full(3, 80.0))
    assert scan_information(np.zeros((3, 3)), scatter, SHARPEST) == pytest.approx(0.0, abs=1e-9)


@given(seed=SEEDS)
def test_a_scan_that_agrees_is_fused_as_by_a_kalman_filter(seed: int) -> None:
    rng = np.random.default_rng(seed)
    predicted, told = rng.normal(size=3), positive(rng, np.full(3, 100.0))
    covariance = positive(rng, np.full(3, 0.05))
    offset = rng.normal(size=3) * 0.01
    pose, fused, seen, surprise = fuse(predicted, covariance, offset, told, NOTHING, SURPRISING)
    gain = covariance @ np.linalg.inv(covariance + np.linalg.inv(told))
    assert pose == pytest.approx(predicted + gain @ offset, abs=1e-6)
    assert fused == pytest.approx((np.eye(3) - gain) @ covariance, abs=1e-8)
    assert seen == pytest.approx(np.linalg.inv(told + NOTHING * np.eye(3)), abs=1e-9)
    assert 0.0 <= surprise <= 1.0


@given(seed=SEEDS)
def test_a_prediction_that_is_contradicted_yields_to_the_scan(seed: int) -> None:
    rng = np.random.default_rng(seed)
    predicted, told = np.zeros(3), positive(rng, np.full(3, 100.0))
    covariance = positive(rng, np.full(3, 1e-3))
    offset = rng.choice([-1.0, 1.0], 3) * 0.3
    pose, fused, seen, told_surprise = fuse(
        predicted, covariance, offset, told, NOTHING, SURPRISING
    )
    surprise = offset @ np.linalg.solve(covariance + seen, offset)
    assert surprise > SURPRISING  # else nothing is shown
    assert told_surprise == pytest.approx(surprise / SURPRISING)
    wide = np.linalg.inv(covariance * surprise / SURPRISING)
    assert pose == pytest.approx(np.linalg.solve(told + wide, told @ offset), abs=1e-6)
    assert np.linalg.norm(pose - offset) < np.linalg.norm(
        np.linalg.solve(told + np.linalg.inv(covariance), told @ offset) - offset
    )
    assert np.all(np.linalg.eigvalsh(fused) > 0.0)


def test_a_scan_that_tells_nothing_leaves_the_prediction() -> None:
    covariance = np.diag([0.01, 0.02, 0.03])
    predicted = np.array([1.0, 2.0, 3.0])
    pose, fused, *_ = fuse(
        predicted, covariance, np.full(3, 0.01), np.zeros((3, 3)), NOTHING, SURPRISING
    )
    assert pose == pytest.approx(predicted)
    assert fused == pytest.approx(covariance)
