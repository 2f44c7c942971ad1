import numpy as np
import pytest

from mapping.errors import TestbedError
from mapping.grid import FREE, OCCUPIED
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
        {"lidar_pose_base": (0.0, np.inf, 0.0)},
    ],
)
def test_settings_that_make_no_mapper_are_told(broken: dict[str, float]) -> None:
    with pytest.raises(TestbedError, match=next(iter(broken))):
        OccGridMappConfig(**broken)
