from collections import defaultdict
from copy import deepcopy

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from mapping.grid import FREE, OCCUPIED, UNKNOWN, GridConfig, OccupancyGrid
from mapping.slam.tile_map import TileMaps
from mapping.slam.tile_map_kernels import MOST_VISITS, TILE_CELLS

EDGE = 0.1
ANCHOR = np.array([0.3, -0.7])
FULL_SHARE = 0.1

Array = NDArray[np.float64]
SlowMap = dict[tuple[int, int], list[float]]
"""Of each cell (column, row) from the anchor: visits, hits, sums of x and y of the hits in it."""


def slow_line(first: NDArray[np.int64], last: NDArray[np.int64]) -> list[tuple[int, int]]:
    """Cells one a step along the longer axis, the nearest to the line; a tie goes to the start."""
    apart = last - first
    count = int(np.max(np.abs(apart)))
    cells = []
    for k in range(count + 1):
        shift = [
            int(np.sign(d)) * -((count - 2 * abs(int(d)) * k) // (2 * max(count, 1))) for d in apart
        ]
        cells.append((int(first[0]) + shift[0], int(first[1]) + shift[1]))
    return cells


def slow_write(cells: SlowMap, pose: Array, origins: Array, ends: Array, hits: Array) -> None:
    cos, sin = np.cos(pose[2]), np.sin(pose[2])
    turn = np.array([[cos, -sin], [sin, cos]])
    for origin, end, hit in zip(origins, ends, hits, strict=True):
        first = (turn @ origin + pose[:2] - ANCHOR) / EDGE
        last = (turn @ end + pose[:2] - ANCHOR) / EDGE
        line = slow_line(np.floor(first).astype(int), np.floor(last).astype(int))
        for cell in line[:-1]:
            cells[cell][0] += 1
        if hit:
            x, y = last - np.floor(last)
            cells[line[-1]] = list(np.array(cells[line[-1]]) + [1, 1, x, y])


def contents(maps: TileMaps, particle: int) -> SlowMap:
    """What a particle's map holds, in the form of the slow one."""
    found: SlowMap = {}
    for tile_row, tile_column in np.argwhere(maps.tables[particle]):
        tile = maps.tables[particle, tile_row, tile_column]
        for y, x in np.argwhere(maps.visits[tile]):
            count = float(maps.hits[tile, y, x])
            mean = maps.means[tile, y, x].astype(float)
            column = int(maps.corner[0]) + int(tile_column) * TILE_CELLS + int(x)
            row = int(maps.corner[1]) + int(tile_row) * TILE_CELLS + int(y)
            visits = float(maps.visits[tile, y, x])
            found[column, row] = [visits, count, count * mean[0], count * mean[1]]
            full = bool(maps.full[tile, y] >> np.uint32(x) & np.uint32(1))
            assert full == (count > FULL_SHARE * visits)
    return found


def scan(rng: np.random.Generator) -> tuple[Array, Array, Array, NDArray[np.bool_]]:
    count = int(rng.integers(1, 6))
    pose = np.array([*rng.uniform(-4.0, 4.0, 2), rng.uniform(-np.pi, np.pi)])
    origins = rng.uniform(-0.2, 0.2, (count, 2))
    ends = rng.uniform(-5.0, 5.0, (count, 2))
    return pose, origins, ends, rng.random(count) < 0.7


def covered_write(maps: TileMaps, particle: int, beams: tuple[Array, ...]) -> None:
    maps.cover(-12.0, 12.0, -12.0, 12.0)
    pose, origins, ends, hits = beams
    maps.write(particle, pose, origins, ends, hits.astype(np.bool_))


def assert_equal_maps(found: SlowMap, expected: SlowMap) -> None:
    assert found.keys() == expected.keys()
    for cell, values in expected.items():
        assert np.allclose(found[cell], values, atol=1e-4), cell  # means are float32


@given(seed=st.integers(0, 10_000), steps=st.integers(1, 12))
@settings(max_examples=25, deadline=None)
def test_shared_maps_equal_maps_that_share_nothing(seed: int, steps: int) -> None:
    rng = np.random.default_rng(seed)
    particles = 4
    maps = TileMaps(particles, EDGE, ANCHOR, FULL_SHARE)
    slow: list[SlowMap] = [defaultdict(lambda: [0.0] * 4) for _ in range(particles)]
    maps.cover(0.0, 1.0, 0.0, 1.0)
    for _ in range(steps):
        if rng.random() < 0.3:
            parents = rng.integers(0, particles, particles)
            maps.resample(parents)
            slow = [deepcopy(slow[parent]) for parent in parents]
        else:
            particle, beams = int(rng.integers(particles)), scan(rng)
            covered_write(maps, particle, beams)
            slow_write(slow[particle], *beams)
    for particle in range(particles):
        assert_equal_maps(contents(maps, particle), slow[particle])


@given(seed=st.integers(0, 10_000), steps=st.integers(1, 30))
@settings(max_examples=25, deadline=None)
def test_every_tile_is_either_free_or_counted_as_often_as_it_is_used(seed: int, steps: int) -> None:
    rng = np.random.default_rng(seed)
    maps = TileMaps(5, EDGE, ANCHOR, FULL_SHARE)
    for _ in range(steps):
        covered_write(maps, int(rng.integers(5)), scan(rng))
        if rng.random() < 0.5:
            maps.resample(rng.integers(0, 5, 5))
        uses = np.bincount(maps.tables.ravel(), minlength=len(maps.references))
        assert np.array_equal(maps.references[1:], uses[1:])
        assert maps.tiles_used == np.count_nonzero(uses[1:])


def test_writing_to_one_particles_map_changes_no_other() -> None:
    rng = np.random.default_rng(0)
    maps = TileMaps(3, EDGE, ANCHOR, FULL_SHARE)
    first = scan(rng)
    covered_write(maps, 0, first)
    maps.resample(np.zeros(3, dtype=np.int64))
    tiles, before = maps.tiles_used, contents(maps, 0)
    covered_write(maps, 1, first)
    assert contents(maps, 0) == before == contents(maps, 2)
    assert contents(maps, 1) != before
    assert maps.tiles_used > tiles


def test_children_share_every_tile_until_they_are_written() -> None:
    maps = TileMaps(50, EDGE, ANCHOR, FULL_SHARE)
    covered_write(maps, 0, scan(np.random.default_rng(0)))
    tiles = maps.tiles_used
    maps.resample(np.zeros(50, dtype=np.int64))
    assert maps.tiles_used == tiles


def test_a_map_that_grows_to_the_left_and_below_keeps_its_cells() -> None:
    maps = TileMaps(1, EDGE, ANCHOR, FULL_SHARE)
    maps.cover(-1.0, 1.0, -1.0, 1.0)
    origin, end = np.zeros((1, 2)), np.array([[0.5, 0.2]])
    maps.write(0, np.zeros(3), origin, end, np.array([True]))
    before = contents(maps, 0)
    maps.cover(-30.0, 1.0, -40.0, 1.0)
    assert contents(maps, 0) == before
    pose = np.array([-25.0, -35.0, 1.0])
    assert np.allclose(maps.in_map(maps.in_cells(pose)), pose)


def test_a_cell_seen_very_often_keeps_its_share_of_hits() -> None:
    maps = TileMaps(1, EDGE, (0.0, 0.0), FULL_SHARE)
    maps.cover(0.0, 1.0, 0.0, 1.0)
    beams = np.full((2, 2), 0.55), np.array([[0.55, 0.55], [0.75, 0.55]])
    tile = None
    for _ in range(3):
        maps.write(0, np.zeros(3), *beams, np.array([True, False]))
        tile = int(maps.tables[0].max())
        y, x = np.argwhere(maps.hits[tile])[0]
        maps.visits[tile, y, x], maps.hits[tile, y, x] = MOST_VISITS, MOST_VISITS // 2
    maps.write(0, np.zeros(3), *beams, np.array([True, False]))
    seen, met = int(maps.visits[tile, y, x]), int(maps.hits[tile, y, x])
    assert MOST_VISITS // 2 <= seen < MOST_VISITS
    assert abs(met / seen - 0.5) < 1e-3
    assert np.allclose(maps.means[tile, y, x], 0.5, atol=1e-3)


def test_a_map_is_drawn_onto_a_grid_of_another_place_and_size() -> None:
    maps = TileMaps(1, EDGE, (0.0, 0.0), FULL_SHARE)
    maps.cover(-2.0, 5.0, -2.0, 5.0)
    maps.write(
        0, np.array([0.05, 0.05, 0.0]), np.zeros((1, 2)), np.array([[1.0, 0.0]]), np.array([True])
    )
    grid = OccupancyGrid(
        GridConfig(resolution=EDGE, origin=(0.2, -0.3), rows=6, columns=12, grows=False)
    )
    maps.draw(0, np.ones(maps.tables.shape[1:], dtype=np.bool_), grid, 0.25, 4.0, -4.0)
    expected = np.full((6, 12), UNKNOWN)
    expected[3, :8], expected[3, 8] = FREE, OCCUPIED  # x from 0.2 to 1.0, the wall in 1.0 to 1.1
    assert np.array_equal(grid.states(), expected)
