import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mapping.geometry import (
    between,
    circular_mean,
    compose,
    inverse,
    transform_points,
    wrap_to_pi,
)

POSE = st.tuples(st.floats(-50, 50), st.floats(-50, 50), st.floats(-3.1, 3.1))


def matrix(pose: tuple[float, float, float]) -> np.ndarray:
    x, y, yaw = pose
    return np.array(
        [[np.cos(yaw), -np.sin(yaw), x], [np.sin(yaw), np.cos(yaw), y], [0.0, 0.0, 1.0]]
    )


@given(a=POSE, b=POSE)
def test_composing_poses_multiplies_their_matrices(
    a: tuple[float, float, float], b: tuple[float, float, float]
) -> None:
    assert np.allclose(matrix(compose(a, b)), matrix(a) @ matrix(b))
    assert np.allclose(matrix(compose(a, inverse(a))), np.eye(3), atol=1e-9)
    assert np.allclose(matrix(compose(a, between(a, b))), matrix(b), atol=1e-9)


@given(pose=POSE, x=st.floats(-9, 9), y=st.floats(-9, 9))
def test_points_move_as_poses_without_yaw(
    pose: tuple[float, float, float], x: float, y: float
) -> None:
    assert np.allclose(transform_points(pose, [[x, y]])[0], compose(pose, [x, y, 0.0])[:2])


@given(angle=st.floats(-100, 100))
def test_wrapped_angles_lie_above_minus_pi_and_up_to_pi(angle: float) -> None:
    wrapped = float(wrap_to_pi(angle))
    assert -np.pi < wrapped <= np.pi
    assert np.isclose(np.cos(wrapped), np.cos(angle), atol=1e-9)
    assert np.isclose(np.sin(wrapped), np.sin(angle), atol=1e-9)


def test_pi_stays_pi() -> None:
    assert wrap_to_pi([np.pi, -np.pi]) == pytest.approx([np.pi, np.pi])


def test_the_mean_of_angles_around_pi_is_pi() -> None:
    assert abs(circular_mean([3.0, -3.0])) == pytest.approx(np.pi)
    assert circular_mean([0.0, 1.0], weights=[1.0, 0.0]) == pytest.approx(0.0)
