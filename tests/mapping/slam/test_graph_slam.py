from dataclasses import dataclass, field, replace

import numpy as np
import pytest
from numpy.typing import NDArray

from mapping.errors import TestbedError
from mapping.geometry import between
from mapping.grid import FREE, OCCUPIED, GridConfig
from mapping.slam.graph_slam import GraphConfig, GraphSlam
from mapping.slam.odometry_calibration import CalibrationConfig
from tests.mapping.slam.rooms import (
    LONG_RING_WAY,
    RING_WAY,
    Run,
    box,
    drive,
    fed,
    long_ring,
    ring,
)

GRID = GridConfig(resolution=0.05, origin=(-9.0, -6.0), rows=240, columns=360, grows=False)


@dataclass
class Told:
    """A mapper after a drive, and what it was after each period of it."""

    mapper: GraphSlam
    loops: list[int] = field(default_factory=list)
    keyframes: list[int] = field(default_factory=list)
    redraws: list[int] = field(default_factory=list)


@pytest.fixture(scope="module")
def lap() -> Run:
    """Around the long ring and along its first side again; the odometry is off by metres."""
    way = [*LONG_RING_WAY, (3.0, -2.4)]
    return drive(long_ring(), way, np.random.default_rng(0), scale=0.10, drift=0.03, noise=0.05)


@pytest.fixture(scope="module")
def told(lap: Run) -> Told:
    told = Told(GraphSlam(start_pose_map=lap.start, grid=GRID))
    for scan, odometry in lap.periods:
        told.mapper.update(scan, odometry)
        told.loops.append(told.mapper.loops)
        told.keyframes.append(len(told.mapper.graph))
        told.redraws.append(told.mapper.grid.redraws)
    return told


def offsets(mapper: GraphSlam, run: Run) -> NDArray[np.float64]:
    """How far off each pose of the trajectory is [m]."""
    apart = between(run.truth, mapper.trajectory.poses)
    return np.asarray(np.hypot(apart[:, 0], apart[:, 1]))


def test_a_loop_is_closed_where_the_robot_comes_back_and_not_before(told: Told, lap: Run) -> None:
    first = told.loops.index(next(loops for loops in told.loops if loops > 0))
    assert np.hypot(*(lap.truth[first] - lap.truth[0])[:2]) < 3.5  # as far as the lidar sees
    assert told.loops[-1] >= 2


def test_the_trajectory_is_many_times_better_than_the_odometrys(told: Told, lap: Run) -> None:
    odometry_off = between(lap.truth[-1], lap.odometry_end)
    assert np.hypot(*odometry_off[:2]) > 2.0  # else nothing is shown
    rms = np.sqrt(np.mean(offsets(told.mapper, lap) ** 2))
    # in four bare stretches of 5 m the first guess of a scale that is 10 % off stays unknown
    assert rms < 0.25


def test_the_map_of_the_second_round_lies_on_that_of_the_first(told: Told, lap: Run) -> None:
    poses, truth = told.mapper.trajectory.poses, lap.truth
    again = np.arange(len(truth) - 150, len(truth))
    apart = np.linalg.norm(truth[again, None, :2] - truth[None, :250, :2], axis=2)
    first = np.argmin(apart, axis=1)
    assert np.max(np.min(apart, axis=1)) < 0.1  # else it is no second round
    seen = between(poses[first], poses[again])
    true = between(truth[first], truth[again])
    missed = between(true, seen)
    # across the corridor to a fraction of a cell of the map; along it nothing tells
    assert np.max(np.abs(missed[:, 1])) < 0.03
    assert np.max(np.abs(missed[:, 2])) < 0.02


def test_the_map_is_drawn_anew_while_the_robot_goes_on(told: Told, lap: Run) -> None:
    closed = told.loops.index(told.loops[-1])
    assert told.redraws[closed - 1] == 0
    assert told.redraws[-1] >= 1


def test_finishing_draws_the_map_where_the_corrected_poses_are(told: Told, lap: Run) -> None:
    mapper = GraphSlam(start_pose_map=lap.start, grid=GRID)
    fed(mapper, lap.periods[: told.loops.index(told.loops[-1]) + 20])
    assert mapper.painter.is_redrawing
    mapper.finish()
    assert mapper.grid.redraws == 2  # drawn anew, then refined
    assert not mapper.painter.is_redrawing
    assert mapper.painter.error <= mapper.grid.resolution
    # the pose is the last scan's, and 0.2 s of driving
    step = between(mapper.trajectory.poses[-1], mapper.pose_map)
    assert np.hypot(step[0], step[1]) < 0.05
    states = mapper.grid.states()
    # both long walls, in the middle of which nobody looks twice, are one or two cells thick
    left = mapper.grid.world_to_cell([-4.0, -3.0])[1]
    right = mapper.grid.world_to_cell([4.0, -3.0])[1]
    rows = mapper.grid.world_to_cell([[0.0, -3.4], [0.0, -2.6]])[:, 0]
    thickness = np.sum(states[rows[0] : rows[1], left:right] == OCCUPIED, axis=0)
    assert np.mean(thickness) < 3.0
    assert np.mean(thickness > 0) > 0.9
    # what is asked again changes nothing
    poses, cells = mapper.trajectory.poses, mapper.grid.log_odds.copy()
    mapper.finish()
    assert mapper.trajectory.poses == pytest.approx(poses, abs=1e-3)
    assert np.mean(mapper.grid.log_odds != cells) < 0.01


