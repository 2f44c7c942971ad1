import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from mapping.slam.surface_kernels import (
    ASLANT,
    CLOSE,
    FELLOWS,
    FLATNESS,
    LEAST_FELLOWS,
    NEIGHBOURS,
    STEEPEST,
    WIDEST_GAP,
    normals_of,
    surface_of,
)
from tests.mapping.slam.rooms import distances, random_room

Array = NDArray[np.float64]
Readings = tuple[Array, Array, NDArray[np.int64]]

INCREMENT = np.pi / 180.0
SPACING = 0.05
SEEDS = st.integers(0, 10_000)


def readings(walls: Array, rng: np.random.Generator | None = None, keep: float = 1.0) -> Readings:
    """Ends, lengths and numbers of 360 beams from the origin, noisy and some lost at random."""
    angles = np.arange(360) * INCREMENT
    lengths = distances(walls, np.zeros((360, 3)), angles)
    kept = lengths < 3.5
    if rng is not None:
        kept &= rng.random(360) < keep
    angles, lengths = angles[kept], lengths[kept]
    if rng is not None:
        lengths = lengths * (1.0 + rng.normal(0.0, 0.012, len(lengths)))  # the LDS-01's
    ends = lengths[:, None] * np.column_stack((np.cos(angles), np.sin(angles)))
    return ends, lengths, np.flatnonzero(kept)


def apart(lengths: Array, indices: NDArray[np.int64], i: int, j: int) -> float:
    """How far two beams are from each other where the shorter one ends."""
    return float(min(lengths[i], lengths[j]) * INCREMENT * abs(indices[j] - indices[i]))


def slow_normals(points: Array, lengths: Array, indices: NDArray[np.int64]) -> Array:
    """By singular values of the readings near by in angle and in space."""
    normals = np.zeros_like(points)
    for i in range(len(points)):
        fellows = [
            points[j]
            for j in range(len(points))
            if abs(indices[j] - indices[i]) <= FELLOWS
            and np.linalg.norm(points[j] - points[i])
            <= STEEPEST * apart(lengths, indices, i, j) + CLOSE
        ]
        if len(fellows) < LEAST_FELLOWS:
            continue
        _, spread, axes = np.linalg.svd(np.array(fellows) - np.mean(fellows, axis=0))
        if spread[1] ** 2 <= FLATNESS * spread[0] ** 2:
            normals[i] = axes[1] * -np.sign(axes[1] @ points[i])
    return normals


def slow_surface(
    points: Array, lengths: Array, indices: NDArray[np.int64], weights: Array, normals: Array
) -> Array:
    """Row by row: from each reading towards the one before, the one after, then on the spot."""
    rows = []
    for i in range(len(points)):
        beam_width, reached = min(lengths[i] * INCREMENT, SPACING), 0.0
        for j in (i - 1, i + 1):
            if not 0 <= j < len(points) or abs(indices[j] - indices[i]) > NEIGHBOURS:
                continue
            way = points[j] - points[i]
            gap = np.linalg.norm(way)
            if gap > WIDEST_GAP or gap > STEEPEST * apart(lengths, indices, i, j) + SPACING:
                continue
            is_wall, is_along = np.any(normals[i]), abs(normals[i] @ way) <= ASLANT * gap
            if gap > SPACING and not (is_wall and is_along):
                continue
            reached += gap / 2.0
            pieces = int(np.ceil(gap / 2.0 / SPACING))
            for k in range(pieces):
                at = points[i] + way * (k + 0.5) / pieces / 2.0
                rows.append([*at, weights[i] * gap / 2.0 / pieces / SPACING, *normals[i]])
        if reached < beam_width:
            rest = weights[i] * (beam_width - reached) / SPACING
            rows.append([*points[i], rest, *normals[i]])
    return np.array(rows).reshape(-1, 5)


@given(seed=SEEDS, keep=st.sampled_from([1.0, 0.8, 0.3]))
@settings(max_examples=15)
def test_normals_are_the_axes_of_least_spread(seed: int, keep: float) -> None:
    rng = np.random.default_rng(seed)
    seen = readings(random_room(rng), rng, keep)
    found, expected = normals_of(*seen, INCREMENT), slow_normals(*seen)
    assert np.allclose(found, expected, atol=1e-6)


