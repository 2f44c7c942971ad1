"""What both mappers that match scans must do: ``scan_match``, and ``graph`` before any loop."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray

from mapping.errors import TestbedError
from mapping.geometry import between, compose
from mapping.grid import FREE, OCCUPIED, UNKNOWN, GridConfig
from mapping.mapper import Mapper
from mapping.slam.graph_slam import GraphConfig, GraphSlam
from mapping.slam.scan_match import ScanMatch
from mapping.slam.scan_match_config import ScanMatchConfig
from tests.mapping.slam.rooms import RING_WAY, Period, Run, corridor, drive, fed, mirrored, ring

EDGE = 0.02
GRID = GridConfig(resolution=EDGE, origin=(-6.0, -6.0), rows=600, columns=600, grows=False)
MAPPERS: list[Callable[..., Mapper]] = [ScanMatch, GraphSlam]
BOTH = pytest.mark.parametrize("make", MAPPERS)
ALIKE = 0.97
"""Share of the cells known in one of two maps that must be alike: the rest lies at walls, 2 cm
cells of which are free or taken by millimetres."""


@pytest.fixture(scope="module")
def run() -> Run:
    """A part of the ring, around two corners, with bad odometry."""
    way = [RING_WAY[0], (2.2, -1.9), (2.9, -1.9), (2.9, 0.0)]
    return drive(ring(), way, np.random.default_rng(3), scale=0.03, drift=0.04)


def errors(mapper: Mapper, run: Run) -> NDArray[np.float64]:
    """How far off each pose of the trajectory is ``(n, 3)``."""
    assert mapper.trajectory.stamps.tolist() == [scan.stamp for scan, _ in run.periods if scan]
    return between(run.truth, mapper.trajectory.poses)


def alike(states: NDArray[np.int8], other: NDArray[np.int8]) -> float:
    """Share of the cells that either map knows in which they are the same."""
    known = (states != UNKNOWN) | (other != UNKNOWN)
    return float(np.mean(states[known] == other[known]))


@BOTH
def test_a_drive_with_bad_odometry_is_mapped_where_it_was(
    make: Callable[..., Mapper], run: Run
) -> None:
    mapper = fed(make(start_pose_map=run.start, grid=GRID), run.periods)
    off = errors(mapper, run)
    odometry_off = between(run.truth[-1], run.odometry_end)
    assert np.hypot(*odometry_off[:2]) > 0.25  # else nothing is shown
    # a cell of the field
    assert np.max(np.hypot(off[:, 0], off[:, 1])) < 0.03
    assert np.max(np.abs(off[:, 2])) < 0.01
    assert mapper.updates == len(run.periods)
    assert mapper.scans_dropped == 0


@BOTH
def test_walls_are_drawn_where_they_are(make: Callable[..., Mapper], run: Run) -> None:
    mapper = fed(make(start_pose_map=run.start, grid=GRID), run.periods)
    states, grid = mapper.grid.states(), mapper.grid
    x = np.arange(-2.5, 0.9, EDGE)
    walls = grid.world_to_cell(np.column_stack((x, np.full_like(x, -2.5))))
    near = [states[walls[:, 0] + k, walls[:, 1]] == OCCUPIED for k in (-2, -1, 0, 1, 2)]
    # behind the pillar a piece of 20 cm is seen from a few places only
    assert np.mean(np.any(near, axis=0)) > 0.9
    along = grid.world_to_cell(run.truth[:, :2])
    assert np.all(states[along[:, 0], along[:, 1]] == FREE)


@BOTH
@pytest.mark.parametrize("quarters", [1, 2, 3])
def test_quarter_turns_and_whole_cells_turn_and_shift_path_and_map(
    make: Callable[..., Mapper], run: Run, quarters: int
) -> None:
    # the field's cells and the map's lie on each other again
    turn = np.array([0.6, -1.2, quarters * np.pi / 2.0])
    here = fed(make(start_pose_map=run.start, grid=GRID), run.periods)
    there = fed(make(start_pose_map=compose(turn, run.start), grid=GRID), run.periods)
    off = between(compose(turn, here.trajectory.poses), there.trajectory.poses)
    # the climb ends within a thousandth of a cell and points on edges of cells fall to either side
    away = np.hypot(*(run.truth[:, :2] - run.start[:2]).T)
    assert np.all(np.hypot(off[:, 0], off[:, 1]) < 0.01 + GraphConfig().scale_step * away)
    assert np.max(np.abs(off[:, 2])) < 0.005
    rotated = np.rot90(here.grid.states(), -quarters)
    shift = round(turn[1] / EDGE), round(turn[0] / EDGE)
    assert alike(np.roll(rotated, shift, axis=(0, 1)), there.grid.states()) > ALIKE


@BOTH
def test_any_turn_and_shift_turns_and_shifts_the_path(
    make: Callable[..., Mapper], run: Run
) -> None:
    turn = np.array([0.613, -1.207, 0.6])
    here = fed(make(start_pose_map=run.start, grid=GRID), run.periods)
    there = fed(make(start_pose_map=compose(turn, run.start), grid=GRID), run.periods)
    off = between(compose(turn, here.trajectory.poses), there.trajectory.poses)
    # cells lie elsewhere on the walls and walls between other sides: the scans' noise is weighed
    # otherwise, and both paths have errors of up to a cell of the field
    assert np.max(np.hypot(off[:, 0], off[:, 1])) < 0.03
    assert np.max(np.abs(off[:, 2])) < 0.01


@pytest.mark.parametrize("heading", [0.0, 0.8, np.pi / 2.0, -2.5])
def test_a_bare_corridor_teaches_nothing_about_the_scale_of_ways(heading: float) -> None:
    run = drive(corridor(), [(-6.0, 0.0), (6.0, 0.0)], np.random.default_rng(3))
    mapper = fed(ScanMatch(start_pose_map=(0.0, 0.0, heading)), run.periods)
    told, variance = mapper.way_disagreement
    assert abs(told) < 0.002
    assert variance == pytest.approx(ScanMatchConfig().calibration.scale_sigma ** 2, rel=0.1)


@BOTH
def test_a_mirrored_world_gives_the_mirrored_path_and_map(
    make: Callable[..., Mapper], run: Run
) -> None:
    flip = np.array([1.0, -1.0, -1.0])
    here = fed(make(start_pose_map=run.start, grid=GRID), run.periods)
    there = fed(make(start_pose_map=run.start * flip, grid=GRID), mirrored(run.periods))
    off = between(here.trajectory.poses * flip, there.trajectory.poses)
    assert np.max(np.hypot(off[:, 0], off[:, 1])) < 0.01
    assert np.max(np.abs(off[:, 2])) < 0.005
    assert alike(here.grid.states()[::-1], there.grid.states()) > ALIKE


@BOTH
def test_the_same_messages_give_the_same_bytes(make: Callable[..., Mapper], run: Run) -> None:
    first, second = (fed(make(start_pose_map=run.start), run.periods) for _ in range(2))
    assert first.grid.log_odds.tobytes() == second.grid.log_odds.tobytes()
    assert first.trajectory.poses.tobytes() == second.trajectory.poses.tobytes()
    assert first.pose_map.tobytes() == second.pose_map.tobytes()


@BOTH
def test_a_standing_robot_stays_where_it_is(make: Callable[..., Mapper]) -> None:
    mapper = fed(make(start_pose_map=(-2.9, -1.9, 0.0), grid=GRID), _standing(25))
    poses = mapper.trajectory.poses
    assert len(poses) == 25
    assert np.max(np.abs(between(poses[0], poses))) < 1e-3


@BOTH
def test_the_pose_follows_the_odometry_between_scans(make: Callable[..., Mapper], run: Run) -> None:
    mapper = fed(make(start_pose_map=run.start, grid=GRID), run.periods[:40])
    before = mapper.pose_map
    _, last = run.periods[39]
    _, odometry = run.periods[40]
    mapper.update(None, odometry)
    expected = compose(before, between(last[-1].pose_odom, odometry[-1].pose_odom))
    # less what the mapper has learned of the odometry's errors
    assert mapper.pose_map == pytest.approx(expected, abs=0.005)
    assert not np.array_equal(mapper.pose_map, before)


@BOTH
def test_before_any_odometry_the_pose_is_the_start(make: Callable[..., Mapper], run: Run) -> None:
    start = (1.0, 2.0, 0.5)
    mapper = make(start_pose_map=start, grid=GRID)
    mapper.update(run.periods[0][0], [])
    assert mapper.pose_map == pytest.approx(start)
    assert (mapper.updates, mapper.scans_dropped, len(mapper.trajectory)) == (0, 1, 0)


@pytest.mark.parametrize("config", [ScanMatchConfig, GraphConfig])
@pytest.mark.parametrize(
    "wrong",
    [
        {"max_range": 0.0},
        {"keyframe_distance": float("nan")},
        {"keyframe_turn": -0.1},
        {"local_keyframes": 0},
        {"lidar_pose_base": (0.0, float("inf"), 0.0)},
    ],
)
def test_settings_that_make_no_mapper_are_told_by_name(
    config: Callable[..., ScanMatchConfig], wrong: dict[str, object]
) -> None:
    with pytest.raises(TestbedError, match=next(iter(wrong))):
        config(**wrong)


def _standing(count: int) -> list[Period]:
    """A scan, again and again, of a robot that stands still."""
    run = drive(ring(), [RING_WAY[0], (-2.8, -1.9)], np.random.default_rng(0))
    scan, odometry = run.periods[0]
    assert scan is not None
    return [
        (
            replace(scan, stamp=0.2 * k),
            [replace(odometry[0], stamp=0.2 * k + late) for late in (0.0, 0.1, 0.19)],
        )
        for k in range(count)
    ]
