from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray

from mapping.errors import TestbedError
from mapping.grid import FREE, OCCUPIED, UNKNOWN
from mapping.messages import LaserScan, Odometry, Twist
from mapping.occ_grid_mapp import OccGridMapp, OccGridMappConfig
from mapping.sensor_model import LOG_ODDS_FREE, LOG_ODDS_OCCUPIED
from tests.mapping.arena import arena_truth, circling, drive

SMALL = OccGridMappConfig(cells=900, start_in_grid=(4.5, 4.5), lidar_pose_base=(0.0, 0.0, 0.0))


def odometry(stamp: float, turn_rate: float = 0.0, yaw: float = 0.0) -> list[Odometry]:
    twist = Twist(angular_z=turn_rate)
    return [Odometry(stamp=stamp, pose_odom=np.array([0.0, 0.0, yaw]), twist=twist)]


def scan(stamp: float, beams: dict[int, float]) -> LaserScan:
    """A scan in which all beams but a few failed."""
    ranges = np.zeros(360, dtype=np.float32)
    ranges[list(beams)] = list(beams.values())
    return LaserScan(stamp=stamp, ranges=ranges)


def at(mapper: OccGridMapp, x: float, y: float) -> float:
    return float(mapper.grid.log_odds[tuple(mapper.grid.world_to_cell([x, y]))])


def test_the_default_grid_is_the_thesis_grid_with_the_start_in_its_middle() -> None:
    mapper = OccGridMapp(start_pose_map=(3.0, -1.0, 0.5))
    assert mapper.grid.shape == (5000, 5000)
    assert mapper.grid.resolution == 0.01
    assert mapper.grid.extent == pytest.approx((-22.0, 28.0, -26.0, 24.0))


def test_a_beam_to_the_left_marks_the_left() -> None:
    mapper = OccGridMapp(SMALL)
    mapper.update(scan(0.0, {90: 1.0}), odometry(0.0))
    assert at(mapper, 0.0, 1.0) == pytest.approx(LOG_ODDS_OCCUPIED)
    assert at(mapper, 0.0, 0.5) == pytest.approx(-LOG_ODDS_FREE)
    assert at(mapper, 0.0, 0.98) == pytest.approx(-LOG_ODDS_OCCUPIED)
    assert at(mapper, 1.0, 0.0) == 0.0


def test_the_start_pose_moves_the_whole_map() -> None:
    mapper = OccGridMapp(SMALL, start_pose_map=(1.0, 2.0, np.pi / 2))
    mapper.update(scan(0.0, {0: 1.005}), odometry(0.0))
    assert at(mapper, 1.0, 3.005) == pytest.approx(LOG_ODDS_OCCUPIED)
    assert mapper.pose_map == pytest.approx([1.0, 2.0, np.pi / 2])


def test_a_beam_that_failed_changes_no_cell() -> None:
    mapper = OccGridMapp(SMALL)
    mapper.update(scan(0.0, {0: np.nan, 1: -np.inf, 2: 0.0, 3: 0.05}), odometry(0.0))
    assert not mapper.grid.log_odds.any()
    assert (mapper.updates, mapper.scans_dropped) == (0, 1)


def test_infinity_frees_to_the_full_range_and_no_farther() -> None:
    mapper = OccGridMapp(SMALL)
    mapper.update(scan(0.0, {0: np.inf}), odometry(0.0))
    assert at(mapper, 3.495, 0.0) < 0.0
    assert at(mapper, 3.52, 0.0) == 0.0


def test_a_scan_is_used_once() -> None:
    mapper = OccGridMapp(SMALL)
    for stamp in (0.0, 0.1, 0.15):
        mapper.update(scan(0.0, {0: 1.0}), odometry(stamp))
    assert (mapper.updates, mapper.scans_dropped) == (1, 0)
    assert at(mapper, 1.0, 0.0) == pytest.approx(LOG_ODDS_OCCUPIED)


def test_a_scan_while_turning_is_dropped_unless_the_gate_is_off() -> None:
    gated, open_ = OccGridMapp(SMALL), OccGridMapp(OccGridMappConfig(cells=900, turn_gate=None))
    for mapper in (gated, open_):
        mapper.update(scan(0.0, {0: 1.0}), odometry(0.0, turn_rate=-0.3))
    assert (gated.updates, gated.scans_dropped) == (0, 1)
    assert (open_.updates, open_.scans_dropped) == (1, 0)


