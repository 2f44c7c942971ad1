"""The kernels against NumPy and pose composition, one beam at a time."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from mapping.deskew_kernels import aim, bounds, interpolate
from mapping.geometry import compose, wrap_to_pi


def random_rows(rng: np.random.Generator, count: int) -> np.ndarray:
    stamps = np.cumsum(rng.uniform(0.02, 0.05, count))
    yaw = wrap_to_pi(3.0 + np.cumsum(rng.uniform(-0.3, 0.3, count)))
    columns = (stamps, *rng.uniform(-2.0, 2.0, (2, count)), yaw, *rng.uniform(-1, 1, (2, count)))
    return np.column_stack(columns)


@given(seed=st.integers(0, 10_000), count=st.integers(1, 12))
@settings(max_examples=40)
def test_poses_between_messages_equal_numpys_interpolation(seed: int, count: int) -> None:
    rng = np.random.default_rng(seed)
    rows = random_rows(rng, count)
    stamps = rng.uniform(rows[0, 0], rows[-1, 0], 30)
    yaw = np.interp(stamps, rows[:, 0], np.unwrap(rows[:, 3]))
    expected = np.column_stack(
        [np.interp(stamps, rows[:, 0], rows[:, k]) for k in (1, 2)] + [wrap_to_pi(yaw)]
    )
    difference = interpolate(rows, stamps) - expected
    assert difference[:, :2] == pytest.approx(0.0, abs=1e-9)
    assert wrap_to_pi(difference[:, 2]) == pytest.approx(0.0, abs=1e-9)


@given(seed=st.integers(0, 10_000))
@settings(max_examples=40)
def test_poses_beyond_the_messages_follow_the_nearest_twist(seed: int) -> None:
    rng = np.random.default_rng(seed)
    rows = random_rows(rng, 4)
    for row, time in ((rows[0], -0.1), (rows[-1], 0.1)):
        _, x, y, yaw, speed, rate = row
        middle = yaw + 0.5 * rate * time
        expected = (x + speed * time * np.cos(middle), y + speed * time * np.sin(middle))
        pose = interpolate(rows, row[:1] + time)[0]
        assert pose[:2] == pytest.approx(expected, abs=1e-9)
        assert wrap_to_pi(pose[2] - yaw - rate * time) == pytest.approx(0.0, abs=1e-9)


@given(seed=st.integers(0, 10_000))
@settings(max_examples=20)
def test_beams_start_point_and_end_as_composed_poses_say(seed: int) -> None:
    rng = np.random.default_rng(seed)
    start, mount = rng.uniform(-3.0, 3.0, 3), tuple(rng.uniform(-0.1, 0.1, 3))
    poses, angles = rng.uniform(-3.0, 3.0, (20, 3)), rng.uniform(0.0, 6.28, 20)
    reach = rng.uniform(0.0, 3.5, 20)
    origins, directions, ends = aim(start, poses, mount, angles, reach)
    sensors = compose(compose(start, poses), mount)
    pointing = sensors[:, 2] + angles
    assert origins == pytest.approx(sensors[:, :2])
    assert directions == pytest.approx(np.column_stack((np.cos(pointing), np.sin(pointing))))
    assert ends == pytest.approx(origins + reach[:, None] * directions)
    points = np.concatenate((origins, ends))
    (left, bottom), (right, top) = points.min(axis=0), points.max(axis=0)
    assert bounds(origins, ends) == (left, right, bottom, top)
