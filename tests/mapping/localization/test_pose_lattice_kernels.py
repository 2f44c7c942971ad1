"""The kernel that moves a belief over cells, beside a slow reference."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mapping.localization.pose_lattice_kernels import shift_belief

RESOLUTION = 0.25


def slow(belief: np.ndarray, motion: tuple[float, float, float]) -> np.ndarray:
    """Each cell's share to the eight cells around where its middle comes to lie."""
    layers, rows, columns = belief.shape
    moved = np.zeros_like(belief)
    for (layer, row, column), share in np.ndenumerate(belief):
        yaw = 2.0 * math.pi * layer / layers
        x = column + (math.cos(yaw) * motion[0] - math.sin(yaw) * motion[1]) / RESOLUTION
        y = row + (math.sin(yaw) * motion[0] + math.cos(yaw) * motion[1]) / RESOLUTION
        z = layer + motion[2] * layers / (2.0 * math.pi)
        for k in (math.floor(z), math.floor(z) + 1):
            for j in (math.floor(y), math.floor(y) + 1):
                for i in (math.floor(x), math.floor(x) + 1):
                    part = (1 - abs(z - k)) * (1 - abs(y - j)) * (1 - abs(x - i))
                    if 0 <= j < rows and 0 <= i < columns:
                        moved[k % layers, j, i] += share * part
    return moved


@given(st.integers(0, 1000), st.floats(-0.6, 0.6), st.floats(-0.6, 0.6), st.floats(-3.0, 3.0))
def test_the_kernel_is_the_slow_reference(seed: int, x: float, y: float, turn: float) -> None:
    belief = np.random.default_rng(seed).dirichlet(np.ones(4 * 3 * 5)).reshape(4, 3, 5)
    moved = shift_belief(belief, (x, y, turn), RESOLUTION, 0.0)
    assert moved == pytest.approx(slow(belief, (x, y, turn)), abs=1e-9)


def test_no_belief_is_lost_inside_and_whole_cells_move_exactly() -> None:
    belief = np.zeros((8, 9, 9))
    belief[2, 4, 4] = 1.0  # facing +y
    moved = shift_belief(belief, (2 * RESOLUTION, 0.0, math.pi / 4), RESOLUTION, 0.0)
    assert moved.sum() == pytest.approx(1.0)
    assert moved[3, 6, 4] == pytest.approx(1.0)
