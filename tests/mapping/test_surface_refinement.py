from dataclasses import replace

import numpy as np
import pytest

from mapping.geometry import Pose
from mapping.grid import FREE, OCCUPIED, UNKNOWN, OccupancyGrid
from mapping.messages import LaserScan
from mapping.surface_refinement import WALL, SurfaceRefinement
from tests.mapping.finished_maps import CONFIG, GRID, ROOM, TOUR, aimed, mapped, scans_in
from tests.mapping.slam.rooms import box, post


def refined(grid: OccupancyGrid, scans: list[LaserScan], poses: Pose) -> OccupancyGrid:
    """A copy of a map, refined."""
    copy = grid.copy()
    refinement = SurfaceRefinement(copy, CONFIG)
    for beams in aimed(scans, poses):
        refinement.add(beams)
    refinement.write()
    return copy


def state_at(grid: OccupancyGrid, x: float, y: float) -> int:
    row, column = grid.world_to_cell([x, y])
    return int(grid.states()[row, column])


def wrong_share(grid: OccupancyGrid, band: float) -> float:
    """Share of the cells within ``band`` [m] inside ROOM's walls that are not free."""
    x, y = np.moveaxis(grid.cell_to_world(np.argwhere(np.ones(grid.shape))), -1, 0)
    inside = np.minimum(1.604 - np.abs(x), 1.204 - np.abs(y))
    near = ((inside > 0.0) & (inside < band)).reshape(grid.shape)
    return float(np.mean(grid.states()[near] != FREE))


def test_a_noisy_wall_comes_to_stand_where_it_is_to_a_fraction_of_a_cell() -> None:
    poses = TOUR[::4]
    scans = scans_in(ROOM, poses)
    grid = mapped(scans, poses)
    better = refined(grid, scans, poses)
    assert wrong_share(grid, 0.02) > 0.05  # else there is nothing to mend
    assert wrong_share(better, 0.02) < 0.01
    cells = grid.cell_to_world(np.argwhere(better.states() == OCCUPIED))
    depth = -np.minimum(1.604 - np.abs(cells[:, 0]), 1.204 - np.abs(cells[:, 1]))
    assert np.percentile(depth, 2) > -0.006
    assert np.percentile(depth, 98) < (WALL + 1.0) * 0.01
    # hardly with a gap, along the whole left wall
    right = grid.world_to_cell([-1.55, 0.0])[1]
    shut = [np.any(each.states()[185:415, :right] == OCCUPIED, axis=1) for each in (grid, better)]
    assert np.mean(shut[0]) < 0.9
    assert np.mean(shut[1]) > 0.97


def test_a_thin_wall_is_kept_between_its_two_faces() -> None:
    thin = np.concatenate((ROOM, box(-0.02, 0.02, -1.3, 0.5)))
    poses = np.array([(x, y, 0.0) for x in (-0.8, -0.5, 0.5, 0.8) for y in np.linspace(-0.6, 0, 8)])
    scans = scans_in(thin, poses)
    better = refined(mapped(scans, poses), scans, poses)
    for y in np.arange(-0.8, 0.2, 0.01):
        row = better.states()[better.world_to_cell([0.0, y])[0]]
        left, right = better.world_to_cell([[-0.1, y], [0.1, y]])[:, 1]
        walls = np.flatnonzero(row[left:right] == OCCUPIED)
        assert len(walls) > 0
        assert walls.min() >= 7
        assert walls.max() <= 12  # its cells are the 9th to 12th, a cell more for noise
        assert row[left] == row[right] == FREE


def test_a_leg_that_single_beams_hit_stays() -> None:
    leg = np.concatenate((ROOM, post(0.3, 0.3, 0.015)))
    scans = scans_in(leg, TOUR)
    grid = mapped(scans, TOUR)
    better = refined(grid, scans, TOUR)
    near = better.world_to_cell([[0.27, 0.27], [0.33, 0.33]])
    (bottom, left), (top, right) = near
    occupied = np.count_nonzero(better.states()[bottom:top, left:right] == OCCUPIED)
    assert 2 <= occupied <= 16  # its area is that of 7 cells


def test_who_has_left_stays_gone() -> None:
    poses = np.repeat(TOUR, 2, axis=0)
    person = np.concatenate((ROOM, post(0.0, 1.0, 0.06)))
    scans = scans_in(person, poses[:40]) + scans_in(ROOM, poses[40:], seed=1)
    better = refined(mapped(scans, poses), scans, poses)
    assert state_at(better, 0.0, 0.95) == FREE
    assert state_at(better, 0.0, 1.0) == FREE


def test_what_came_late_stays() -> None:
    came = np.concatenate((ROOM, box(0.2, 0.5, 0.1, 0.4)))
    poses = np.concatenate((TOUR, np.tile((0.0, -0.3, 0.0), (6, 1))))
    scans = scans_in(ROOM, TOUR) + scans_in(came, poses[len(TOUR) :], seed=1)
    grid = mapped(scans, poses)
    better = refined(grid, scans, poses)
    # the side that was seen is closed but for a cell or two
    states = better.states()
    (bottom, left), (_, right) = grid.world_to_cell([(0.19, 0.08), (0.51, 0.41)])
    front = np.any(states[bottom : bottom + 6, left + 1 : right - 1] == OCCUPIED, axis=0)
    assert np.count_nonzero(grid.states()[bottom : bottom + 6, left:right] == OCCUPIED) > 20
    assert np.mean(front) > 0.85


def test_what_was_drawn_behind_a_wall_before_poses_were_right_goes() -> None:
    poses = np.tile((-0.5, 0.0, 0.0), (20, 1))
    scans = scans_in(ROOM, poses)
    drawn_at = poses.copy()
    drawn_at[:10, 0] += 0.05
    grid = mapped(scans, drawn_at)

    def behind(drawn: OccupancyGrid) -> int:
        cells = drawn.cell_to_world(np.argwhere(drawn.states() == OCCUPIED))
        return int(np.count_nonzero((cells[:, 0] > 1.64) & (cells[:, 0] < 1.70)))

    assert behind(grid) > 40
    assert behind(refined(grid, scans, poses)) < behind(grid) / 5


def test_a_clockwise_scan_tells_the_same() -> None:
    scans = scans_in(ROOM, TOUR)
    turned = [
        replace(
            scan,
            ranges=scan.ranges[::-1].copy(),
            angle_min=scan.angle_min + 359 * scan.angle_increment,
            angle_increment=-scan.angle_increment,
        )
        for scan in scans
    ]
    grid = mapped(scans, TOUR)
    one, other = refined(grid, scans, TOUR), refined(grid, turned, TOUR)
    assert np.mean(one.states() != other.states()) < 1e-4  # summed otherwise


def test_beams_without_a_return_draw_no_wall() -> None:
    scan = LaserScan(stamp=0.0, ranges=np.full(360, np.inf, dtype=np.float32))
    poses = np.zeros((6, 3))
    better = refined(mapped([scan] * 6, poses), [scan] * 6, poses)
    assert not np.any(better.states() == OCCUPIED)


@pytest.mark.parametrize("scans", [0, 3])
def test_an_empty_map_stays_empty(scans: int) -> None:
    empty = OccupancyGrid(GRID)
    better = refined(empty, scans_in(ROOM, TOUR[:scans]), TOUR[:scans])
    assert np.all(better.states() == UNKNOWN)
    assert better.redraws == 1
