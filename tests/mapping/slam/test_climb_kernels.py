from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray
from scipy.optimize import minimize

from mapping.slam.climb_kernels import climb, drop_flat
from mapping.slam.hit_field import HitField
from mapping.slam.hit_field_kernels import newton_terms
from mapping.slam.scan_cloud import ScanCloud
from tests.mapping.slam.rooms import cloud_of, corridor, random_room, scan_of

Array = NDArray[np.float64]
EDGE, OUTLIER, LEAST = 0.05, 1.0, 0.02
SEEDS = st.integers(0, 10_000)
UNITS = np.array([1.0, 1.0, 0.02])
"""A cell, and the turn that moves what is 50 cells away by one."""

LOOSE = np.diag([0.01, 0.01, 10.0])
"""Information of a prior that hardly says anything [1/cells^2, 1/rad^2]."""


def a_place(walls: Array, rng: np.random.Generator) -> tuple[HitField, ScanCloud, Array]:
    """A field of three scans around a pose, another scan from there, and the pose in cells."""
    pose = np.array([*rng.uniform(-0.2, 0.2, 2), rng.uniform(-np.pi, np.pi)])
    field = HitField(EDGE, 4.4, OUTLIER)
    field.clear(pose[:2])
    for _ in range(3):
        near = pose + rng.uniform(-0.15, 0.15, 3)
        field.add(near, cloud_of(scan_of(walls, near, rng), EDGE).surface)
    return field, cloud_of(scan_of(walls, pose, rng), EDGE), field.to_cells(pose)


def climbed(
    field: HitField, cloud: ScanCloud, start: Array, prior: Array, information: Array
) -> tuple[Array, Array, Array, float]:
    return climb(
        field.density,
        start,
        prior,
        information,
        cloud.points / EDGE,
        cloud.normals,
        cloud.weights,
        OUTLIER,
        LEAST,
    )


def value(
    field: HitField, cloud: ScanCloud, pose: Array, prior: Array, information: Array
) -> float:
    """Log likelihood of a pose, prior and all."""
    offset, scratch = pose - prior, (np.empty(3), np.empty((3, 3)), np.empty((3, 3)))
    scan = cloud.points / EDGE, cloud.normals, cloud.weights
    told, _ = newton_terms(field.density, pose, *scan, OUTLIER, *scratch)
    return told - 0.5 * float(offset @ information @ offset)


@given(seed=SEEDS)
@settings(max_examples=20)
def test_climbing_ends_on_the_top_that_another_method_finds(seed: int) -> None:
    rng = np.random.default_rng(seed)
    field, cloud, truth = a_place(random_room(rng), rng)
    # readings of walls of unknown direction: all of their slope counts
    cloud = replace(cloud, normals=np.zeros_like(cloud.normals))
    start = truth + rng.uniform(-1.0, 1.0, 3) * UNITS
    pose, *_ = climbed(field, cloud, start, truth, LOOSE)
    found = minimize(
        lambda x: -value(field, cloud, truth + x * UNITS, truth, LOOSE),
        (start - truth) / UNITS,
        method="Nelder-Mead",
        options={"xatol": 1e-3, "fatol": 1e-6},
    )
    apart = truth + found.x * UNITS - pose
    # readings where the likelihood bends upwards have no slope for the climb
    assert np.hypot(*apart[:2]) < 0.1
    assert abs(apart[2]) < 0.003


@given(seed=SEEDS)
@settings(max_examples=20)
def test_climbing_never_ends_below_its_start(seed: int) -> None:
    rng = np.random.default_rng(seed)
    field, cloud, truth = a_place(random_room(rng), rng)
    start = truth + rng.uniform(-8.0, 8.0, 3) * (1.0, 1.0, 0.05)
    prior = start + rng.uniform(-2.0, 2.0, 3) * (1.0, 1.0, 0.05)
    pose, hessian, scatter, matched = climbed(field, cloud, start, prior, LOOSE)
    assert np.all(np.isfinite(pose))
    before = value(field, cloud, start, prior, LOOSE)
    assert value(field, cloud, pose, prior, LOOSE) >= before
    for matrix in (hessian, scatter):
        assert np.linalg.eigvalsh(matrix)[0] >= -1e-9 * max(np.trace(matrix), 1.0)
    assert 0.0 <= matched <= 1.0


def test_in_an_empty_field_the_prior_is_the_top() -> None:
    field, cloud, pose = a_place(random_room(np.random.default_rng(0)), np.random.default_rng(0))
    field.clear([0.0, 0.0])
    prior = pose + [2.0, -1.0, 0.03]
    found, hessian, scatter, matched = climbed(field, cloud, pose, prior, np.eye(3))
    assert found == pytest.approx(prior, abs=1e-6)
    assert not hessian.any()
    assert not scatter.any()
    assert matched == 0.0


@given(seed=SEEDS)
@settings(max_examples=15)
def test_along_a_bare_corridor_the_climb_stays_with_the_prior(seed: int) -> None:
    rng = np.random.default_rng(seed)
    field, cloud, truth = a_place(corridor(), rng)
    prior = truth + rng.uniform(-1.0, 1.0, 3) * UNITS
    pose, hessian, *_ = climbed(field, cloud, prior, prior, LOOSE)
    # walls drawn from noisy readings are aslant by a few thousandths
    assert abs(pose[0] - prior[0]) < 0.02
    assert abs(pose[1] - truth[1]) < 0.2
    assert hessian[0, 0] < 1e-3 * hessian[1, 1]


def slow_drop(
    gradient: Array, hessian: Array, points: Array, weights: Array, total: float, least: float
) -> tuple[Array, Array]:
    """Take out eigenvectors of small curvature, the yaw scaled by the readings' usual distance."""
    lever = np.sqrt(np.sum(weights * np.sum(points**2, axis=1)) / weights.sum())
    scale = np.array([1.0, 1.0, lever])
    values, axes = np.linalg.eigh(hessian / np.outer(scale, scale))
    kept = axes[:, values >= least * total]
    keep = kept @ kept.T
    dropped = scale * (keep @ (gradient / scale))
    return dropped, keep @ (hessian / np.outer(scale, scale)) @ keep * np.outer(scale, scale)


@given(seed=SEEDS, least=st.floats(1e-3, 3.0))
def test_flat_directions_are_taken_out_by_the_book(seed: int, least: float) -> None:
    rng = np.random.default_rng(seed)
    jacobian = rng.normal(size=(3, 3)) * rng.choice([0.05, 1.0], (1, 3))
    gradient, hessian = rng.normal(size=3), jacobian.T @ jacobian
    points, weights = rng.normal(size=(6, 2)), rng.uniform(0.1, 1.0, 6)
    expected = slow_drop(gradient, hessian, points, weights, 1.5, least)
    drop_flat(gradient, hessian, points, weights, 1.5, least)
    # directions are found by iteration, whose inverse is of a curvature a billionth too large
    assert gradient == pytest.approx(expected[0], abs=1e-5)
    assert hessian == pytest.approx(expected[1], abs=1e-5)


def test_a_scan_that_matches_nothing_is_flat_all_over() -> None:
    gradient, hessian = np.ones(3), np.eye(3)
    drop_flat(gradient, hessian, np.ones((2, 2)), np.ones(2), 0.0, LEAST)
    assert not gradient.any()
    assert not hessian.any()