def test_a_finished_map_is_refined_unless_that_is_not_wanted() -> None:
    run = drive(ring(), RING_WAY[:3], np.random.default_rng(1), scale=0.0, drift=0.0)
    grids = []
    for refine in (False, True):
        mapper = GraphSlam(GraphConfig(refine=refine), start_pose_map=run.start)
        fed(mapper, run.periods)
        before = mapper.grid.redraws
        mapper.finish()
        assert mapper.grid.redraws - before >= refine
        grids.append(mapper.grid)
    drawn, refined = (grid.states() for grid in grids)
    assert np.count_nonzero(refined == OCCUPIED) < 0.8 * np.count_nonzero(drawn == OCCUPIED)
    assert np.count_nonzero(refined == FREE) > np.count_nonzero(drawn == FREE)


def test_the_pose_jumps_no_farther_than_the_map_is_wrong(lap: Run) -> None:
    mapper = GraphSlam(start_pose_map=lap.start, grid=GRID)
    jumps, wrong = [], []
    before, error, redraws = lap.start, 0.0, 0
    for scan, odometry in lap.periods:
        mapper.update(scan, odometry)
        step = between(before, mapper.pose_map)
        jumps.append(float(np.hypot(step[0], step[1])))
        wrong.append(max(error, mapper.painter.error))
        before, error, redraws = mapper.pose_map, mapper.painter.error, mapper.grid.redraws
    assert redraws > 0
    # 4 cm of driving in a period, 10 % and a match's correction; once the loop is closed the robot
    # goes over from what it drew last to what it drew first, which do not fit before the redraw
    assert np.all(np.array(jumps) < 0.06 + np.array(wrong))
    assert np.max(jumps) > 0.1
    assert np.count_nonzero(np.array(jumps) > 0.06) <= 3


def test_no_more_keyframes_are_taken_when_the_same_round_is_driven_again() -> None:
    way = [*RING_WAY, *RING_WAY[1:]]
    run = drive(ring(), way, np.random.default_rng(1), scale=0.02, drift=0.01)
    mapper = GraphSlam(start_pose_map=run.start, grid=GRID)
    fed(mapper, run.periods[: len(run.periods) // 2])
    once, kept = len(mapper.graph), len(mapper.painter)
    fed(mapper, run.periods[len(run.periods) // 2 :])
    # where the loop closes, 8 m of way are matched with what lies behind only
    assert len(mapper.graph) < 1.35 * once
    assert len(mapper.painter) < 1.35 * kept
    assert np.max(offsets(mapper, run)) < 0.05


def test_the_same_messages_give_the_same_bytes_loops_and_all(told: Told, lap: Run) -> None:
    again = GraphSlam(start_pose_map=lap.start, grid=GRID)
    fed(again, lap.periods)
    assert again.loops == told.mapper.loops > 0
    assert again.trajectory.poses.tobytes() == told.mapper.trajectory.poses.tobytes()
    assert again.grid.log_odds.tobytes() == told.mapper.grid.log_odds.tobytes()


def test_a_robot_that_sees_nothing_goes_where_its_odometry_says_and_closes_no_loop() -> None:
    run = drive(ring(), RING_WAY, np.random.default_rng(1), scale=0.02, drift=0.01)
    mapper = GraphSlam(start_pose_map=run.start, grid=GRID)
    for scan, odometry in run.periods:
        assert scan is not None
        mapper.update(replace(scan, ranges=np.full(360, np.inf, dtype=np.float32)), odometry)
    assert mapper.loops == 0
    edges = [(edge.a, edge.b) for edge in mapper.graph.edges]
    assert edges == [(k, k + 1) for k in range(len(mapper.graph) - 1)], "no match ties any"
    assert len(edges) > 10
    off = between(run.odometry_end, mapper.trajectory.poses[-1])
    assert np.hypot(off[0], off[1]) < 0.01


def test_a_hall_wider_than_the_lidar_sees_stays_on_the_map_when_it_is_drawn_anew() -> None:
    hall = box(-9.0, 9.0, -6.0, 6.0)
    way = [(-6.5, -3.5), (2.0, 0.0), (0.0, 2.0), (6.5, -3.5)]
    run = drive(hall, way, np.random.default_rng(2), noise=0.01)
    mapper = GraphSlam(start_pose_map=run.start, grid=GRID)
    fed(mapper, run.periods)
    free = mapper.grid.states() == FREE
    mapper.painter.redraw()
    mapper.painter.work(len(mapper.painter))
    assert np.count_nonzero(free & (mapper.grid.states() != FREE)) < 0.01 * np.count_nonzero(free)


@pytest.mark.parametrize(
    ("config", "settings"),
    [
        (GraphConfig, {"redraw_sweeps": 0}),
        (GraphConfig, {"keep_shift": float("nan")}),
        (GraphConfig, {"max_range": -1.0}),
        (GraphConfig, {"way": 0.0}),
        (CalibrationConfig, {"first_noise": 0.5}),
        (CalibrationConfig, {"turn_sigma": float("inf")}),
    ],
)
def test_settings_that_make_no_mapper_are_refused(config: type, settings: dict[str, float]) -> None:
    with pytest.raises(TestbedError, match=next(iter(settings))):
        config(**settings)
