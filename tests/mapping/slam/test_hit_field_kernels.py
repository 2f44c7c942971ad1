"""Smearing and sharing out a hit field, against plain references."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from mapping.slam.hit_field_kernels import REACH, SIDES, side_shares, smear
from tests.mapping.slam.hit_field_reference import SEEDS, directions, slow_shares, slow_smear


@given(seed=SEEDS)
@settings(max_examples=25)
def test_smearing_adds_a_bell_for_every_point_of_a_surface(seed: int) -> None:
    rng = np.random.default_rng(seed)
    edge, count = 0.05, 12
    pose = np.array([*rng.uniform(0.0, 24.0, 2), rng.uniform(-4.0, 4.0)])
    surface = np.column_stack(
        (rng.uniform(-0.6, 0.6, (count, 2)), rng.uniform(0.1, 1.0, count), directions(rng, count))
    ).astype(np.float32)
    density = np.zeros((20, 24, SIDES), dtype=np.float32)
    smear(density, pose, surface, edge, 0.4)
    # a bell is cut off REACH to REACH + 1 cells from its middle, where it is this high
    cut = count * 0.4 * np.exp(-0.5 * REACH**2)
    expected = slow_smear((20, 24), pose, surface, edge, 0.4)
    assert np.all(density <= expected + 1e-5)
    assert np.all(density >= expected - cut)
    near = expected > 3.0 * cut
    assert np.allclose(density[near], expected[near], atol=cut)


def test_a_bell_has_the_height_and_place_of_its_point() -> None:
    density = np.zeros((21, 21, SIDES), dtype=np.float32)
    surface = np.array([[0.1, 0.0, 0.5, 1.0, 0.0]], dtype=np.float32)
    smear(density, np.array([10.5, 10.5, np.pi / 2]), surface, 0.05, 2.0)
    # two cells ahead of a robot that looks along y, on a wall that then faces +y
    assert density[12, 10, 1] == pytest.approx(1.0)
    assert density[12, 11, 1] == pytest.approx(np.exp(-0.5))
    assert density[14, 10, 1] == pytest.approx(np.exp(-2.0))
    assert np.all(density[..., [0, 2, 3]] < 1e-6)


def test_points_outside_of_the_field_are_left_out() -> None:
    density = np.zeros((8, 8, SIDES), dtype=np.float32)
    far = np.array([[1e6, 0.0], [-1e6, 3.0], [0.0, -1e6], [0.9, 0.9]]) * 0.05
    surface = np.column_stack((far, np.ones((4, 1)), np.zeros((4, 2)))).astype(np.float32)
    smear(density, np.array([0.0, 0.0, 0.0]), surface, 0.05, 1.0)
    only = np.zeros_like(density)
    smear(only, np.array([0.0, 0.0, 0.0]), surface[3:], 0.05, 1.0)
    assert np.array_equal(density, only)
    assert density[0, 0, 0] > 0.0


@given(angle=st.floats(-10.0, 10.0))
def test_a_wall_is_shared_out_whole_among_its_sides(angle: float) -> None:
    sides = np.empty(SIDES, dtype=np.float32)
    normal = np.array([np.cos(angle), np.sin(angle)])
    side_shares(normal[0], normal[1], 1.0, sides)
    assert np.allclose(sides, slow_shares(normal, 1.0), atol=1e-6)
    assert sides.sum() == pytest.approx(1.0, abs=1e-6)


def test_a_wall_of_unknown_direction_counts_on_every_side() -> None:
    sides = np.empty(SIDES, dtype=np.float32)
    side_shares(0.0, 0.0, 0.7, sides)
    assert sides == pytest.approx([0.7] * SIDES)
