import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from mapping.slam.correlative_kernels import FULL, block_maxima, search

Array = NDArray[np.float64]
SEEDS = st.integers(0, 10_000)

ROUNDING = 1e-6
"""Scores up to 1 are added up in float32."""


@given(seed=SEEDS, rows=st.integers(1, 20), columns=st.integers(1, 20), levels=st.integers(1, 6))
def test_block_maxima_are_the_maxima_over_blocks(
    seed: int, rows: int, columns: int, levels: int
) -> None:
    field = np.random.default_rng(seed).integers(0, 256, (rows, columns)).astype(np.uint8)
    maxima = block_maxima(field, levels)
    assert maxima.shape == (levels, rows, columns)
    for level in range(levels):
        for row in range(rows):
            for column in range(columns):
                block = field[row : row + 2**level, column : column + 2**level]
                assert maxima[level, row, column] == block.max()


def brute_scores(
    field: NDArray[np.uint8],
    points: Array,
    weights: Array,
    center: Array,
    turns: Array,
    reach: int,
    pull: Array,
) -> Array:
    """The score of every turn and shift ``(turns, shifts along y, shifts along x)``."""
    padded = np.pad(field.astype(float), 200) / FULL
    scores = np.empty((len(turns), 2 * reach + 1, 2 * reach + 1))
    shifts = np.arange(-reach, reach + 1)
    for k, turn in enumerate(turns):
        cos, sin = np.cos(center[2] + turn), np.sin(center[2] + turn)
        x, y = (points @ np.array([[cos, sin], [-sin, cos]]) + center[:2]).T
        columns = np.clip(np.floor(x).astype(int), -150, field.shape[1] + 150)
        rows = np.clip(np.floor(y).astype(int), -150, field.shape[0] + 150)
        for i, shift_y in enumerate(shifts):
            for j, shift_x in enumerate(shifts):
                share = padded[rows + shift_y + 200, columns + shift_x + 200]
                cost = pull[0] * (shift_x**2 + shift_y**2) + pull[1] * turn**2
                scores[k, i, j] = weights @ share - cost
    return scores


@given(
    seed=SEEDS,
    reach=st.integers(1, 11),
    levels=st.integers(1, 5),
    pulls=st.sampled_from([(0.0, 0.0), (0.001, 0.5), (0.05, 5.0)]),
)
@settings(max_examples=60)
def test_the_search_finds_what_trying_everything_finds(
    seed: int, reach: int, levels: int, pulls: tuple[float, float]
) -> None:
    rng = np.random.default_rng(seed)
    field = (rng.random((24, 30)) ** 4 * FULL).astype(np.uint8)
    count = int(rng.integers(1, 12))
    points, weights = rng.uniform(-14.0, 14.0, (count, 2)), rng.uniform(0.1, 1.0, count)
    weights /= weights.sum()
    # now and then the middle lies near or beyond the field's edge
    center = np.array([*rng.uniform(-4.0, 30.0, 2), rng.uniform(-4.0, 4.0)])
    turns, pull = np.linspace(-0.3, 0.3, 5), np.array(pulls)
    scores = brute_scores(field, points, weights, center, turns, reach, pull)
    score, turn, shift_x, shift_y = search(
        block_maxima(field, levels), points, weights, center, turns, reach, pull, -1e3
    )
    assert score == pytest.approx(scores.max(), abs=ROUNDING)
    assert max(abs(shift_x), abs(shift_y)) <= reach
    assert scores[turn, shift_y + reach, shift_x + reach] == pytest.approx(score, abs=ROUNDING)


@given(seed=SEEDS, floor=st.floats(0.0, 1.0))
@settings(max_examples=30)
def test_only_a_better_score_than_the_floor_is_found(seed: int, floor: float) -> None:
    rng = np.random.default_rng(seed)
    field = (rng.random((24, 30)) ** 4 * FULL).astype(np.uint8)
    points, weights = rng.uniform(-8.0, 8.0, (4, 2)), np.full(4, 0.25)
    center, turns, pull = np.array([15.0, 12.0, 0.4]), np.linspace(-0.2, 0.2, 3), np.zeros(2)
    best = brute_scores(field, points, weights, center, turns, 6, pull).max()
    assume(abs(best - floor) > ROUNDING)
    found = search(block_maxima(field, 3), points, weights, center, turns, 6, pull, floor)
    if best < floor:
        assert found == (floor, -1, 0, 0)
    else:
        assert found[0] == pytest.approx(best, abs=ROUNDING)
        assert found[1] >= 0


def test_readings_far_outside_of_the_field_score_nothing() -> None:
    field = np.full((8, 8), FULL, dtype=np.uint8)
    points, weights = np.array([[1e4, -1e4], [0.0, 0.0]]), np.array([0.5, 0.5])
    center = np.array([4.0, 4.0, 0.0])
    score, *_ = search(
        block_maxima(field, 3), points, weights, center, np.zeros(1), 3, np.zeros(2), 0.0
    )
    assert score == pytest.approx(0.5)
