"""GMapping as a whole: path, map, seeds, frames, settings."""

from dataclasses import replace

import numpy as np
import pytest

from mapping.compare import score_map
from mapping.errors import TestbedError
from mapping.geometry import between, compose
from mapping.grid import FREE, GridConfig
from mapping.slam.gmapping import Gmapping
from mapping.slam.gmapping_config import GmappingConfig
from tests.mapping.arena import arena_truth, circling, scan_at, standing
from tests.mapping.slam.gmapping_drives import EVERY_SCAN, FEW, mapped, noisy_round, still


def test_a_room_driven_with_bad_odometry_is_mapped_where_it_is() -> None:
    periods = noisy_round()
    mapper = mapped(FEW, periods)
    newest = periods[-1][1][-1]
    true = circling()(np.array([newest.stamp]))[0]
    odometry_error = between(true, newest.pose_odom)
    error = between(true, mapper.pose_map)
    assert np.hypot(*odometry_error[:2]) > 0.2  # else nothing is shown
    assert np.hypot(*error[:2]) < 0.05  # one cell
    assert abs(error[2]) < 0.03
    scores = score_map(mapper.grid, arena_truth(0.05))
    assert scores.f1_10cm > 0.95


def test_the_path_has_a_pose_for_every_scan_and_follows_the_truth() -> None:
    periods = noisy_round()
    mapper = mapped(FEW, periods)
    path = mapper.trajectory
    assert len(path) == sum(scan is not None for scan, _ in periods)
    assert mapper.updates + mapper.scans_dropped == len(path)
    apart = between(circling()(path.stamps), path.poses)
    # a cell, and what 8 % of a turn between two updates adds
    assert np.max(np.hypot(apart[:, 0], apart[:, 1])) < 0.08


def test_the_same_seed_gives_the_same_map_and_another_one_another() -> None:
    periods = noisy_round(12.0)
    first, second, other = (mapped(replace(FEW, seed=seed), periods) for seed in (1, 1, 2))
    assert np.array_equal(first.grid.log_odds, second.grid.log_odds)
    assert np.array_equal(first.trajectory.poses, second.trajectory.poses)
    assert not np.array_equal(first.trajectory.poses, other.trajectory.poses)


def test_shifting_the_start_by_whole_cells_shifts_the_map() -> None:
    periods = noisy_round(12.0)
    here = mapped(FEW, periods)
    there = mapped(FEW, periods, (3.0, -4.0, 0.0))
    moved = compose([3.0, -4.0, 0.0], here.trajectory.poses)
    # shifted numbers are rounded otherwise, and climbing ends within its last step, 1.6 mm
    assert np.allclose(there.trajectory.poses, moved, atol=5e-3)
    assert np.mean(there.grid.states() == here.grid.states()) > 0.99


def test_turning_the_start_turns_the_path() -> None:
    periods = noisy_round(20.0)
    start = np.array([3.0, -4.0, 0.7])
    here, there = mapped(FEW, periods), mapped(FEW, periods, start)
    apart = between(compose(start, here.trajectory.poses), there.trajectory.poses)
    # the cells lie otherwise on the walls: half a cell, and that over a wall of 2 m
    assert np.max(np.hypot(apart[:, 0], apart[:, 1])) < 0.025 + 0.01
    assert np.max(np.abs(apart[:, 2])) < 0.0125 + 0.01


def test_a_grid_drawn_tile_by_tile_is_the_best_particles_whole_map() -> None:
    mapper = Gmapping(EVERY_SCAN)
    for scan, odometry in noisy_round(8.0):
        mapper.update(scan, odometry)
        drawn, redraws = mapper.grid.log_odds.copy(), mapper.grid.redraws
        if mapper.updates:
            mapper._draw(True, np.ones(mapper.filter.maps.tables.shape[1:], dtype=np.bool_))
            assert np.array_equal(mapper.grid.log_odds, drawn)
            mapper.grid.redraws = redraws