def test_a_snapshot_is_the_drawn_part_of_the_map_and_stays_as_it_was() -> None:
    mapper = OccGridMapp(SMALL, start_pose_map=(0.5, 0.0, 0.0))
    mapper.update(scan(0.0, {0: 1.0, 90: np.inf}), odometry(0.0))
    snapshot = mapper.snapshot()
    before = mapper.grid.log_odds.copy()
    mapper.update(scan(0.2, {180: 3.3}), odometry(0.2))
    copied = snapshot.grid
    assert copied.shape[0] * copied.shape[1] < before.size
    row, column = mapper.grid.world_to_cell(copied.cell_to_world((0, 0)))
    window = slice(row, row + copied.shape[0]), slice(column, column + copied.shape[1])
    assert np.array_equal(copied.log_odds, before[window])
    assert np.count_nonzero(copied.log_odds) == np.count_nonzero(before), "all that was drawn"
    assert np.array_equal(copied.states(), mapper_states(before, mapper)[window])
    assert snapshot.path == pytest.approx(np.array([[0.5, 0.0, 0.0]]))
    assert snapshot.start_pose_map == pytest.approx([0.5, 0.0, 0.0])


def mapper_states(log_odds: NDArray[np.float32], mapper: OccGridMapp) -> NDArray[np.int8]:
    grid = mapper.grid.copy()
    grid.log_odds = log_odds
    return grid.states()


def test_a_map_of_which_nothing_is_drawn_has_a_snapshot_too() -> None:
    assert not OccGridMapp(SMALL).snapshot().grid.log_odds.any()


def test_the_threshold_of_states_is_a_setting() -> None:
    mapper = OccGridMapp(replace(SMALL, state_threshold=5.0))
    mapper.update(scan(0.0, {0: 1.0}), odometry(0.0))
    cells = tuple(mapper.grid.world_to_cell([[1.0, 0.0], [0.5, 0.0]]).T)
    assert mapper.grid.states()[cells].tolist() == [UNKNOWN, FREE], "4.70 and -5.11"


def test_log_odds_are_not_clamped() -> None:
    mapper = OccGridMapp(SMALL)
    for k in range(30):
        mapper.update(scan(0.2 * k, {0: 1.0}), odometry(0.2 * k))
    assert at(mapper, 1.0, 0.0) == pytest.approx(30 * LOG_ODDS_OCCUPIED, rel=1e-5)


def test_a_map_of_a_drive_shows_the_room() -> None:
    pose_at = circling()
    config = OccGridMappConfig(cells=1000, start_in_grid=(5.0, 5.0), turn_gate=None)
    mapper = OccGridMapp(config)
    for new, messages in drive(pose_at, 12.0):
        mapper.update(new, messages)
    states, truth = mapper.grid.states(), arena_truth()
    rows, columns = mapper.grid.world_to_cell([[-1.9, -1.4], [1.9, 1.4], [0.0, 0.0]]).T
    assert np.all(states[rows, columns] == FREE)
    drawn = mapper.grid.cell_to_world(np.argwhere(states == OCCUPIED))
    surface = np.argwhere(truth.visible_surface)[:, ::-1] * 0.01 + np.array(truth.origin)
    distance = np.array([np.hypot(*(surface - point).T).min() for point in drawn[::50]])
    assert np.median(distance) < 0.04  # the robot moves 4 cm during a scan that is not deskewed


@pytest.mark.parametrize(
    "broken",
    [
        {"log_odds_free": 0.0},
        {"log_odds_occupied": np.nan},
        {"max_range": -1.0},
        {"turn_gate": -0.1},
        {"state_threshold": 0.0},
        {"cells": 0},
        {"lidar_pose_base": (0.0, np.inf, 0.0)},
    ],
)
def test_settings_that_make_no_mapper_are_told(broken: dict[str, float]) -> None:
    with pytest.raises(TestbedError, match=next(iter(broken))):
        OccGridMappConfig(**broken)
