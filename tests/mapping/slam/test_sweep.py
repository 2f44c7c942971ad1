from dataclasses import replace

import numpy as np

from mapping.burger import LIDAR_RANGE_MAX
from mapping.grid import GridConfig, OccupancyGrid
from mapping.messages import LaserScan, Odometry, Twist
from mapping.ogm import Ogm
from mapping.sensor_model import read_beams
from mapping.slam.sweep import make_sweep
from tests.mapping.slam.rooms import random_room, scan_of

GRID = GridConfig(resolution=0.02, origin=(-5.0, -5.0), rows=500, columns=500)
ROOM = random_room(np.random.default_rng(1))


def test_a_kept_scan_draws_what_it_drew_at_first() -> None:
    pose = np.array([0.2, -0.1, 1.0])
    scan = scan_of(ROOM, pose, np.random.default_rng(0))
    for each in (scan, replace(scan, angle_min=2.0 * np.pi - 1e-3, angle_increment=-np.pi / 180)):
        mapper = Ogm(start_pose_map=pose, grid=GRID)
        mapper.update(each, [Odometry(stamp=0.0, pose_odom=np.zeros(3), twist=Twist())])
        beams = read_beams(each, LIDAR_RANGE_MAX)
        grid = OccupancyGrid(GRID)
        make_sweep(each, beams, np.zeros((len(beams.indices), 3))).draw(grid, mapper.config, pose)
        # lengths are kept in float32: a beam may end in the next cell
        assert np.mean(grid.log_odds != mapper.grid.log_odds) < 1e-4
        assert np.mean(grid.log_odds != 0.0) > 0.01


def test_a_scan_of_many_beams_keeps_all_of_them() -> None:
    scan = LaserScan(stamp=0.0, ranges=np.ones(20_000, dtype=np.float32), angle_increment=3e-4)
    beams = read_beams(scan, LIDAR_RANGE_MAX)
    assert np.array_equal(make_sweep(scan, beams, np.zeros((20_000, 3))).indices, np.arange(20_000))


def test_a_scan_without_beams_draws_nothing() -> None:
    scan = LaserScan(stamp=0.0, ranges=np.zeros(360, dtype=np.float32))
    grid = OccupancyGrid(GRID)
    sweep = make_sweep(scan, read_beams(scan, LIDAR_RANGE_MAX), np.zeros((0, 3)))
    sweep.draw(grid, Ogm().config, np.zeros(3))
    assert not grid.log_odds.any()
