"""Measures how fast each stage and the whole loop run, on this machine, with real objects."""

from collections.abc import Callable
from dataclasses import dataclass
from time import perf_counter

import gymnasium
import numpy as np

from envs.worlds import load_world
from evaluation.episode import ENVIRONMENT, Episode, EpisodeConfig, make_agent, run_episode
from mapping.burger import LIDAR_BEAMS, LIDAR_SCAN_TIME
from mapping.geometry import Pose
from mapping.mappers import make_mapper
from mapping.messages import LaserScan, Odometry, Twist

BENCH_WORLDS = ("lim_room", "turtlebot3_world", "lim_hallway")
REPEATS = 200


@dataclass(frozen=True, slots=True, kw_only=True)
class Stage:
    """What one stage costs."""

    name: str
    median_ms: float
    """Median wall time of one call [ms]."""
    p99_ms: float
    """99th percentile of the same [ms]."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Loop:
    """What a simulated second of the whole loop costs, by who spends it [ms]."""

    world: str
    sim_time: float
    """Simulated time [s]."""
    real_time_factor: float
    simulation_ms: float
    """Physics, sensors, environment and bookkeeping."""
    mapping_ms: float
    navigation_ms: float


def bench_stages() -> list[Stage]:
    """Time the stages one by one: mapper updates at full range, the environment, the agent."""
    return [
        _stage("ogm update, 1 cm, 360 beams of 3.5 m", _mapper_update("ogm")),
        _stage("occgridmapp update, 1 cm, 360 beams of 3.5 m", _mapper_update("occgridmapp")),
        _stage("environment step, 0.1 s simulated, lim_room", _environment_step("lim_room")),
        _stage("environment step, 0.1 s simulated, lim_hallway", _environment_step("lim_hallway")),
    ]


def bench_loop(world: str, seed: int = 0) -> Loop:
    """Run one whole exploration and split its wall time."""
    episode = run_episode(EpisodeConfig(world=world, seed=seed))
    return loop_of(episode)


def loop_of(episode: Episode) -> Loop:
    """Who spent an episode's wall time."""
    mapping = float(episode.map_update_seconds.sum())
    navigation = float(episode.navigator_seconds.sum())
    per_second = 1e3 / episode.sim_time
    return Loop(
        world=episode.config.world,
        sim_time=episode.sim_time,
        real_time_factor=episode.sim_time / episode.wall_time,
        simulation_ms=(episode.wall_time - mapping - navigation) * per_second,
        mapping_ms=mapping * per_second,
        navigation_ms=navigation * per_second,
    )


def _stage(name: str, call: Callable[[], object]) -> Stage:
    for _ in range(REPEATS // 10):
        call()
    seconds = []
    for _ in range(REPEATS):
        started = perf_counter()
        call()
        seconds.append(perf_counter() - started)
    median, p99 = np.percentile(np.array(seconds) * 1e3, [50, 99])
    return Stage(name=name, median_ms=float(median), p99_ms=float(p99))


def _mapper_update(name: str) -> Callable[[], object]:
    """Updates with scans that see nothing in range from a robot that drives a circle."""
    mapper = make_mapper(name)
    ranges = np.full(LIDAR_BEAMS, np.inf, dtype=np.float32)
    stamp = 0.0

    def update() -> None:
        nonlocal stamp
        scan = LaserScan(stamp=stamp, ranges=ranges)
        times = stamp + np.linspace(0.0, LIDAR_SCAN_TIME, 7)
        mapper.update(scan, [_on_circle(float(time)) for time in times])
        stamp += LIDAR_SCAN_TIME

    return update


def _on_circle(time: float, speed: float = 0.2, turn_rate: float = 0.15) -> Odometry:
    yaw = turn_rate * time
    radius = speed / turn_rate
    pose: Pose = np.array([radius * np.sin(yaw), radius * (1.0 - np.cos(yaw)), yaw])
    return Odometry(stamp=time, pose_odom=pose, twist=Twist(linear_x=speed, angular_z=turn_rate))


def _environment_step(world: str) -> Callable[[], object]:
    """Steps of an environment in which the agent explores, the agent's own time not counted."""
    config = EpisodeConfig(world=world)
    plan = load_world(world)
    environment = gymnasium.make(ENVIRONMENT, world=plan, max_episode_steps=10**6)
    agent = make_agent(config, plan)
    observation, _ = environment.reset(seed=0)
    actions = []
    for _ in range(REPEATS):
        actions.append(agent.act(observation))
        observation = environment.step(actions[-1])[0]
    environment.reset(seed=0)
    upcoming = iter(actions * 3)
    return lambda: environment.step(next(upcoming))
