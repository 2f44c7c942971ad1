"""The path's inner loops against NumPy."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from nav.path_kernels import SEARCHED_POINTS, advance, is_near, point_ahead


def random_path(seed: int) -> tuple[np.ndarray, np.ndarray]:
    steps = np.random.default_rng(seed).uniform(-0.05, 0.1, (40, 2))
    path = np.cumsum(steps, axis=0)
    return path, np.concatenate(([0.0], np.cumsum(np.hypot(*np.diff(path, axis=0).T))))


@given(seed=st.integers(0, 10_000), progress=st.integers(0, 39))
@settings(max_examples=40)
def test_progress_is_the_nearest_of_the_next_points(seed: int, progress: int) -> None:
    path, along = random_path(seed)
    pose = np.append(path[progress] + 0.03, 0.0)
    window = path[progress : progress + SEARCHED_POINTS]
    gaps = np.hypot(*(window - pose[:2]).T)
    nearest, left = advance(path, along, progress, pose)
    assert nearest == progress + int(np.argmin(gaps))
    assert left == pytest.approx(gaps.min() + along[-1] - along[nearest])


@given(seed=st.integers(0, 10_000), progress=st.integers(0, 39), distance=st.floats(0.0, 5.0))
@settings(max_examples=40)
def test_the_point_ahead_lies_that_far_along(seed: int, progress: int, distance: float) -> None:
    path, along = random_path(seed)
    wanted = min(along[progress] + distance, along[-1])
    expected = [np.interp(wanted, along, path[:, axis]) for axis in (0, 1)]
    assert point_ahead(path, along, progress, distance) == pytest.approx(expected)


@given(seed=st.integers(0, 10_000))
@settings(max_examples=40)
def test_points_near_a_path_are_found(seed: int) -> None:
    path, _ = random_path(seed)
    points = np.random.default_rng(seed).uniform(-1.0, 3.0, (5, 2))
    gaps = np.hypot(*(points[:, None] - path).transpose(2, 0, 1))
    for distance in (0.1, 0.3, 1.0):
        assert is_near(points, path, distance) == bool((gaps < distance).any())
    assert not is_near(points[:0], path, 1.0)
