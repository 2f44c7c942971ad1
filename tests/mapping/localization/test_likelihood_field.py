"""The likelihood field: table 6.3 by hand, and its kernel beside a slow reference."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mapping.errors import TestbedError
from mapping.geometry import transform_points
from mapping.localization.likelihood_field import LikelihoodField, LikelihoodFieldConfig
from mapping.localization.likelihood_kernels import score_poses
from tests.mapping.localization.places import L_ROOM, map_of

KNOWN = map_of(L_ROOM, (0.5, 0.5))


def test_a_reading_has_the_likelihood_of_the_book() -> None:
    config = LikelihoodFieldConfig(togetherness=1.0, resolution=0.02)
    field = LikelihoodField(KNOWN, config)
    for away in (0.0, 0.1, 0.3):
        point = np.array([[1.0, away + 0.01]])  # the wall's cell reaches from 0 to 0.02 m
        expected = 0.9 * math.exp(-0.5 * (away / 0.1) ** 2) / (0.1 * math.sqrt(2.0 * math.pi))
        expected += 0.1 / 3.5
        found = field.log_likelihoods(np.zeros((1, 3)), point)[0]
        # half a cell of 2 cm to each side
        assert found == pytest.approx(math.log(expected), abs=0.1 * (1.0 + away / 0.1))
    off_the_map = field.log_likelihoods(np.zeros((1, 3)), np.array([[50.0, 0.0]]))[0]
    assert off_the_map == pytest.approx(math.log(0.1 / 3.5), rel=1e-5)


@given(st.integers(0, 10_000))
def test_the_kernel_is_the_slow_reference(seed: int) -> None:
    rng = np.random.default_rng(seed)
    field = rng.standard_normal((9, 13)).astype(np.float32)
    poses = rng.uniform(-1.0, 2.0, (4, 3))
    points = rng.uniform(-1.5, 1.5, (7, 2))
    nothing, origin, resolution = np.float32(-9.0), (-0.7, -0.4), 0.2
    expected = []
    for pose in poses:
        total = 0.0
        for x, y in transform_points(pose, points):
            column = math.floor((x - origin[0]) / resolution)
            row = math.floor((y - origin[1]) / resolution)
            inside = 0 <= row < 9 and 0 <= column < 13
            total += field[row, column] if inside else nothing
        expected.append(total)
    assert score_poses(field, nothing, origin, resolution, poses, points) == pytest.approx(expected)


def test_the_true_pose_is_the_likeliest_around() -> None:
    field = LikelihoodField(KNOWN)
    true = np.array([1.2, 0.9, 0.4])
    wall = np.array([[x, 0.0] for x in np.linspace(0.3, 3.0, 20)] + [[0.0, 1.5], [0.0, 2.0]])
    seen = (wall - true[:2]) @ np.array(
        [[math.cos(0.4), -math.sin(0.4)], [math.sin(0.4), math.cos(0.4)]]
    )
    offsets = np.random.default_rng(0).uniform(-1.0, 1.0, (200, 3)) * [0.8, 0.8, 0.6]
    scores = field.log_likelihoods(np.vstack((true, true + offsets)), seen)
    assert np.argmax(scores) == 0 or np.hypot(*offsets[np.argmax(scores) - 1, :2]) < 0.1


def test_readings_are_thinned_evenly() -> None:
    field = LikelihoodField(KNOWN, LikelihoodFieldConfig(beams=10))
    points = np.column_stack((np.arange(100.0), np.zeros(100)))
    assert field.thinned(points)[:, 0].tolist() == list(range(0, 100, 10))
    assert len(field.thinned(points[:4])) == 4
    assert len(field.thinned(points[:0])) == 0
    assert field.log_likelihoods(np.zeros((3, 3)), points[:0]).tolist() == [0.0, 0.0, 0.0]


def test_what_makes_no_mixture_is_refused() -> None:
    with pytest.raises(TestbedError, match="sum to 1"):
        LikelihoodFieldConfig(z_hit=0.9, z_rand=0.2)
    with pytest.raises(TestbedError, match="sigma_hit"):
        LikelihoodFieldConfig(sigma_hit=0.0)
    with pytest.raises(TestbedError, match="beams"):
        LikelihoodFieldConfig(beams=0)
