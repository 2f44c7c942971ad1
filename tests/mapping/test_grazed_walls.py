"""Walls that were only seen at a grazing angle."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from mapping.geometry import Pose
from mapping.grazed_walls import GrazedWalls, close_at
from mapping.grid import FREE, OCCUPIED, UNKNOWN, OccupancyGrid
from mapping.messages import LaserScan
from mapping.surface_refinement import SurfaceRefinement
from tests.mapping.finished_maps import CONFIG, GRID, aimed, mapped, scans_in
from tests.mapping.slam.rooms import box


def finished(scans: list[LaserScan], poses: Pose) -> tuple[OccupancyGrid, OccupancyGrid]:
    """The map with its surfaces moved, and the same with grazed walls closed."""
    without = mapped(scans, poses)
    refinement, grazed = SurfaceRefinement(without, CONFIG), GrazedWalls(without)
    for beams in aimed(scans, poses):
        refinement.add(beams)
        grazed.add(beams)
    refinement.write()
    before = without.copy()
    grazed.write(CONFIG)
    return before, without


def open_cells(grid: OccupancyGrid) -> int:
    """How many unknown cells share an edge with a free one."""
    states = np.pad(grid.states(), 1, constant_values=OCCUPIED)
    free, beside = states == FREE, np.zeros(states.shape, dtype=np.bool_)
    for axis in (0, 1):
        for step in (-1, 1):
            beside |= np.roll(free, step, axis)
    return int(np.count_nonzero(beside & (states == UNKNOWN)))


def test_the_walls_of_a_narrow_passage_are_closed() -> None:
    passage = box(-9.0, 9.0, -0.15, 0.15)
    poses = np.column_stack((np.linspace(-0.2, 0.2, 8), np.zeros(8), np.zeros(8)))
    before, after = finished(scans_in(passage, poses), poses)
    assert open_cells(after) < 0.5 * open_cells(before)
    new = after.cell_to_world(np.argwhere(after.states() != before.states()))
    assert np.all(np.abs(np.abs(new[:, 1]) - 0.15) < 0.03)
    assert np.array_equal(before.states() == FREE, after.states() == FREE)


def test_where_no_reading_ended_the_edge_of_the_unknown_stays_open() -> None:
    """The lidar sees 3.5 m far in a hall without walls."""
    scan = LaserScan(stamp=0.0, ranges=np.full(360, np.inf, dtype=np.float32))
    poses = np.zeros((4, 3))
    before, after = finished([scan] * 4, poses)
    assert open_cells(before) > 100
    assert np.array_equal(before.log_odds, after.log_odds)


def test_readings_beyond_a_grid_that_does_not_grow_are_left_out() -> None:
    poses = np.array([(2.9, 0.0, 0.0)] * 3)
    grid, (beams, *_) = OccupancyGrid(GRID), aimed(scans_in(box(-2, 5, -2, 2), poses), poses)
    grazed = GrazedWalls(grid)
    grazed.add(beams)
    grazed.write(CONFIG)
    assert np.all(grid.states() == UNKNOWN)  # nothing beside it is free


@given(seed=st.integers(0, 10_000))
def test_it_is_what_the_plain_rule_says(seed: int) -> None:
    rng = np.random.default_rng(seed)
    shape = (int(rng.integers(1, 9)), int(rng.integers(1, 9)))
    log_odds = rng.choice([-5.0, -1.0, 0.0, 1.0, 5.0], shape).astype(np.float32)
    ends = np.argwhere(rng.random(shape) < 0.2)
    free, unknown = log_odds < -3.0, np.abs(log_odds) <= 3.0
    expected = log_odds.copy()
    for row, column in np.argwhere(unknown):
        beside = [(row - 1, column), (row + 1, column), (row, column - 1), (row, column + 1)]
        inside = [cell for cell in beside if 0 <= cell[0] < shape[0] and 0 <= cell[1] < shape[1]]
        near = len(ends) and np.abs(ends - (row, column)).max(axis=1).min() <= 1
        if near and any(free[cell] for cell in inside):
            expected[row, column] = 7.0
    close_at(log_odds, ends, -3.0, 3.0, 7.0)
    assert np.array_equal(log_odds, expected)
