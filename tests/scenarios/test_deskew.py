"""Spins in lim_room at 1 to 2 rad/s: each beam at its own pose, or all at the scan's first."""

from dataclasses import replace

import numpy as np
import pytest

from envs.floor_plan import FloorPlan
from envs.simulation import Simulation
from envs.truth import truth_of_plan
from envs.worlds import load_world
from mapping.compare import MapScores, score_map
from mapping.mappers import make_mapper
from mapping.messages import LaserScan, Odometry

SPINS = (1.0, -1.25, 1.5, -1.75, 2.0, -1.0)
"""Turn rates [rad/s], 6 s each: two to four turns of the robot, 36 s and 180 scans."""

Recording = list[tuple[LaserScan | None, "list[Odometry]"]]


def spin(plan: FloorPlan, lidar: str) -> Recording:
    simulation = Simulation(plan, lidar=lidar, odometry="truth", rng=0)
    recording: Recording = []
    for rate in np.repeat(SPINS, 60):
        simulation.command(0.0, float(rate))
        batch = simulation.advance(0.1)
        scan = None
        if batch.ranges is not None and batch.scan_stamp is not None:
            scan = LaserScan(stamp=batch.scan_stamp, ranges=batch.ranges)
        recording.append((scan, list(Odometry.from_observation({"odometry": batch.odometry}))))
    return recording


def map_scores(plan: FloorPlan, recording: Recording, resolution: float) -> MapScores:
    mapper = make_mapper("ogm", start_pose_map=plan.start, resolution=resolution)
    for scan, odometry in recording:
        mapper.update(scan, odometry)
    assert mapper.updates == 180  # none is gated for turning
    return score_map(mapper.grid, truth_of_plan(plan, resolution=resolution))


def frozen(recording: Recording) -> Recording:
    """The same with every scan as if taken at once, at the time of its first beam."""
    return [
        (None if scan is None else replace(scan, time_increment=0.0), odometry)
        for scan, odometry in recording
    ]


@pytest.mark.parametrize(("lidar", "resolution"), [("measured", 0.01), ("datasheet", 0.05)])
def test_deskewed_walls_are_at_most_three_fifths_as_thick(lidar: str, resolution: float) -> None:
    """With the datasheet's noise, 3.5 cm at 3 m, walls on 1 cm cells are as thick as the noise."""
    plan = load_world("lim_room")
    recording = spin(plan, lidar)
    deskewed = map_scores(plan, recording, resolution)
    bent = map_scores(plan, frozen(recording), resolution)
    assert deskewed.wall_thickness_ratio is not None
    assert bent.wall_thickness_ratio is not None
    assert deskewed.wall_thickness_ratio <= 0.6 * bent.wall_thickness_ratio
    assert deskewed.f1_5cm is not None
    assert bent.f1_5cm is not None
    # scans bent by 0.2 to 0.4 rad contradict one another: what one draws the next wipes out
    assert bent.f1_5cm <= 0.75 * deskewed.f1_5cm
