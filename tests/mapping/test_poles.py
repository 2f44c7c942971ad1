"""Poles: legs of chairs and tables in the finished map."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from mapping.geometry import Pose
from mapping.grid import FREE, OCCUPIED, UNKNOWN, OccupancyGrid
from mapping.messages import LaserScan
from mapping.poles import PoleFinder
from mapping.surface_refinement import SurfaceRefinement
from tests.mapping.finished_maps import CONFIG, GRID, ROOM, TOUR, aimed, mapped, scans_in
from tests.mapping.slam.rooms import Walls, box, post

HALL = box(-2.6, 2.6, -2.6, 2.6)

ROUND = np.array([(1.9 * np.cos(a), 1.9 * np.sin(a), 2.0 * a) for a in np.linspace(0.0, 6.0, 40)])
"""Around the middle of the hall at 1.9 m: a leg of 3 cm in it is met by one beam of a scan, at
best two."""


def with_posts(walls: Walls, *posts: tuple[float, float, float]) -> Walls:
    """Walls with posts at x, y [m] of a radius [m]."""
    return np.concatenate((walls, *(post(*each) for each in posts)))


def finished(scans: list[LaserScan], poses: Pose) -> tuple[OccupancyGrid, OccupancyGrid]:
    """The map with its surfaces moved, and the same with poles."""
    without = mapped(scans, poses)
    refinement, finder = SurfaceRefinement(without, CONFIG), PoleFinder()
    for beams in aimed(scans, poses):
        refinement.add(beams)
        finder.spot(beams)
    refinement.write()
    grid = without.copy()
    finder.gather()
    for beams in aimed(scans, poses):
        finder.look(beams)
    finder.write(grid, CONFIG)
    return without, grid


def inside(grid: OccupancyGrid, half: float) -> NDArray[np.float64]:
    """The occupied cells' centres ``(n, 2)`` within a square around the origin."""
    centres = grid.cell_to_world(np.argwhere(grid.states() == OCCUPIED))
    near: NDArray[np.float64] = centres[np.abs(centres).max(axis=1) < half]
    return near


def test_legs_that_cells_lose_are_found() -> None:
    legs = [(0.25, 0.25, 0.015), (-0.25, 0.25, 0.015), (-0.25, -0.25, 0.015), (0.25, -0.25, 0.015)]
    without, grid = finished(scans_in(with_posts(HALL, *legs), ROUND), ROUND)
    for x, y, _ in legs:
        for drawn, found in ((without, False), (grid, True)):
            gaps = np.linalg.norm(inside(drawn, 1.0) - (x, y), axis=1)
            assert np.any(gaps < 0.03) == found
    gaps = [np.linalg.norm(inside(grid, 1.0) - leg[:2], axis=1) for leg in legs]
    assert np.all(np.min(gaps, axis=0) < 0.04)


@settings(max_examples=15, deadline=None)
@given(
    x=st.floats(-0.6, 0.6),
    y=st.floats(-0.6, 0.6),
    radius=st.floats(0.012, 0.04),
    seed=st.integers(0, 99),
)
def test_a_pole_is_drawn_where_it_stands_and_as_thick_as_it_is(
    x: float, y: float, radius: float, seed: int
) -> None:
    poses = np.concatenate((ROUND, 0.7 * ROUND))
    poses = poses[np.hypot(poses[:, 0] - x, poses[:, 1] - y) > 0.15]
    _, grid = finished(scans_in(with_posts(HALL, (x, y, radius)), poses, seed), poses)
    cells = inside(grid, 1.0)
    assert len(cells) > 0
    assert cells.mean(axis=0) == pytest.approx([x, y], abs=0.012)
    assert 2.0 * np.sqrt(len(cells) / np.pi) * 0.01 == pytest.approx(2.0 * radius, abs=0.015)


def test_an_empty_room_has_none() -> None:
    for walls, poses in ((ROOM, TOUR), (HALL, ROUND)):
        without, grid = finished(scans_in(walls, poses), poses)
        assert np.array_equal(without.log_odds, grid.log_odds)


def test_no_scans_draw_nothing() -> None:
    without, grid = finished([], np.zeros((0, 3)))
    assert np.array_equal(without.log_odds, grid.log_odds)


def test_a_pole_that_was_carried_away_is_none() -> None:
    poses = np.concatenate((ROUND, ROUND[:15]))
    scans = scans_in(with_posts(HALL, (0.3, 0.0, 0.02)), ROUND) + scans_in(HALL, ROUND[:15], 1)
    _, grid = finished(scans, poses)
    assert len(inside(grid, 1.0)) == 0


