import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from mapping.slam.gmapping_kernels import climb, fit, gather_full, match_particles, turn
from mapping.slam.tile_map import TileMaps
from mapping.slam.tile_map_kernels import TILE_CELLS

Array = NDArray[np.float64]
EVERYTHING = -1.0
FULL_SHARE = 0.1

CENTRE = np.array([48.3, 48.6, 0.0])
"""In cells from the corner of the table."""


def random_map(rng: np.random.Generator) -> TileMaps:
    """Three tiles by three with walls in random places."""
    maps = TileMaps(1, 1.0, (0.0, 0.0), FULL_SHARE)
    maps.cover(40.0, 50.0, 40.0, 50.0)
    for _ in range(40):
        pose = np.array([*rng.uniform(20.0, 70.0, 2), rng.uniform(-3.0, 3.0)])
        maps.write(0, pose, np.zeros((1, 2)), rng.uniform(-9.0, 9.0, (1, 2)), np.array([True]))
    return maps


def room(half: float = 25.0) -> tuple[TileMaps, Array]:
    """A square room seen once from CENTRE, and that scan."""
    maps = TileMaps(1, 1.0, (0.0, 0.0), FULL_SHARE)
    maps.cover(40.0, 60.0, 40.0, 60.0)
    angles = np.linspace(0.0, 2.0 * np.pi, 360, endpoint=False)
    directions = np.column_stack((np.cos(angles), np.sin(angles)))
    reach = half / np.max(np.abs(directions), axis=1)
    ends = directions * reach[:, None]
    maps.write(0, maps.in_map(CENTRE), np.zeros_like(ends), ends, np.ones(360, dtype=np.bool_))
    return maps, np.hstack((ends, -np.sqrt(2.0) * directions))


def packed(maps: TileMaps) -> NDArray[np.uint32]:
    rows, columns = maps.tables.shape[1:]
    bits = np.empty((rows * TILE_CELLS, columns + 1), dtype=np.uint32)
    gather_full(maps.tables[0], maps.full, bits)
    return bits


def turned(points: Array, yaw: float) -> Array:
    result = np.empty_like(points)
    turn(yaw, points, result)
    return result


def slow_fit(
    pose: Array, points: Array, kernel: int, sharpness: float, maps: TileMaps
) -> tuple[float, float, float]:
    """As the kernel's words have it, cell by cell."""

    def look(column: int, row: int) -> tuple[bool, Array]:
        tile = maps.tables[0, row // TILE_CELLS, column // TILE_CELLS]
        y, x = row % TILE_CELLS, column % TILE_CELLS
        full = maps.hits[tile, y, x] > FULL_SHARE * maps.visits[tile, y, x]
        return bool(full), np.array([column, row]) + maps.means[tile, y, x]

    rows, columns = TILE_CELLS * np.array(maps.tables.shape[1:])
    c, s = np.cos(pose[2]), np.sin(pose[2])
    turning = np.array([[c, -s], [s, c]])
    score, squares, lost = 0.0, 0.0, 0.0
    for point in points:
        end = pose[:2] + turning @ point[:2]
        back = np.floor(turning @ point[2:] + 0.5).astype(int)
        column, row = np.floor(end).astype(int)
        if min(column, row) <= kernel or column + kernel >= columns - 1 or row + kernel >= rows - 1:
            lost += 1
            continue
        found = []
        for j in range(row - kernel, row + kernel + 1):
            for i in range(column - kernel, column + kernel + 1):
                full, mean = look(i, j)
                if full and not look(i + back[0], j + back[1])[0]:
                    found.append(float(np.sum((end - mean) ** 2)))
        score += np.exp(-sharpness * min(found)) if found else 0.0
        squares += min(found, default=0.0)
        lost += not found
    return score, squares, lost


@given(seed=st.integers(0, 10_000), kernel=st.integers(0, 4))
@settings(max_examples=25, deadline=None)
def test_a_fit_equals_the_slow_reference(seed: int, kernel: int) -> None:
    rng = np.random.default_rng(seed)
    maps = random_map(rng)
    points = np.hstack((rng.uniform(-60.0, 60.0, (80, 2)), np.zeros((80, 2))))
    angles = rng.uniform(-np.pi, np.pi, 80)
    points[:, 2:] = np.sqrt(2.0) * np.column_stack((np.cos(angles), np.sin(angles)))
    # half of the points end near something
    tile, y, x = np.argwhere(maps.hits)[rng.integers(0, np.count_nonzero(maps.hits), 40)].T
    where = [np.argwhere(maps.tables[0] == number)[0] * TILE_CELLS for number in tile]
    pose = np.array([*rng.uniform(30.0, 60.0, 2), rng.uniform(-np.pi, np.pi)])
    near = np.array(where)[:, ::-1] + np.column_stack((x, y)) + rng.normal(0.5, 1.5, (40, 2))
    c, s = np.cos(pose[2]), np.sin(pose[2])
    points[:40, :2] = (near - pose[:2]) @ np.array([[c, -s], [s, c]])
    expected = slow_fit(pose, points, kernel, 0.3, maps)
    found = fit(
        pose[0], pose[1], turned(points, pose[2]), kernel, 0.3, EVERYTHING, packed(maps),
        maps.tables[0], maps.means,
    )  # fmt: skip
    assert found == pytest.approx(expected, rel=1e-5, abs=1e-5)


def test_a_fit_that_cannot_reach_a_score_never_claims_to_exceed_it() -> None:
    maps, points = room()
    bits, rng = packed(maps), np.random.default_rng(1)
    for x, y, yaw in rng.normal((48.3, 48.6, 0.0), (1.0, 1.0, 0.05), (50, 3)):
        args = x, y, turned(points, yaw), 1, 0.5
        whole, _, _ = fit(*args, EVERYTHING, bits, maps.tables[0], maps.means)
        for least in (0.5 * whole, whole, whole + 1.0):
            some, _, _ = fit(*args, least, bits, maps.tables[0], maps.means)
            assert some == pytest.approx(whole) if whole > least else some <= least


def test_a_scan_climbs_back_to_where_its_map_was_made() -> None:
    maps, points = room()
    bits = packed(maps)
    for start in ((48.3, 48.6, 0.0), (49.0, 47.9, 0.02), (47.5, 48.9, -0.025)):
        x, y, yaw, score = climb(
            np.array(start), points, (1.0, 0.05), 5, 1, 0.5, bits, maps.tables[0], maps.means
        )
        # a tenth of a cell, and what turns the farthest point by as much
        assert np.hypot(x - 48.3, y - 48.6) < 0.1
        assert abs(yaw) < 0.1 / 25.0
        # hits share their cell's mean, which is at most half a cell away along the wall
        assert score > np.exp(-0.5 * 0.5**2) * len(points)


def test_a_match_that_is_not_believed_leaves_the_particle_where_it_was() -> None:
    maps, points = room()
    start = np.array([[49.0, 47.9, 0.02]])
    settings_ = points, (1.0, 0.05), 5, 1, 0.5
    pool = maps.tables, maps.means, maps.full
    kept, fits = match_particles(start, *settings_, float(len(points)), *pool)
    assert np.array_equal(kept, start)
    assert 0.0 < fits[0, 0] < len(points)
    moved, better = match_particles(start, *settings_, 0.0, *pool)
    assert not np.array_equal(moved, start)
    assert better[0, 0] > fits[0, 0]
