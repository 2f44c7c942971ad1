"""Runs one localisation: a robot wanders through a world and finds itself on a given map."""

from collections.abc import Callable
from time import perf_counter
from typing import Any

import gymnasium
import numpy as np

from envs.burger_env import BurgerEnv
from envs.floor_plan import FloorPlan
from envs.worlds import load_world
from evaluation.episode import CONTROL_PERIOD, ENVIRONMENT
from evaluation.held_interrupt import held_interrupt
from evaluation.localization.config import LocalizationConfig
from evaluation.localization.places import Places
from evaluation.localization.recording import LocalizationRecording, LocalizationRun
from mapping.grid import GridConfig, OccupancyGrid
from mapping.io.map_server import MapFile, read_map
from mapping.localization.known_map import known_map
from mapping.localization.localizers import make_localizer
from mapping.messages import LaserScan
from nav.reactive import Reactive


def run_localization(
    config: LocalizationConfig,
    on_progress: Callable[[float], None] | None = None,
    *,
    plan: FloorPlan | None = None,
    map_file: MapFile | None = None,
) -> LocalizationRun:
    """Run one localisation to its end.

    Args:
        config: What to run.
        on_progress: Called with the simulated time [s] once a control period.
        plan: A floor plan made in code, used in place of ``config.world``.
        map_file: A map made in code, used in place of ``config.map``.

    Raises:
        TestbedError: If the config names something that does not exist or cannot be used.
    """
    map_file = read_map(config.map) if map_file is None else map_file
    known = known_map(map_file)
    plan = load_world(config.world) if plan is None else plan
    rng = np.random.default_rng([config.seed, 0])
    places = Places(plan)
    start = places.draw(rng)
    environment = _make_environment(config, plan)
    try:
        localizer = make_localizer(
            config.filter,
            known,
            start=start if config.start == "known" else None,
            seed=config.seed,
        )
        recording = LocalizationRecording(config, map_file, localizer)
        elsewhere = places.draw(rng)
        started = perf_counter()
        _drive(recording, environment, start, elsewhere, on_progress)
        return recording.run(perf_counter() - started)
    finally:
        environment.close()


def check_localization(config: LocalizationConfig) -> None:
    """Refuse what `run_localization` would refuse, without running anything.

    Raises:
        TestbedError: If the config names something that does not exist or cannot be used.
    """
    known_map(read_map(config.map))
    plan = load_world(config.world)
    Places(plan)
    _make_environment(config, plan).close()


def _make_environment(config: LocalizationConfig, plan: FloorPlan) -> gymnasium.Env[Any, Any]:
    return gymnasium.make(
        ENVIRONMENT,
        world=plan,
        lidar=config.lidar,
        odometry=config.odometry,
        odometry_yaw=config.odometry_yaw,
        max_episode_steps=round(config.end / CONTROL_PERIOD) + 1,
    )


def _drive(
    recording: LocalizationRecording,
    environment: gymnasium.Env[Any, Any],
    start: tuple[float, float, float],
    elsewhere: tuple[float, float, float],
    on_progress: Callable[[float], None] | None,
) -> None:
    """Wander; be carried off when it is time."""
    config = recording.config
    observation, info = environment.reset(seed=config.seed, options={"start": start})
    # wandering needs neither a map nor a pose, so that no belief of the localiser steers the robot
    navigator, nothing = Reactive(), OccupancyGrid(GridConfig(rows=1, columns=1))
    scan: LaserScan | None = None
    time = float(observation["time"][0])
    with held_interrupt() as check_interrupt:
        while True:
            check_interrupt()
            if scan is None or observation["scan_stamp"][0] != scan.stamp:
                scan = LaserScan.from_observation(observation)
            recording.take(time, scan, observation, info["pose_world"])
            if on_progress is not None:
                on_progress(time)
            if time >= config.end - 0.5 * CONTROL_PERIOD:
                return
            if (
                config.kidnap is not None
                and recording.kidnapped_at is None
                and time >= config.kidnap
            ):
                recording.kidnapped_at = time
                _burger(environment).carry_off(elsewhere)
            twist = navigator.command(nothing, np.zeros(3), scan)
            action = np.array([twist.linear_x, twist.angular_z], dtype=np.float32)
            observation, _, _, _, info = environment.step(action)
            time = float(observation["time"][0])


def _burger(environment: gymnasium.Env[Any, Any]) -> BurgerEnv:
    burger = environment.unwrapped
    assert isinstance(burger, BurgerEnv)
    return burger
