import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from mapping.scan_polygon import AGREE, APART, DISAGREE
from mapping.surface_distance_kernels import (
    COLUMNS,
    DX,
    DY,
    HIT,
    LENGTH,
    NONE,
    PAIR,
    SIGMA,
    X,
    Y,
    add_distances,
    beam_before,
    beams_by_direction,
)

SIDE, TILE = 208, 16
TILE_SHAPE = (13, 13)
REACH = (2.5, 1.0)

Array = NDArray[np.float64]


def random_beams(rng: np.random.Generator, count: int, drift: float) -> Array:
    """A whole turn from the middle of the raster, driving ``drift`` cells meanwhile."""
    angles = rng.uniform(-np.pi, np.pi) + 2.0 * np.pi * (np.arange(count) + 0.3) / count
    beams = np.empty((count, COLUMNS))
    heading = rng.uniform(-np.pi, np.pi)
    way = drift * (np.arange(count) / count - 0.5)
    beams[:, X] = SIDE / 2 + rng.uniform(-1.0, 1.0) + way * np.cos(heading)
    beams[:, Y] = SIDE / 2 + rng.uniform(-1.0, 1.0) + way * np.sin(heading)
    beams[:, DX], beams[:, DY] = np.cos(angles), np.sin(angles)
    beams[:, LENGTH] = rng.uniform(12.0, 95.0, count)
    beams[:, SIGMA] = 0.02 * beams[:, LENGTH]
    beams[:, HIT] = rng.random(count) < 0.8
    beams[:, PAIR] = rng.choice([APART, DISAGREE, AGREE], count, p=[0.1, 0.3, 0.6])
    same = beams[:, HIT] == np.roll(beams[:, HIT], -1)
    beams[(beams[:, PAIR] == AGREE) & ~same, PAIR] = DISAGREE
    return beams


def all_cells() -> tuple[NDArray[np.int32], NDArray[np.int64]]:
    """Every cell of the raster, tile by tile, and where the tiles' cells begin."""
    cells = np.argwhere(np.ones((SIDE, SIDE))).astype(np.int32)
    tiles = cells[:, 0] // TILE * TILE_SHAPE[1] + cells[:, 1] // TILE
    order = np.argsort(tiles, kind="stable")
    starts = np.searchsorted(tiles[order], np.arange(TILE_SHAPE[0] * TILE_SHAPE[1] + 1))
    return cells[order], starts


def side(beam: Array, x: float, y: float) -> float:
    """How far left of a beam a point lies."""
    return float(beam[DX] * (y - beam[Y]) - beam[DY] * (x - beam[X]))


def slow_told(beams: Array, x: float, y: float) -> tuple[float, float] | None:
    """Weight and distance that a scan tells of a point: every pair of beams is tried."""
    for before, after in zip(beams, np.roll(beams, -1, axis=0), strict=True):
        left, right = side(before, x, y), -side(after, x, y)
        along = [math.hypot(x - b[X], y - b[Y]) for b in (before, after)]
        ahead = all(b[DX] * (x - b[X]) + b[DY] * (y - b[Y]) > 0.0 for b in (before, after))
        if before[PAIR] == APART or left < 0.0 or right <= 0.0 or not ahead:
            continue
        along = [math.sqrt(a**2 - s**2) for a, s in zip(along, (left, right), strict=True)]
        share = left / (left + right)
        nearer, at = (before, along[0]) if share < 0.5 else (after, along[1])
        length, sigma = nearer[LENGTH], nearer[SIGMA]
        if before[PAIR] == AGREE:
            # on a straight wall the inverse of the length goes evenly from beam to beam
            inverses = [1.0 / before[LENGTH], 1.0 / after[LENGTH]]
            length = 1.0 / np.interp(share, [0.0, 1.0], inverses)
            sigma = np.interp(share, [0.0, 1.0], [before[SIGMA], after[SIGMA]])
            at = np.interp(share, [0.0, 1.0], along)
        bound = REACH[0] + REACH[1] * sigma
        if length - at < -bound or (not nearer[HIT] and length - at < bound):
            return None
        return 1.0 / sigma**2, min(length - at, bound)
    return None


@settings(max_examples=15, deadline=None)
@given(st.integers(0, 2**32 - 1), st.sampled_from([90, 360]), st.sampled_from([0.0, 2.0]))
def test_each_cell_is_told_what_trying_every_pair_of_beams_tells(
    seed: int, count: int, drift: float
) -> None:
    rng = np.random.default_rng(seed)
    beams = random_beams(rng, count, drift)
    cells, starts = all_cells()
    sums = np.zeros((len(cells), 3), dtype=np.float32)
    add_distances(cells, starts, TILE, TILE_SHAPE, sums, beams, REACH)
    for k in rng.choice(len(cells), 250, replace=False):
        x, y = cells[k, 1] + 0.5, cells[k, 0] + 0.5
        if math.hypot(x - SIDE / 2, y - SIDE / 2) < 6.0:
            continue  # where beams cross, as they start apart, a cell may lie between two pairs
        told = slow_told(beams, x, y)
        wanted = (0.0, 0.0, 0.0) if told is None else (1.0, told[0], told[0] * told[1])
        assert sums[k] == pytest.approx(wanted, rel=1e-4, abs=1e-3)


def test_cells_that_no_beam_can_reach_are_left_alone() -> None:
    beams = random_beams(np.random.default_rng(0), 360, 0.0)
    beams[:, LENGTH], beams[:, SIGMA], beams[:, HIT] = 8.0, 0.1, 1.0
    cells, starts = all_cells()
    sums = np.zeros((len(cells), 3), dtype=np.float32)
    add_distances(cells, starts, TILE, TILE_SHAPE, sums, beams, REACH)
    far = np.hypot(cells[:, 1] - SIDE / 2, cells[:, 0] - SIDE / 2) > 14.0
    assert not sums[far].any()
    assert sums[~far].any()


def test_between_beams_that_are_no_neighbours_there_is_none() -> None:
    beams = random_beams(np.random.default_rng(0), 4, 0.0)
    beams[:, [DX, DY]] = [(1, 0), (0, 1), (-1, 0), (0, -1)]
    beams[:, [X, Y]] = 30.0
    beams[:, PAIR] = [AGREE, APART, AGREE, AGREE]
    table = beams_by_direction(beams)
    assert beam_before(40.0, 33.0, beams, table) == 0
    assert beam_before(25.0, 35.0, beams, table) == NONE
    assert beam_before(25.0, 25.0, beams, table) == 2
    assert beam_before(35.0, 25.0, beams, table) == 3