def test_cells_beyond_the_scans_reach_change_only_when_the_grid_is_redrawn() -> None:
    reach = 1.2
    mapper = Gmapping(replace(EVERY_SCAN, max_range=reach, clear_range=reach))
    far_changes = 0
    for scan, odometry in noisy_round(20.0):
        before = mapper.grid.copy()
        mapper.update(scan, odometry)
        grid = mapper.grid
        assert grid.shape == before.shape
        changed = grid.cell_to_world(np.argwhere(grid.log_odds != before.log_odds))
        far = np.hypot(*(changed - mapper.pose_map[:2]).T) > reach + 0.2  # the lidar, a few cells
        assert grid.redraws > before.redraws or not np.any(far)
        far_changes += np.count_nonzero(far)
    assert far_changes > 0  # else nothing is shown


def test_a_map_published_seldom_is_whole_in_the_end() -> None:
    periods = noisy_round(5.0)
    often, seldom = (
        mapped(replace(EVERY_SCAN, map_update_interval=seconds), periods) for seconds in (0.0, 4.0)
    )
    assert not np.array_equal(seldom.grid.log_odds, often.grid.log_odds)
    seldom.finish()
    assert np.array_equal(seldom.grid.log_odds, often.grid.log_odds)


def test_a_jump_of_the_odometry_moves_nothing() -> None:
    periods = noisy_round(10.0)
    smooth = mapped(FEW, periods)
    jumping = Gmapping(FEW)
    for k, (scan, odometry) in enumerate(periods):
        shift = np.array([5.0, 0.0, 0.0]) if k >= 50 else np.zeros(3)
        jumping.update(scan, [replace(each, pose_odom=each.pose_odom + shift) for each in odometry])
    # the step of 1/30 s that the jump hid is lost: 7 mm and half a degree
    apart = between(smooth.pose_map, jumping.pose_map)
    assert np.hypot(*apart[:2]) < 0.05
    assert smooth.grid.shape == jumping.grid.shape


def test_a_match_below_the_minimum_score_leaves_the_pose_to_the_odometry() -> None:
    # without noise the particles are where the odometry is
    blind = replace(FEW, minimumScore=1e6, srr=0.0, srt=0.0, str=0.0, stt=0.0)
    periods = noisy_round(10.0)
    mapper = mapped(blind, periods)
    assert mapper.updates > 1
    assert mapper.pose_map == pytest.approx(periods[-1][1][-1].pose_odom)


def test_sampling_the_proposal_maps_the_room_as_well() -> None:
    mapper = mapped(replace(FEW, sample_proposal=True), noisy_round(15.0))
    true = circling()(np.array([noisy_round(15.0)[-1][1][-1].stamp]))[0]
    assert np.hypot(*between(true, mapper.pose_map)[:2]) < 0.05


def test_the_grid_given_decides_on_place_and_cells() -> None:
    grid = GridConfig(resolution=0.1, origin=(-1.03, -0.98), rows=20, columns=24, grows=False)
    mapper = Gmapping(FEW, grid=grid)
    mapper.update(scan_at(0.0, standing()), still(0.0))
    assert mapper.grid.shape == (20, 24)
    assert mapper.config.delta == 0.1
    assert mapper.grid.states()[tuple(mapper.grid.world_to_cell([0.0, 0.0]))] == FREE


@pytest.mark.parametrize(
    "wrong",
    [
        {"particles": 0},
        {"particles": 2.5},
        {"kernelSize": 20},
        {"sigma": 0.0},
        {"lsigma": float("nan")},
        {"srr": -0.1},
        {"str": "much"},
        {"resampleThreshold": 1.5},
        {"maxUrange": 0.0},
        {"temporalUpdate": float("nan")},
        {"throttle_scans": 0},
        {"lidar_pose_base": (0.0, 0.0)},
        {"seed": -1},
    ],
)
def test_settings_that_make_no_filter_are_told_by_name(wrong: dict[str, object]) -> None:
    with pytest.raises(TestbedError, match=next(iter(wrong))):
        GmappingConfig(**wrong)  # type: ignore[arg-type]
