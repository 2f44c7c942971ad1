"""Repeats the thesis's two sensor experiments (appendix A): a lidar's settings into its readings.

The robot stands in a hallway, first facing its end wall, then turned round to where the hallway is
open farther than the lidar reaches. Of every scan the beam straight ahead is read.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass

import gymnasium
import numpy as np
from numpy.typing import NDArray

from envs.burger_constants import CONTROL_PERIOD
from envs.floor_plan import FloorPlan, Wall
from envs.lidar_noise import LIDAR_PRESETS, LidarConfig
from envs.presets import preset
from evaluation.episode import ENVIRONMENT
from mapping.burger import LIDAR_POSE_BASE, LIDAR_SCAN_TIME
from mapping.errors import TestbedError
from mapping.messages import LaserScan

WALL_DISTANCE = 0.5
"""From the lidar to the wall in front of it [m] (thesis, appendix A)."""

HALLWAY_WIDTH, HALLWAY_LENGTH = 2.0, 12.0
"""Of the hallway [m]; seen along its middle, the far end is out of reach three times over."""

WALL_THICKNESS = 0.1
"""Of its walls [m]."""

AHEAD = 0
"""The beam that is read: straight ahead (thesis, appendix A)."""

MOST_SCANS = 1_000_000
"""More would take an hour."""


@dataclass(frozen=True, slots=True, kw_only=True)
class CalibrationConfig:
    """What is measured, and how often."""

    lidar: str = "measured"
    """Lidar noise: measured, datasheet, worst_case, dropouts or ideal."""
    seed: int = 0
    """Seed of every random number."""
    scans: int = 1000
    """Scans of each of the two experiments."""

    def __post_init__(self) -> None:
        """Refuse what makes no experiment."""
        if self.seed < 0:
            raise TestbedError(f"seed: {self.seed}; must be 0 or more")
        if not 1 <= self.scans <= MOST_SCANS:
            raise TestbedError(f"scans: {self.scans}; must be 1 to {MOST_SCANS}")
        preset("lidar", self.lidar, LIDAR_PRESETS)

    @property
    def lidar_settings(self) -> LidarConfig:
        """The figures that the lidar's name stands for."""
        return LIDAR_PRESETS[self.lidar]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Readings:
    """What the beam ahead read in every scan [m]: ``+inf`` for no return, 0.0 for a failure."""

    wall: NDArray[np.float64]
    """In front of the wall ``(scans,)``."""
    open: NDArray[np.float64]
    """In front of the open hallway ``(scans,)``."""


def take_readings(
    config: CalibrationConfig, on_scan: Callable[[], object] = lambda: None
) -> Readings:
    """Let the simulated robot stand and read, first the wall, then the open hallway.

    Args:
        config: What to measure.
        on_scan: Called after every scan of both.
    """
    plan = hallway()
    away = (*plan.start[:2], plan.start[2] + math.pi)
    steps_a_scan = round(LIDAR_SCAN_TIME / CONTROL_PERIOD)
    environment = gymnasium.make(
        ENVIRONMENT,
        world=plan,
        lidar=config.lidar,
        max_episode_steps=steps_a_scan * config.scans,
    )
    try:
        environment.reset(seed=config.seed)
        wall = _readings_from(environment, plan.start, config.scans, on_scan)
        return Readings(wall=wall, open=_readings_from(environment, away, config.scans, on_scan))
    finally:
        environment.close()


def hallway() -> FloorPlan:
    """A dead end, the robot facing its end wall with the lidar WALL_DISTANCE from it."""
    end = WALL_DISTANCE + LIDAR_POSE_BASE[0] + 0.5 * WALL_THICKNESS
    side = 0.5 * (HALLWAY_WIDTH + WALL_THICKNESS)
    corners = ((end, -side), (end, side), (end - HALLWAY_LENGTH, side))
    return FloorPlan(
        name="calibration_hallway",
        start=(0.0, 0.0, 0.0),
        walls=(
            Wall(
                points=(*corners, (end - HALLWAY_LENGTH, -side)),
                closed=True,
                thickness=WALL_THICKNESS,
            ),
        ),
    )


def _readings_from(
    environment: "gymnasium.Env[dict[str, NDArray[np.float64]], NDArray[np.float32]]",
    start: tuple[float, float, float],
    scans: int,
    on_scan: Callable[[], object],
) -> NDArray[np.float64]:
    """What the beam ahead reads in so many scans ``(scans,)`` [m], from a start pose."""
    observation, _ = environment.reset(options={"start": start})
    stand = np.zeros(2, dtype=np.float32)
    readings: list[float] = []
    newest = -math.inf
    while True:
        scan = LaserScan.from_observation(observation)
        if scan is not None and scan.stamp > newest:
            newest = scan.stamp
            readings.append(float(scan.ranges[AHEAD]))
            on_scan()
        if len(readings) == scans:
            return np.array(readings)
        observation = environment.step(stand)[0]
