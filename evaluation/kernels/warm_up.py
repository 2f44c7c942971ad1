"""Tells the numba kernels that a mapper's runs need, and the short runs that call them all."""

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from envs.floor_plan import Cylinder, FloorPlan, Wall
from evaluation.kernels.kernel_set import KernelSet
from mapping.burger import LIDAR_BEAMS
from mapping.geometry import Pose, wrap_to_pi
from mapping.messages import LaserScan, Odometry, Twist
from mapping.sensor_log import SensorLog

TINY_ROOM = FloorPlan(
    name="tiny_room",
    start=(0.5, 0.5, 0.0),
    walls=(Wall(points=((0.0, 0.0), (4.0, 0.0), (4.0, 3.0), (0.0, 3.0)), closed=True),),
    cylinders=(Cylinder(center=(2.0, 1.2), radius=0.3),),
)

SPARSE_PERIOD = 3.0
"""Time between two scans of a log that leaves mappers much to search for [s]."""

ROUNDS, ROUND_TIME, ROUND_RADIUS = 3, 60.0, 2.0
"""Its robot goes so many times round, in so long [s], so far from the middle of the room [m]."""

ROOM = np.array([3.2, 2.8])
"""Half the sides of that room [m]."""


def kernels_of_mapper(mapper: str, *, simulates: bool) -> KernelSet:
    """All that runs with a mapper need.

    Args:
        mapper: Its name, one of MAPPERS.
        simulates: Whether an episode is run, or else a log mapped.
    """
    return KernelSet(
        owner=f"mapper {mapper}",
        kind=f"{mapper}-{'episode' if simulates else 'replay'}",
        call=lambda: _map_what_takes_no_time(mapper, simulates),
    )


def _map_what_takes_no_time(mapper: str, simulates: bool) -> None:
    """A tiny episode, if one is to be run, and a log.

    No simulated robot goes far between two scans. So that mappers also search for the robot, and
    for places where it was before, there is a log in which one does.
    """
    from evaluation.recording import Recording
    from evaluation.replay import ReplayConfig, run_replay

    if simulates:
        from evaluation.episode import EpisodeConfig, run_episode
        from evaluation.result import result_of

        config = EpisodeConfig(mapper=mapper, time_limit=20.0, people=1)
        episode = run_episode(config, plan=TINY_ROOM)
        result_of(episode, map_file_kb=None)
        _manoeuvre_where_there_is_room()
    recording = Recording(log=sparse_log())
    run_replay(ReplayConfig(log=Path(recording.log.source), mapper=mapper), recording)


def _manoeuvre_where_there_is_room() -> None:
    """Plan the manoeuvre that a robot in a room without pockets never needs."""
    from mapping.grid import OccupancyGrid
    from nav.manoeuvre import ManoeuvreConfig, plan_manoeuvre
    from nav.safety import SafetyConfig

    nothing = np.zeros((0, 2))
    plan_manoeuvre(np.zeros(3), nothing, OccupancyGrid(), ManoeuvreConfig(), SafetyConfig())


def sparse_log() -> SensorLog:
    """A robot that circles in an empty room, a scan and an odometry message every SPARSE_PERIOD."""
    stamps = np.arange(0.0, ROUNDS * ROUND_TIME, SPARSE_PERIOD)
    yaws = 2.0 * np.pi * stamps / ROUND_TIME
    x, y = ROUND_RADIUS * np.sin(yaws), -ROUND_RADIUS * np.cos(yaws)
    poses = np.column_stack((x, y, wrap_to_pi(yaws)))
    return SensorLog(
        source="sparse.log",
        scans=[
            LaserScan(stamp=stamp, ranges=_room_around(pose), time_increment=0.0)
            for stamp, pose in zip(stamps.tolist(), poses, strict=True)
        ],
        odometry=[
            Odometry(stamp=stamp, pose_odom=pose, twist=Twist())
            for stamp, pose in zip(stamps.tolist(), poses, strict=True)
        ],
    )


def _room_around(pose: Pose) -> NDArray[np.float32]:
    """What a lidar at a pose ``(3,)`` sees of a room of ROOM, centred on the origin."""
    angles = pose[2] + np.linspace(0.0, 2.0 * np.pi, LIDAR_BEAMS, endpoint=False)
    rays = np.column_stack((np.cos(angles), np.sin(angles)))
    with np.errstate(divide="ignore"):
        to_walls = (np.copysign(ROOM, rays) - pose[:2]) / rays
    return np.asarray(to_walls.min(axis=1).astype(np.float32))
