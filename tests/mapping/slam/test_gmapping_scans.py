"""Which scans GMapping uses, and what their beams do to its map."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray

from mapping.burger import LIDAR_POSE_BASE
from mapping.compare import score_map
from mapping.grid import FREE, OCCUPIED, UNKNOWN
from mapping.messages import LaserScan
from mapping.slam.gmapping import Gmapping
from tests.mapping.arena import arena_truth, drive, scan_at, standing
from tests.mapping.slam.gmapping_drives import EVERY_SCAN, FEW, mapped, still


def test_a_robot_that_stands_still_is_mapped_once() -> None:
    mapper = mapped(FEW, drive(standing(), 4.0))
    assert mapper.updates == 1
    assert mapper.scans_dropped == 19


@pytest.mark.parametrize(("interval", "expected"), [(2.0, 4), (0.5, 11)])
def test_the_thesiss_update_periods_process_so_many_scans(interval: float, expected: int) -> None:
    config = replace(EVERY_SCAN, update_interval=interval)
    mapper = mapped(config, drive(standing(), 6.6))
    # scans come every 0.2 s from 0.0 to 6.4 s: every tenth of them, and every third
    assert mapper.updates == expected
    assert mapper.updates + mapper.scans_dropped == 33


def test_throttled_scans_are_dropped() -> None:
    mapper = mapped(replace(EVERY_SCAN, throttle_scans=5), drive(standing(), 4.0))
    assert (mapper.updates, mapper.scans_dropped) == (4, 16)


def test_an_old_scan_is_due_though_the_robot_stands() -> None:
    mapper = mapped(replace(FEW, temporalUpdate=0.95), drive(standing(), 4.0))
    assert mapper.updates == 4  # at 0, 1, 2 and 3 s


def test_a_scan_counted_from_minus_pi_draws_the_same_map() -> None:
    scan = scan_at(0.0, standing())
    rolled = LaserScan(
        stamp=0.0, ranges=np.roll(scan.ranges, 180), angle_min=-np.pi, time_increment=0.0
    )
    flat = replace(scan, time_increment=0.0)
    first, second = (mapped(FEW, [(each, still(0.0))]) for each in (flat, rolled))
    # a beam on the edge of two cells may fall to either
    assert np.mean(first.grid.states() != second.grid.states()) < 1e-4


def test_beams_are_placed_where_the_robot_was_at_their_time() -> None:
    def spinning(stamps: NDArray[np.float64]) -> NDArray[np.float64]:
        return np.column_stack((0.0 * stamps, 0.0 * stamps, 2.0 * stamps))

    periods = list(drive(spinning, 6.0))
    frozen = [(scan and replace(scan, time_increment=0.0), odometry) for scan, odometry in periods]
    right, wrong = (
        score_map(mapped(FEW, each).grid, arena_truth(0.05)).f1_5cm for each in (periods, frozen)
    )
    # walls behind the posts are never seen, so even a perfect map scores less than 1
    assert right > 0.9
    assert wrong < right - 0.1


def test_beams_without_a_return_clear_as_far_as_is_said() -> None:
    scan = LaserScan(stamp=0.0, ranges=np.full(360, np.inf, dtype=np.float32))
    for reach in (0.0, 1.0, 3.0):
        mapper = mapped(replace(FEW, clear_range=reach), [(scan, still(0.0))])
        states = mapper.grid.states()
        free = mapper.grid.cell_to_world(np.argwhere(states == FREE))
        far = np.max(np.hypot(*(free - LIDAR_POSE_BASE[:2]).T), initial=0.0)
        # the cell that a beam ends in is left alone, and a cell's centre may lie beyond its edge
        assert max(reach - 0.1, 0.0) <= far <= reach + 0.05
        assert not np.any(states == OCCUPIED)


def test_readings_beyond_the_usable_range_only_clear() -> None:
    ranges = np.full(360, 2.0, dtype=np.float32)
    mapper = mapped(
        replace(FEW, maxUrange=1.5), [(LaserScan(stamp=0.0, ranges=ranges), still(0.0))]
    )
    states, grid = mapper.grid.states(), mapper.grid
    assert not np.any(states == OCCUPIED)
    assert states[tuple(grid.world_to_cell([1.3, 0.0]))] == FREE
    assert states[tuple(grid.world_to_cell([1.6, 0.0]))] == UNKNOWN


BAD_SCANS = {
    "no beams": LaserScan(stamp=0.4, ranges=np.zeros(0, dtype=np.float32)),
    "all NaN": LaserScan(stamp=0.4, ranges=np.full(360, np.nan, dtype=np.float32)),
    "all failed": LaserScan(stamp=0.4, ranges=np.zeros(360, dtype=np.float32)),
    "all too near": LaserScan(stamp=0.4, ranges=np.full(360, -np.inf, dtype=np.float32)),
    "from the past": scan_at(-1.0, standing()),
    "without a time": LaserScan(stamp=np.nan, ranges=np.ones(360, dtype=np.float32)),
    "at no time": LaserScan(stamp=np.inf, ranges=np.ones(360, dtype=np.float32)),
    "from the future": scan_at(9.0, standing()),
    "without an angle": LaserScan(
        stamp=0.4, ranges=np.ones(360, dtype=np.float32), angle_min=np.nan
    ),
    "without a time between beams": LaserScan(
        stamp=0.4, ranges=np.ones(360, dtype=np.float32), time_increment=np.nan
    ),
}


@pytest.mark.parametrize("name", BAD_SCANS)
def test_a_scan_that_tells_nothing_is_dropped_and_changes_nothing(name: str) -> None:
    mapper = Gmapping(EVERY_SCAN)
    mapper.update(scan_at(0.0, standing()), still(0.0))
    before = mapper.grid.log_odds.copy()
    mapper.update(BAD_SCANS[name], still(0.4))
    mapper.update(None, [])
    assert (mapper.updates, mapper.scans_dropped) == (1, 1)
    assert np.array_equal(mapper.grid.log_odds, before)
    mapper.update(scan_at(0.6, standing()), still(0.6))
    assert mapper.updates == 2
    assert np.all(np.isfinite(mapper.grid.log_odds))
    assert np.all(np.isfinite(mapper.trajectory.poses))


def test_a_scan_before_any_odometry_is_dropped() -> None:
    mapper = Gmapping(FEW, start_pose_map=(1.0, 2.0, 0.5))
    mapper.update(scan_at(0.0, standing()), [])
    assert (mapper.updates, mapper.scans_dropped, len(mapper.trajectory)) == (0, 1, 0)
    assert mapper.pose_map == pytest.approx([1.0, 2.0, 0.5])


def test_a_scan_given_twice_counts_once() -> None:
    mapper = Gmapping(EVERY_SCAN)
    for _ in range(3):
        mapper.update(scan_at(0.0, standing()), still(0.0))
    assert (mapper.updates, mapper.scans_dropped) == (1, 0)
