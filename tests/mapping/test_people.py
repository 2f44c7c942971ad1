"""People who have left are off the map within a second of the lidar seeing where they were."""

from collections.abc import Callable, Iterator

import numpy as np
import pytest

from envs.pedestrians import LEG_RADIUS, Pedestrian, feet_at, gaits_of
from mapping.burger import LIDAR_POSE_BASE, LIDAR_RANGE_MAX
from mapping.geometry import between, compose
from mapping.ghosts import ghost_area
from mapping.grid import GridConfig
from mapping.mappers import make_mapper
from mapping.messages import LaserScan, Odometry
from mapping.sensor_model import range_sigma
from mapping.slam.graph_slam import GraphSlam
from tests.mapping.arena import (
    Array,
    PoseAt,
    arena_truth,
    circling,
    odometry_at,
    standing,
    true_ranges,
)

FORGETTING = ("graph", "ogm")
WALK = gaits_of(
    [Pedestrian(waypoints=((-0.3, 0.1), (1.0, -0.1), (1.0, 0.9), (0.5, -0.9)), speed=0.5)]
)
LEAVES = 6.0
"""When the person is gone [s]."""
SCAN_TIME = 0.2
LegsAt = Callable[[float], Array]


def walking(time: float) -> Array:
    """Legs ``(n, 2)`` of a person who walks to and fro until LEAVES."""
    return feet_at(WALK, time) if time < LEAVES else np.empty((0, 2))


def waiting(time: float) -> Array:
    """Legs of one who stands there all the time, and then is gone."""
    return np.array([(0.6, -0.6), (0.8, -0.6)]) if time < LEAVES else np.empty((0, 2))


def scan_with_legs(
    stamp: float, pose_at: PoseAt, legs_at: LegsAt, rng: np.random.Generator
) -> LaserScan:
    """A noisy scan of the arena in which each beam meets the legs of its own time."""
    scan = LaserScan(stamp=stamp, ranges=np.zeros(360, dtype=np.float32))
    sensors = compose(pose_at(scan.beam_stamps), LIDAR_POSE_BASE)
    angles = sensors[:, 2] + scan.angles
    ranges = true_ranges(sensors[:, :2], angles)
    for i, (time, angle) in enumerate(zip(scan.beam_stamps.tolist(), angles, strict=True)):
        for x, y in legs_at(time) - sensors[i, :2]:
            along, across = np.array(((x, y), (y, -x))) @ (np.cos(angle), np.sin(angle))
            if abs(across) < LEG_RADIUS and along > 0.0:
                ranges[i] = min(ranges[i], along - np.sqrt(LEG_RADIUS**2 - across**2))
    ranges = ranges + rng.normal(0.0, range_sigma(ranges))
    ranges[ranges > LIDAR_RANGE_MAX] = np.inf
    return LaserScan(stamp=stamp, ranges=ranges.astype(np.float32))


def messages(
    pose_at: PoseAt, legs_at: LegsAt, seconds: float
) -> Iterator[tuple[float, LaserScan, list[Odometry]]]:
    """Time, scan and odometry of each turn of the lidar."""
    rng = np.random.default_rng(2)
    for turn in range(round(seconds / SCAN_TIME)):
        begin = SCAN_TIME * turn
        odometry = [odometry_at(begin + SCAN_TIME * k / 6.0, pose_at) for k in range(7)]
        yield begin + SCAN_TIME, scan_with_legs(begin, pose_at, legs_at, rng), odometry


@pytest.mark.parametrize("mapper_name", FORGETTING)
@pytest.mark.parametrize("legs_at", [walking, waiting])
@pytest.mark.parametrize("pose_at", [standing(-0.9, 0.5, -0.3), circling()])
def test_a_person_who_has_left_is_off_the_map_within_a_second(
    mapper_name: str, legs_at: LegsAt, pose_at: PoseAt
) -> None:
    start = pose_at(np.zeros(1))[0]
    mapper = make_mapper(mapper_name, start_pose_map=start, resolution=0.02)
    truth, shown = arena_truth(0.02), 0.0
    for time, scan, odometry in messages(pose_at, legs_at, LEAVES + 1.0):
        mapper.update(scan, [_in_odom(message, start) for message in odometry])
        if time < LEAVES:
            shown = max(shown, ghost_area(mapper.grid, truth))
    assert ghost_area(mapper.grid, truth) == 0.0
    if legs_at is waiting:
        assert shown > 0.002, "else there was nothing to forget"


def test_nor_is_he_in_a_map_that_is_drawn_anew() -> None:
    pose_at = circling()
    start = pose_at(np.zeros(1))[0]
    mapper = GraphSlam(start_pose_map=start, grid=GridConfig(resolution=0.02))
    for time, scan, odometry in messages(pose_at, waiting, LEAVES + 5.0):
        mapper.update(scan, [_in_odom(message, start) for message in odometry])
        if abs(time - LEAVES) < 1e-6:
            mapper.painter.redraw()
            mapper.painter.work(len(mapper.painter))
            assert ghost_area(mapper.grid, arena_truth(0.02)) > 0.002, "the kept scans show him"
    mapper.painter.redraw()
    mapper.painter.work(len(mapper.painter))
    assert ghost_area(mapper.grid, arena_truth(0.02)) == 0.0


def _in_odom(message: Odometry, start: Array) -> Odometry:
    """The same message from where the robot started, as odometry counts."""
    return Odometry(
        stamp=message.stamp, pose_odom=between(start, message.pose_odom), twist=message.twist
    )