def test_a_pole_that_was_put_up_late_is_one() -> None:
    poses = np.concatenate((ROUND, ROUND))
    scans = scans_in(HALL, ROUND) + scans_in(with_posts(HALL, (0.3, 0.0, 0.02)), ROUND, 1)
    _, grid = finished(scans, poses)
    assert np.any(np.linalg.norm(inside(grid, 1.0) - (0.3, 0.0), axis=1) < 0.02)


def test_who_walks_by_the_same_place_again_and_again_is_none() -> None:
    """A leg in three scans of nine, the last ones too."""
    poses = np.concatenate((ROUND, ROUND))[:72]
    taken, left = with_posts(HALL, (0.3, 0.0, 0.04)), HALL
    scans = [
        scans_in(taken if k % 9 > 5 else left, poses[k : k + 1], seed=k)[0]
        for k in range(len(poses))
    ]
    _, grid = finished(scans, poses)
    assert len(inside(grid, 1.0)) == 0


def found_alone(scans: list[LaserScan], poses: Pose, drawn: OccupancyGrid) -> NDArray[np.bool_]:
    """The cells that poles change in a map that the scans did not draw."""
    finder, before = PoleFinder(), drawn.log_odds.copy()
    for beams in aimed(scans, poses):
        finder.spot(beams)
    finder.gather()
    for beams in aimed(scans, poses):
        finder.look(beams)
    finder.write(drawn, CONFIG)
    changed: NDArray[np.bool_] = drawn.log_odds != before
    return changed


def test_the_end_of_a_wall_is_none() -> None:
    """Seen along the wall it stands alone, but mostly the wall is seen beside it."""
    wall = np.concatenate((HALL, box(0.0, 2.6, -0.04, 0.04)))
    assert not np.any(found_alone(scans_in(wall, ROUND), ROUND, OccupancyGrid(GRID)))


def test_nothing_is_drawn_over_what_the_map_shows_of_a_wall() -> None:
    scans = scans_in(with_posts(HALL, (0.0, 0.0, 0.02)), ROUND)
    blank, walled = OccupancyGrid(GRID), OccupancyGrid(GRID)
    walled.log_odds[306, 290:310] = CONFIG.highest  # 20 cm long, 6 cm beside the pole
    assert np.any(found_alone(scans, ROUND, blank))
    assert not np.any(found_alone(scans, ROUND, walled))


def test_the_corners_of_a_box_are_none() -> None:
    walls = np.concatenate((HALL, box(-0.3, 0.3, -0.2, 0.2)))
    without, grid = finished(scans_in(walls, ROUND), ROUND)
    assert np.array_equal(without.log_odds, grid.log_odds)


def test_a_pole_whose_readings_scatter_wide_is_one() -> None:
    """Poses that are off by 4 cm carry some of them farther from the rest than a pole is thick."""
    rng = np.random.default_rng(4)
    poses = np.concatenate((ROUND, 0.8 * ROUND, 0.6 * ROUND))
    believed = poses + np.column_stack(
        (rng.normal(0.0, 0.04, (len(poses), 2)), np.zeros(len(poses)))
    )
    scans = scans_in(with_posts(HALL, (0.0, 0.0, 0.015)), poses)
    cells = np.argwhere(found_alone(scans, believed, OccupancyGrid(GRID)))
    assert len(cells) > 0
    assert np.ptp(cells, axis=0).max() < 7


def test_what_is_thicker_than_a_pole_is_left_to_the_cells() -> None:
    scans = scans_in(with_posts(HALL, (0.0, 0.0, 0.075)), ROUND)
    assert not np.any(found_alone(scans, ROUND, OccupancyGrid(GRID)))


def test_a_pole_seen_from_one_side_is_drawn_behind_where_beams_met_it() -> None:
    poses = np.column_stack((np.linspace(-0.3, 0.3, 40), np.full(40, -1.0), np.zeros(40)))
    scans = scans_in(with_posts(HALL, (0.0, 0.0, 0.04)), poses)
    grid = OccupancyGrid(GRID)
    found_alone(scans, poses, grid)
    assert inside(grid, 1.0).mean(axis=0) == pytest.approx([0.0, 0.0], abs=0.012)


def test_specks_around_a_leg_give_way_to_its_disc() -> None:
    grid = OccupancyGrid(GRID)
    grid.log_odds[295:305, 305] = [0.0, 5.0] * 5
    scans = scans_in(with_posts(HALL, (0.0, 0.0, 0.015)), ROUND)
    found_alone(scans, ROUND, grid)
    assert np.all(np.linalg.norm(inside(grid, 0.3), axis=1) < 0.025)
    assert set(grid.states()[295:305, 305].tolist()) == {UNKNOWN, FREE}
