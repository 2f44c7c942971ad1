import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mapping.slam.matrix_kernels import inverse3, product3, quadratic3, times3

SEEDS = st.integers(0, 10_000)


@given(seed=SEEDS, size=st.sampled_from([1e-6, 1.0, 1e6]))
def test_small_matrices_are_inverted_and_multiplied_as_numpy_does(seed: int, size: float) -> None:
    rng = np.random.default_rng(seed)
    a, b, v = rng.normal(size=(3, 3)) * size, rng.normal(size=(3, 3)), rng.normal(size=3)
    assert product3(a, b) == pytest.approx(a @ b, rel=1e-12)
    assert times3(a, v) == pytest.approx(a @ v, rel=1e-12)
    assert quadratic3(v, a) == pytest.approx(v @ a @ v, rel=1e-9, abs=1e-12 * size)
    # rounding grows with the condition number; both ways have it
    known = np.linalg.inv(a)
    error = np.abs(inverse3(a) - known).max() / np.abs(known).max()
    assert error < 1e-14 * np.linalg.cond(a) * 10.0


def test_the_covariances_of_poses_are_inverted_though_their_units_differ() -> None:
    sigmas = np.array([1e-4, 10.0, 1e-5])
    root = np.array([[1.0, 0.3, 0.2], [0.0, 1.0, -0.4], [0.0, 0.0, 1.0]])
    covariance = root @ root.T * np.outer(sigmas, sigmas)
    assert inverse3(covariance) @ covariance == pytest.approx(np.eye(3), abs=1e-6)
