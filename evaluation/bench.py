"""Measures how fast each stage and the whole loop run, on this machine, with real objects."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from time import perf_counter

import gymnasium
import numpy as np

from envs.worlds import load_world
from evaluation.episode import ENVIRONMENT, Episode, EpisodeConfig, make_agent, run_episode
from evaluation.result import percentile_ms
from mapping.burger import LIDAR_BEAMS, LIDAR_SCAN_TIME
from mapping.geometry import Pose
from mapping.mapper import Mapper
from mapping.mappers import make_mapper
from mapping.messages import Imu, LaserScan, Odometry, Twist
from mapping.sensor_log import Period
from mapping.slam.fusion import FusedTrack

BENCH_WORLDS = ("lim_room", "turtlebot3_world", "lim_hallway")
REPEATS = 200

DRIVE_WORLD, DRIVE_STEPS = "lim_hallway", 2000
"""Where the robot drives, and for how many control periods, to give mappers something to match."""

FIRST_STEPS = 50
"""Each mapper gets so many of them before, so that its kernels are loaded when it is timed."""


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
    decision_ms: float | None
    """Median wall time of one decision where to go: frontiers, gains, order and path."""


def bench_stages() -> list[Stage]:
    """Time the stages one by one: mapper updates, the fusion in them, the environment.

    The mappers that match scans get what a robot with the usual errors saw on a drive; what they
    cost depends on that. A map cell has 1 cm, for gmapping 5 cm.
    """
    drive = record_drive(DRIVE_WORLD, DRIVE_STEPS)
    return [
        _stage("ogm update, 1 cm, 360 beams of 3.5 m", _mapper_update("ogm")),
        _stage("occgridmapp update, 1 cm, 360 beams of 3.5 m", _mapper_update("occgridmapp")),
        _matching(f"graph update, {DRIVE_WORLD}", "graph", drive),
        _matching(f"scan_match update, {DRIVE_WORLD}", "scan_match", drive),
        _matching(f"gmapping update, 30 particles, {DRIVE_WORLD}", "gmapping", drive),
        _fusion(f"fusion of a control period, {DRIVE_WORLD}", drive),
        _stage("environment step, 0.1 s simulated, lim_room", _environment_step("lim_room")),
        _stage("environment step, 0.1 s simulated, lim_hallway", _environment_step("lim_hallway")),
    ]


def bench_loop(world: str, seed: int = 0, mapper: str = "graph") -> Loop:
    """Run one whole exploration and split its wall time."""
    episode = run_episode(EpisodeConfig(world=world, seed=seed, mapper=mapper))
    return loop_of(episode)


def record_drive(world: str, steps: int) -> list[Period]:
    """What a robot sees that explores a world from its start, a row per control period."""
    config = EpisodeConfig(world=world, mapper="ogm")
    plan = load_world(world)
    environment = gymnasium.make(ENVIRONMENT, world=plan, max_episode_steps=10**6)
    agent = make_agent(config, plan)
    observation, _ = environment.reset(seed=0)
    drive: list[Period] = []
    for _ in range(steps):
        messages = Odometry.from_observation(observation), Imu.from_observation(observation)
        drive.append((LaserScan.from_observation(observation), *messages))
        observation = environment.step(agent.act(observation))[0]
    environment.close()
    return drive


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
        decision_ms=percentile_ms(episode.decision_seconds, 50),
    )


def _stage(name: str, call: Callable[[], object]) -> Stage:
    for _ in range(REPEATS // 10):
        call()
    seconds = []
    for _ in range(REPEATS):
        started = perf_counter()
        call()
        seconds.append(perf_counter() - started)
    return _stage_of(name, seconds)


def _stage_of(name: str, seconds: Sequence[float]) -> Stage:
    median, p99 = np.percentile(np.array(seconds) * 1e3, [50, 99])
    return Stage(name=name, median_ms=float(median), p99_ms=float(p99))


def _matching(name: str, mapper: str, drive: Sequence[Period]) -> Stage:
    """Time the updates in which a mapper took in a scan."""
    plan = load_world(DRIVE_WORLD)
    _update_seconds(make_mapper(mapper, start_pose_map=plan.start), drive[:FIRST_STEPS])
    return _stage_of(name, _update_seconds(make_mapper(mapper, start_pose_map=plan.start), drive))


def _update_seconds(mapper: Mapper, drive: Sequence[Period]) -> list[float]:
    """Wall time of each update that took in a scan [s]."""
    seconds = []
    for scan, odometry, imu in drive:
        before, started = mapper.updates, perf_counter()
        mapper.update(scan, odometry, imu)
        if mapper.updates > before:
            seconds.append(perf_counter() - started)
    return seconds


def _fusion(name: str, drive: Sequence[Period]) -> Stage:
    """Time the fusion of odometry and gyroscope, as the mappers that match scans do it."""
    track, seconds = FusedTrack(), []
    for _, odometry, imu in drive:
        started = perf_counter()
        track.add(odometry, imu)
        seconds.append(perf_counter() - started)
    return _stage_of(name, seconds)


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
