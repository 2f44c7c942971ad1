"""The odometry motion model: turn, way, turn give the motion back, and errors grow with it."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mapping.errors import TestbedError
from mapping.geometry import compose, wrap_to_pi
from mapping.localization.motion_model import MotionNoise, decomposed, sample_motion

EXACT = MotionNoise(
    turn_per_turn=0.0,
    turn_per_way=0.0,
    way_per_way=0.0,
    way_per_turn=0.0,
    shift_floor=0.0,
    turn_floor=0.0,
)
shift, turn = st.floats(-0.3, 0.3), st.floats(-3.0, 3.0)


@given(shift, shift, turn)
def test_turn_way_and_turn_give_the_motion_back(x: float, y: float, yaw: float) -> None:
    motion = np.array([x, y, yaw])
    first, way, second = decomposed(motion)
    again = compose(compose([0.0, 0.0, first], [way, 0.0, 0.0]), [0.0, 0.0, second])
    # of a way below a centimetre, what goes aside is dropped
    tolerance = 0.01 if math.hypot(x, y) < 0.01 else 1e-9
    assert again[:2] == pytest.approx(motion[:2], abs=tolerance)
    assert abs(wrap_to_pi(again[2] - yaw)) < 1e-9
    assert abs(first) <= 0.5 * math.pi + 1e-9, "it backs up rather than turns round"


def test_without_noise_every_sample_is_the_motion() -> None:
    poses = np.random.default_rng(0).uniform(-3.0, 3.0, (50, 3))
    motion = np.array([0.1, 0.02, 0.3])
    moved = sample_motion(poses, motion, EXACT, np.random.default_rng(1))
    assert moved == pytest.approx(compose(poses, motion), abs=1e-9)


def test_samples_scatter_about_the_motion_as_the_table_says() -> None:
    noise = MotionNoise(shift_floor=0.0, turn_floor=0.0)
    motion = np.array([1.0, 0.0, 0.0])
    moved = sample_motion(np.zeros((20_000, 3)), motion, noise, np.random.default_rng(2))
    # 20000 samples: a mean is within 4 sigma / 141, a deviation within 3 %
    assert moved.mean(axis=0) == pytest.approx(motion, abs=0.004)
    assert moved[:, 0].std() == pytest.approx(noise.way_per_way, rel=0.05)
    assert moved[:, 1].std() == pytest.approx(noise.turn_per_way, rel=0.03)
    assert moved[:, 2].std() == pytest.approx(math.sqrt(2.0) * noise.turn_per_way, rel=0.03)


def test_noise_that_is_none_is_refused() -> None:
    with pytest.raises(TestbedError, match="way_per_way"):
        MotionNoise(way_per_way=-0.1)
