import numpy as np
import pytest

from mapping.burger import LIDAR_RANGE_MAX
from mapping.geometry import Pose, between, compose
from mapping.grid import OCCUPIED, GridConfig, OccupancyGrid
from mapping.ogm import OgmConfig
from mapping.sensor_model import read_beams
from mapping.slam.keyframe_graph import KeyframeGraph
from mapping.slam.map_painter import MapPainter
from mapping.slam.sweep import Sweep, make_sweep
from tests.mapping.slam.rooms import cloud_of, random_room, scan_of

ROOM = random_room(np.random.default_rng(5))
GRID = GridConfig(resolution=0.02, origin=(-4.0, -4.0), rows=400, columns=400)
POSES = np.array([(-0.3, 0.0, 0.0), (-0.1, 0.1, 0.7), (0.1, 0.1, 1.5), (0.3, 0.0, 2.5)])
BENT = compose(POSES, np.outer(np.arange(4.0), (0.05, -0.02, 0.03)))
"""Where an optimiser says that they are: the later, the farther off."""


def sweep_at(pose: Pose) -> Sweep:
    scan = scan_of(ROOM, pose)
    beams = read_beams(scan, LIDAR_RANGE_MAX)
    return make_sweep(scan, beams, np.zeros((len(beams.indices), 3)))


def painted(places: Pose = POSES, seen: Pose = POSES) -> tuple[MapPainter, KeyframeGraph]:
    """A painter with keyframes, three scans drawn and kept of each.

    Args:
        places: Where the keyframes are thought to be ``(n, 3)``.
        seen: Where they were really taken ``(n, 3)``.
    """
    graph = KeyframeGraph()
    painter = MapPainter(OccupancyGrid(GRID), OgmConfig(), graph)
    for number, (place, true) in enumerate(zip(places, seen, strict=True)):
        graph.add(place, cloud_of(scan_of(ROOM, true)))
        add_scans(painter, number, place, true)
    return painter, graph


def add_scans(painter: MapPainter, keyframe: int, place: Pose, true: Pose) -> None:
    for step in range(3):
        ahead = (0.05 * step, 0.0, 0.0)
        sweep, pose = sweep_at(compose(true, ahead)), compose(place, ahead)
        painter.paint(sweep, painter.to_map(keyframe, pose))
        painter.keep(keyframe, pose, sweep)


@pytest.mark.parametrize("sweeps", [1, 5, 12])
def test_a_redraw_in_steps_gives_the_bytes_of_a_redraw_at_once(sweeps: int) -> None:
    grids = []
    for each in (sweeps, 1000):
        painter, graph = painted()
        graph.correct(BENT)
        painter.redraw()
        while painter.is_redrawing:
            assert painter.grid.redraws == 0
            painter.work(each)
        grids.append(painter.grid)
    assert grids[0].redraws == grids[1].redraws == 1
    assert grids[0].log_odds.tobytes() == grids[1].log_odds.tobytes()
    assert np.array_equal(grids[0].origin, grids[1].origin)


def test_a_redrawn_map_is_the_one_drawn_from_the_corrected_poses() -> None:
    painter, graph = painted()
    graph.correct(BENT)
    painter.redraw()
    painter.work(len(painter))
    true, _ = painted(BENT)
    assert np.mean(painter.grid.states() != true.grid.states()) < 1e-4  # rounded otherwise


def test_until_the_redraw_is_done_pose_and_map_stay_as_they_were() -> None:
    painter, graph = painted()
    robot = compose(POSES[3], (0.1, 0.05, 0.2))
    drawn, before = painter.grid.log_odds.copy(), painter.to_map(3, robot)
    place = between(graph.poses[3], robot)
    graph.correct(BENT)
    robot = compose(graph.poses[3], place)
    assert painter.to_map(3, robot) == pytest.approx(before)
    painter.redraw()
    for _ in range(2):
        painter.work(5)
        assert painter.is_redrawing
        assert np.array_equal(painter.grid.log_odds, drawn)
        assert painter.to_map(3, robot) == pytest.approx(before)
    painter.work(5)
    assert not painter.is_redrawing
    assert painter.to_map(3, robot) == pytest.approx(robot)


