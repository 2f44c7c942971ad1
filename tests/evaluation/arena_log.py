"""A drive around the arena as a log, and the recordings of it that are replayed."""

from dataclasses import replace
from pathlib import Path

import numpy as np

from envs.floor_plan import Cylinder, FloorPlan, Wall
from evaluation.recording import Recording
from evaluation.replay import ReplayConfig
from mapping.burger import LIDAR_POSE_BASE
from mapping.geometry import between, compose
from mapping.sensor_log import SensorLog
from mapping.trajectory import Trajectory
from tests.mapping.arena import HALF_HEIGHT, HALF_WIDTH, POSTS, circling, drive

SECONDS = 12.0
"""How long it drives [s]."""

START = (1.45, 0.0, np.pi / 2)
"""Where a drive around the arena starts."""

RELATION_KEYS = {
    f"relations_{key}"
    for key in ("used", "trans_mean_m", "trans_std_m", "trans_max_m", "rot_mean_deg")
}

X, Y = HALF_WIDTH + 0.05, HALF_HEIGHT + 0.05

ARENA = FloorPlan(
    name="arena",
    start=START,
    walls=(Wall(points=((-X, -Y), (X, -Y), (X, Y), (-X, Y)), closed=True, thickness=0.1),),
    cylinders=tuple(Cylinder(center=(x, y), radius=radius) for x, y, radius in POSTS),
)


def true_trajectory() -> Trajectory:
    stamps = 0.1 * np.arange(round(SECONDS / 0.1) + 1)
    return Trajectory(stamps=stamps, poses=compose(np.zeros(3), circling()(stamps)))


def log_in_frame(frame: tuple[float, float, float]) -> SensorLog:
    """A drive around the arena with odometry without error, told in a frame of its own."""
    scans, odometry = [], []
    for scan, messages in drive(circling(), SECONDS):
        scans += [] if scan is None else [scan]
        odometry += messages
    return SensorLog(
        source="arena.log",
        scans=scans,
        odometry=[
            replace(each, pose_odom=compose(frame, between(START, each.pose_odom)))
            for each in odometry
        ],
        lidar_pose_base=LIDAR_POSE_BASE,
    )


LOG = log_in_frame((0.0, 0.0, 0.0))

RECORDING = Recording(log=LOG)

RUN = Recording(log=LOG, ground_truth=true_trajectory(), plan=ARENA, world="arena")

COARSE = ReplayConfig(log=Path("arena.log"), mapper="ogm", resolution=0.05)

EVERY_SCAN = {"gmapping": ("temporalUpdate=0",), "occgridmapp": ("turn_gate=none",)}
"""Settings of mappers that else leave out scans: of a robot that hardly moves, or that turns."""
