"""What a scan on a hit field tells of its pose: Newton's terms, against splines by the book."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray
from scipy.interpolate import BSpline

from mapping.slam.hit_field_kernels import (
    KNOWN,
    SIDES,
    TAPS,
    newton_terms,
    shares_of,
    smear,
    spline_taps,
)
from tests.mapping.slam.hit_field_reference import SEEDS, Array, directions, slow_terms


@given(offset=st.floats(0.0, 1.0))
def test_spline_taps_are_the_b_spline_and_its_derivatives(offset: float) -> None:
    taps = np.empty((3, TAPS))
    spline_taps(offset, *taps)
    basis = BSpline.basis_element(np.arange(-2.0, 3.0), extrapolate=False)
    # neighbours lie at -1, 0, 1 and 2; the basis is centred on each
    for k, place in enumerate(range(-1, 3)):
        for order in range(2):
            want = np.nan_to_num(basis.derivative(order)(offset - place))
            assert taps[order, k] == pytest.approx(want, abs=1e-12)
    # its second derivative: second differences of the hats on the neighbours
    hat = np.maximum(1.0 - np.abs(offset - np.arange(-1, 3)), 0.0)
    assert taps[2] == pytest.approx(np.convolve(hat, [1.0, -2.0, 1.0])[1:-1], abs=1e-12)


def a_field(rng: np.random.Generator) -> NDArray[np.float32]:
    """A field of two crossing walls and a few bells."""
    density = np.zeros((30, 34, SIDES), dtype=np.float32)
    line = np.linspace(0.0, 25.0, 26)
    walls = np.concatenate(
        [
            np.column_stack((line + 4.0, 8.0 + 0.1 * line)),
            np.column_stack((10.0 + 0.2 * line, line)),
            rng.uniform(3.0, 25.0, (4, 2)),
        ]
    )
    facing = directions(rng, len(walls))
    surface = np.column_stack((walls, rng.uniform(0.2, 1.0, len(walls)), facing))
    smear(density, np.zeros(3), surface.astype(np.float32), 1.0, 0.4)
    return density


def terms(
    density: NDArray[np.float32], pose: Array, scan: tuple[Array, Array, Array], outlier: float
) -> tuple[Array, Array, Array, float, float]:
    gradient, hessian, scatter = np.empty(3), np.empty((3, 3)), np.empty((3, 3))
    told = newton_terms(density, pose, *scan, outlier, gradient, hessian, scatter)
    return gradient, hessian, scatter, *told


def a_scan(rng: np.random.Generator, count: int = 15) -> tuple[Array, Array, Array]:
    points = rng.uniform(-14.0, 14.0, (count, 2))
    return points, directions(rng, count), rng.uniform(0.1, 1.0, count)


@given(seed=SEEDS, outlier=st.floats(0.05, 2.0))
@settings(max_examples=30)
def test_newtons_terms_are_those_of_splines_by_the_book(seed: int, outlier: float) -> None:
    rng = np.random.default_rng(seed)
    density, scan = a_field(rng), a_scan(rng)
    pose = np.array([*rng.uniform(10.0, 20.0, 2), rng.uniform(-4.0, 4.0)])
    found = terms(density, pose, scan, outlier)
    expected = slow_terms(density.astype(float), pose, *scan, outlier)
    for one, other in zip(found, expected, strict=True):
        # sides are shared out in float32, levers are up to 20 cells, squared in the Hessian
        assert np.allclose(one, other, rtol=1e-4, atol=1e-4)


@given(seed=SEEDS)
@settings(max_examples=30)
def test_the_gradient_is_the_slope_of_the_likelihood_over_the_pose(seed: int) -> None:
    rng = np.random.default_rng(seed)
    density = np.zeros((40, 40, SIDES), dtype=np.float32)
    corner = np.concatenate(
        [
            np.column_stack((np.arange(-15.0, 15.0), np.full(30, 10.0))),
            np.column_stack((np.full(30, -12.0), np.arange(-15.0, 15.0))),
        ]
    )
    surface = np.column_stack((corner, np.ones(60), np.zeros((60, 2)))).astype(np.float32)
    smear(density, np.array([20.0, 20.0, 0.0]), surface, 1.0, 0.4)
    # near a wall's middle it bends downwards, so that every reading has its say
    middle = corner[np.abs(corner[:, 0] - 12.0) < 24.0]
    scan = middle, np.zeros_like(middle), rng.uniform(0.1, 1.0, len(middle))
    pose = np.array([20.0, 20.0, 0.0]) + rng.uniform(-0.4, 0.4, 3) * (1.0, 1.0, 0.02)
    step = 1e-5
    slope = [
        (terms(density, pose + h, scan, 0.5)[3] - terms(density, pose - h, scan, 0.5)[3])
        / (2.0 * step)
        for h in step * np.eye(3)
    ]
    gradient = terms(density, pose, scan, 0.5)[0]
    # the numbers are of size 10 and, over the yaw, 100
    assert np.allclose(gradient, slope, atol=1e-4, rtol=1e-4)


@given(seed=SEEDS)
@settings(max_examples=30)
def test_curvature_and_scatter_have_no_negative_eigenvalue(seed: int) -> None:
    rng = np.random.default_rng(seed)
    pose = np.array([*rng.uniform(0.0, 30.0, 2), rng.uniform(-4.0, 4.0)])
    _, hessian, scatter, _, matched = terms(a_field(rng), pose, a_scan(rng), 0.5)
    for matrix in (hessian, scatter):
        assert np.array_equal(matrix, matrix.T)
        assert np.linalg.eigvalsh(matrix)[0] >= -1e-9 * max(1.0, np.trace(matrix))
    assert 0.0 <= matched <= 1.0


def test_a_reading_tells_nothing_along_its_wall() -> None:
    rng = np.random.default_rng(0)
    density = rng.random((20, 20, SIDES)).astype(np.float32)
    scan = np.array([[0.3, 0.2]]), np.array([[0.0, 1.0]]), np.ones(1)
    gradient, hessian, _, _, _ = terms(density, np.array([10.0, 10.0, 0.0]), scan, 0.5)
    assert gradient[0] == 0.0
    assert not np.any(hessian[0])


def test_the_other_face_of_a_thin_wall_draws_no_reading() -> None:
    density = np.zeros((30, 30, SIDES), dtype=np.float32)
    face = np.column_stack((np.arange(30.0), np.full(30, 15.0), np.ones(30), np.zeros(30)))
    smear(density, np.zeros(3), np.column_stack((face, np.ones(30))).astype(np.float32), 1.0, 0.4)
    point, pose = np.array([[15.0, 14.6]]), np.zeros(3)
    for normal, is_drawn in ((1.0, True), (-1.0, False)):
        scan = point, np.array([[0.0, normal]]), np.ones(1)
        gradient, _, _, _, matched = terms(density, pose, scan, 0.5)
        assert (gradient[1] > 0.0) == is_drawn
        assert (matched > 0.5) == is_drawn


def test_readings_outside_of_the_field_count_as_unknown_things() -> None:
    scan = np.array([[1e9, 0.0], [-1e9, 0.0], [0.0, 50.0]]), np.zeros((3, 2)), np.ones(3)
    density = np.ones((10, 10, SIDES), dtype=np.float32)
    gradient, hessian, scatter, likelihood, matched = terms(density, np.zeros(3), scan, 0.5)
    assert not np.any(gradient)
    assert not np.any(hessian)
    assert not np.any(scatter)
    assert likelihood == pytest.approx(3.0 * np.log(0.5))
    assert matched == 0.0


def test_a_scan_without_readings_has_no_terms() -> None:
    scan = np.zeros((0, 2)), np.zeros((0, 2)), np.zeros(0)
    density = np.ones((10, 10, SIDES), dtype=np.float32)
    gradient, hessian, _, likelihood, matched = terms(density, np.full(3, 5.0), scan, 0.5)
    assert not np.any(gradient)
    assert not np.any(hessian)
    assert (likelihood, matched) == (0.0, 0.0)


def test_shares_are_of_all_sides_together() -> None:
    rng = np.random.default_rng(0)
    density = rng.random((7, 9, SIDES)).astype(np.float32)
    density[0, 0] = 0.0
    shares = np.empty((7, 9), dtype=np.uint8)
    shares_of(density, shares)
    height = density.sum(axis=2)
    # cut to whole numbers, of float32
    assert np.all(np.abs(shares - 255.0 * height / (height + KNOWN)) <= 1.001)
    assert shares[0, 0] == 0