def test_scans_that_come_during_a_redraw_are_in_both_maps() -> None:
    painter, graph = painted()
    graph.correct(BENT)
    painter.redraw()
    painter.work(5)
    new = compose(BENT[3], (-0.3, 0.1, 0.5))
    graph.add(new, cloud_of(scan_of(ROOM, new)))
    old_frame = painter.to_map(4, new)
    # it lies from the last keyframe as it does in the corrected graph, in the old map
    expected = between(BENT[3], new)
    assert between(painter.to_map(3, BENT[3]), old_frame) == pytest.approx(expected)
    before = painter.grid.log_odds.copy()
    add_scans(painter, 4, new, new)
    assert not np.array_equal(painter.grid.log_odds, before)
    while painter.is_redrawing:
        painter.work(5)
    whole, _ = painted(np.vstack((BENT, new)), np.vstack((POSES, new)))
    assert np.mean(painter.grid.states() != whole.grid.states()) < 1e-4
    assert painter.to_map(4, new) == pytest.approx(new)


def test_the_error_is_how_far_keyframes_are_drawn_from_their_places() -> None:
    painter, graph = painted()
    assert painter.error == 0.0
    graph.correct(POSES + [0.0, 0.3, 0.0])
    assert painter.error == pytest.approx(0.3)
    graph.correct(BENT)
    assert painter.error >= np.max(np.hypot(*(BENT - POSES)[:, :2].T))
    painter.redraw()
    painter.work(1000)
    assert painter.error == pytest.approx(0.0, abs=1e-12)


def test_refining_puts_walls_where_the_corrected_poses_saw_them() -> None:
    painter, graph = painted()
    moved = compose(np.array([0.012, -0.008, 0.0]), POSES)
    graph.correct(moved)
    painter.refine()
    assert painter.grid.redraws == 1
    assert painter.error == pytest.approx(0.0, abs=1e-12)
    true, _ = painted(moved)
    true.refine()
    seen = painter.grid.states() == OCCUPIED
    assert np.count_nonzero(seen & (true.grid.states() == OCCUPIED)) > 0.9 * np.count_nonzero(seen)


def test_work_without_a_redraw_changes_nothing() -> None:
    painter, _ = painted()
    before = painter.grid.log_odds.copy()
    painter.work(100)
    assert np.array_equal(painter.grid.log_odds, before)
    assert painter.grid.redraws == 0


def test_a_map_without_keyframes_has_no_error() -> None:
    graph = KeyframeGraph()
    assert MapPainter(OccupancyGrid(GRID), OgmConfig(), graph).error == 0.0


def test_a_map_in_another_metre_is_the_map_grown_about_its_first_keyframe() -> None:
    painter, graph = painted()
    before = occupied_places(painter.grid)
    painter.scale = 1.05
    assert painter.error > 0.02
    painter.redraw()
    painter.work(len(painter))
    assert painter.error == pytest.approx(0.0, abs=1e-9)
    anchor = graph.poses[0, :2]
    after = occupied_places(painter.grid)
    wanted = anchor + 1.05 * (before - anchor)
    apart = np.array([np.hypot(*(after - place).T).min() for place in wanted[::7]])
    assert np.percentile(apart, 95) < 0.03
    ahead = compose(graph.poses[3], (0.1, 0.0, 0.0))
    grown_there = anchor + 1.05 * (ahead[:2] - anchor)
    assert painter.to_map(3, ahead)[:2] == pytest.approx(grown_there)
    assert painter.corrected(ahead[None])[0, :2] == pytest.approx(grown_there)


def occupied_places(grid: OccupancyGrid) -> np.ndarray:
    cells = np.argwhere(grid.states() == OCCUPIED)
    return np.asarray(grid.cell_to_world(cells))
