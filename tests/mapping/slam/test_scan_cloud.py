from dataclasses import replace

import numpy as np
import pytest

from mapping.burger import LIDAR_POSE_BASE, LIDAR_RANGE_MAX
from mapping.messages import LaserScan
from mapping.sensor_model import LDS_01, range_sigma, read_beams
from mapping.slam.scan_cloud import LOOSE_WORTH, ScanCloud, make_cloud
from tests.mapping.slam.rooms import TICK, box, cloud_of, random_room, scan_of

ROOM = box(-1.5, 1.5, -1.0, 1.0)
POSE = np.array([0.2, -0.1, 0.4])


def test_points_lie_where_the_beams_ended() -> None:
    cloud = cloud_of(scan_of(ROOM, np.zeros(3)))
    x, y = np.abs(cloud.points).T
    assert len(cloud) == 360
    assert np.all((np.abs(x - 1.5) < 1e-6) | (np.abs(y - 1.0) < 1e-6))


def test_points_of_a_turning_robot_lie_where_they_would_for_one_that_stands() -> None:
    blank = LaserScan(stamp=0.0, ranges=np.zeros(360, dtype=np.float32))
    moved = np.outer(blank.beam_stamps, (0.2, 0.0, 1.5))
    rolling = scan_of(ROOM, moved, scan=blank)
    beams = read_beams(rolling, LIDAR_RANGE_MAX)
    cloud = make_cloud(
        rolling,
        beams,
        moved[beams.indices],
        lidar_pose_base=LIDAR_POSE_BASE,
        range_noise=LDS_01,
        resolution=0.05,
        reach=LIDAR_RANGE_MAX,
    )
    x, y = np.abs(cloud.points).T
    assert np.all((np.abs(x - 1.5) < 1e-6) | (np.abs(y - 1.0) < 1e-6))


def test_far_hits_failures_and_beams_without_a_return_are_no_points() -> None:
    ranges = np.full(360, np.inf, dtype=np.float32)
    ranges[[10, 20, 30, 40, 50]] = 1.0, 3.4, 0.0, np.nan, 0.05
    scan = LaserScan(stamp=0.0, ranges=ranges)
    cloud = make_cloud(
        scan,
        read_beams(scan, LIDAR_RANGE_MAX),
        np.zeros((357, 3)),
        lidar_pose_base=(0.0, 0.0, 0.0),
        range_noise=LDS_01,
        resolution=0.05,
        reach=2.0,
    )
    angle = np.radians(10.0)
    assert cloud.points == pytest.approx(np.array([[np.cos(angle), np.sin(angle)]]))


def test_a_noisy_reading_and_one_on_no_wall_are_worth_less() -> None:
    cloud = cloud_of(scan_of(random_room(np.random.default_rng(2)), POSE), resolution=0.01)
    lengths = np.hypot(*(cloud.points - LIDAR_POSE_BASE[:2]).T)
    worth = np.minimum(1.0, (0.01 / range_sigma(lengths)) ** 2)
    on_wall = np.any(cloud.normals != 0.0, axis=1)
    assert 0 < np.count_nonzero(~on_wall) < len(cloud)  # corners
    assert np.allclose(cloud.weights, worth * np.where(on_wall, 1.0, LOOSE_WORTH), rtol=1e-4)


def test_a_lidar_mounted_upside_down_sees_the_same_walls() -> None:
    scan = scan_of(random_room(np.random.default_rng(1)), POSE)
    back = replace(
        scan,
        ranges=scan.ranges[::-1].copy(),
        angle_min=scan.angle_max,
        angle_increment=-scan.angle_increment,
    )
    one, other = cloud_of(scan), cloud_of(back)
    assert np.allclose(other.points[::-1], one.points)
    assert np.allclose(other.normals[::-1], one.normals)
    assert np.allclose(other.weights[::-1], one.weights)
    assert _moments(other) == pytest.approx(_moments(one), rel=1e-4)  # sums of float32


def test_only_a_wide_view_looks_around() -> None:
    for count, looks_around in ((360, True), (180, False)):
        scan = LaserScan(stamp=0.0, ranges=np.ones(count, dtype=np.float32))
        for each in (scan, replace(scan, angle_increment=-scan.angle_increment)):
            assert cloud_of(each).looks_around == looks_around


@pytest.mark.parametrize("ranges", [[], [np.nan] * 9, [0.0] * 9, [np.inf] * 9, [-np.inf] * 9])
def test_a_scan_without_hits_is_an_empty_cloud(ranges: list[float]) -> None:
    cloud = cloud_of(LaserScan(stamp=TICK, ranges=np.array(ranges, dtype=np.float32)))
    assert len(cloud) == 0
    assert cloud.points.shape == cloud.normals.shape == (0, 2)
    assert cloud.surface.shape == (0, 5)


def _moments(cloud: ScanCloud) -> list[float]:
    """The surface's weight, middle and spread: its points come in another order."""
    x, y, weights = cloud.surface[:, :3].T.astype(float)
    return [float(weights @ each) for each in (x**0, x, y, x**2, x * y, y**2)]