@given(seed=SEEDS, keep=st.sampled_from([1.0, 0.8, 0.3]))
@settings(max_examples=15)
def test_a_surface_is_laid_from_reading_to_reading(seed: int, keep: float) -> None:
    rng = np.random.default_rng(seed)
    seen = readings(random_room(rng), rng, keep)
    weights = rng.uniform(0.2, 1.0, len(seen[1]))
    normals = normals_of(*seen, INCREMENT)
    found = surface_of(*seen, weights, normals, INCREMENT, SPACING)
    assert np.allclose(found, slow_surface(*seen, weights, normals), atol=1e-5)


@pytest.mark.parametrize("spacing", [0.39, 0.41, 1.0])
def test_a_surface_of_any_spacing_fits_its_table(spacing: float) -> None:
    """The plain function, without Numba, refuses to write beyond its end."""
    angles = np.arange(360) * INCREMENT
    points = 3.0 * np.column_stack((np.cos(angles), np.sin(angles)))
    seen = points, np.full(360, 3.0), np.arange(360)
    normals = normals_of(*seen, INCREMENT)
    plain = surface_of.py_func(*seen, np.ones(360), normals, INCREMENT, spacing)
    assert len(plain) >= 360


def test_normals_of_a_straight_wall_face_the_robot() -> None:
    wall = np.array([[-4.0, 1.5, 4.0, 1.5]])
    normals = normals_of(*readings(wall), INCREMENT)
    assert len(normals) > 100
    assert np.allclose(normals, [0.0, -1.0], atol=1e-6)


def test_a_lone_reading_faces_nowhere() -> None:
    points, lengths = np.array([[1.0, 0.0]]), np.ones(1)
    assert not np.any(normals_of(points, lengths, np.zeros(1, dtype=np.int64), INCREMENT))


@given(seed=SEEDS, distance=st.floats(0.4, 2.0))
@settings(max_examples=20)
def test_every_spacing_of_a_straight_wall_has_weight_one(seed: int, distance: float) -> None:
    # however the beams fall: dense ahead and sparse aslant
    yaw = float(np.random.default_rng(seed).uniform(-np.pi, np.pi))
    cos, sin = np.cos(yaw), np.sin(yaw)
    ends = np.array([[-1.0, distance], [1.0, distance]]) @ np.array([[cos, sin], [-sin, cos]])
    seen = readings(ends.reshape(1, 4))
    weights = np.ones(len(seen[1]))
    surface = surface_of(*seen, weights, normals_of(*seen, INCREMENT), INCREMENT, SPACING)
    along = surface[:, 0] * cos + surface[:, 1] * sin
    assert np.allclose(surface[:, 1] * cos - surface[:, 0] * sin, distance, atol=1e-5)
    inner = np.abs(along) < 0.9
    order = np.argsort(along[inner])
    # no gap between points is wider than the spacing, and together they weigh what is between them
    gaps = np.diff(along[inner][order])
    assert np.max(gaps) <= SPACING * 1.01
    told = np.sum(surface[inner, 2]) * SPACING
    assert told == pytest.approx(1.8, abs=SPACING + 2.0 * np.max(gaps))


def test_a_wall_does_not_join_what_stands_before_it() -> None:
    walls = np.array([[-3.0, 2.0, 3.0, 2.0], [-0.2, 1.0, 0.2, 1.0]])
    seen = readings(walls)
    weights = np.ones(len(seen[1]))
    surface = surface_of(*seen, weights, normals_of(*seen, INCREMENT), INCREMENT, SPACING)
    assert np.all((np.abs(surface[:, 1] - 2.0) < 1e-5) | (np.abs(surface[:, 1] - 1.0) < 1e-5))


def test_one_failed_beam_leaves_no_gap_and_two_do() -> None:
    wall = np.array([[-4.0, 3.0, 4.0, 3.0]])
    points, lengths, indices = readings(wall)
    middle = int(np.argmin(np.abs(points[:, 0])))
    for lost, is_joined in (([middle], True), ([middle, middle + 1], False)):
        seen = [np.delete(each, lost, axis=0) for each in (points, lengths, indices)]
        normals = np.tile([0.0, -1.0], (len(seen[1]), 1))
        surface = surface_of(*seen, np.ones(len(seen[1])), normals, INCREMENT, SPACING)
        near = np.abs(surface[:, 0] - np.mean(points[lost, 0])) < 0.04
        assert np.any(near) == is_joined


def test_no_readings_have_no_surface() -> None:
    seen = np.zeros((0, 2)), np.zeros(0), np.zeros(0, dtype=np.int64)
    normals = normals_of(*seen, INCREMENT)
    assert normals.shape == (0, 2)
    assert surface_of(*seen, np.zeros(0), normals, INCREMENT, SPACING).shape == (0, 5)
