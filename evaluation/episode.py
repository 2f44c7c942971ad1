"""Runs one episode: an agent drives the Gymnasium environment until it is done or out of time."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Literal

import gymnasium
import numpy as np
from numpy.typing import ArrayLike, NDArray

from envs.floor_plan import FloorPlan
from envs.truth import truth_of_plan
from envs.worlds import load_world
from evaluation.episode_loop import EpisodeLoop
from evaluation.failure import RunError
from evaluation.progress import Progress
from evaluation.recorder import Recorder
from evaluation.track import Track
from mapping.coverage import CoverageMeter
from mapping.errors import TestbedError
from mapping.gap_filling import GapFilling, check_rule, with_gaps_filled
from mapping.grid import OccupancyGrid
from mapping.mappers import check_resolution, make_mapper
from mapping.pose_graph import PoseGraph
from mapping.pose_history import PoseHistory
from mapping.slam.keyframe_pose_graph import pose_graph_of
from mapping.truth import TruthMap
from nav.agent import MappingAgent
from nav.navigator import ChosenGoal, DroppedFrontier, Navigator
from nav.navigators import make_navigator
from nav.route import parse_route

ENVIRONMENT = "envs:TurtleBot3Burger-v0"
CONTROL_PERIOD = 0.1

BATTERY_LIFE = 9000.0
"""How long a Burger drives on one charge [s]: 2 h 30 min (ROBOTIS e-manual, specifications)."""


@dataclass(frozen=True, slots=True, kw_only=True)
class EpisodeConfig:
    """Everything that defines an episode; the same config gives the same episode."""

    world: str = "lim_room"
    """A built-in world by name, random:SEED, or a floor plan file: YAML, map_server YAML, HouseExpo
    JSON, text maze."""
    mapper: str = "graph"
    """graph, scan_match, gmapping, ogm or occgridmapp."""
    navigator: str = "frontier"
    """frontier; tour, nearest, explore_lite or gain_cost: the same with a rule to compare with;
    reactive; or waypoints: through given places."""
    waypoints: str = ""
    """Places for the navigator waypoints: 'x,y x,y ...' in metres, or the name of a route of the
    world, such as there_and_back in lim_hallway."""
    odometry: str = "typical"
    """Wheel and odometry errors: ideal, typical, poor, or truth (no error at all)."""
    odometry_yaw: Literal["encoders", "imu"] = "imu"
    """Where odometry takes its yaw from: imu as the robot's firmware does, or encoders as the
    thesis has it."""
    imu: str = "typical"
    """IMU errors: typical, drifting (a gyroscope zeroed in whole steps) or ideal."""
    lidar: str = "datasheet"
    """Lidar noise: datasheet, worst_case, measured, ideal, or dropouts: a tenth of all beams
    fails."""
    people: int = 0
    """So many people walk on random loops, besides those of the world."""
    resolution: float | None = None
    """Edge of a map cell [m]; None takes the mapper's own: 1 cm, or 5 cm for gmapping."""
    gap_filling: GapFilling = "none"
    """Closes holes of walls in the map that is written and scored: none, thesis or better."""
    seed: int = 0
    """Seed of every random number of the episode."""
    time_limit: float = BATTERY_LIFE
    """Simulated time after which the episode ends [s]; default what a Burger's battery lasts."""

    def __post_init__(self) -> None:
        """Refuse figures that make no episode."""
        check_rule(self.gap_filling)
        if self.seed < 0:
            raise TestbedError(f"seed: {self.seed}; must be 0 or more")
        if not CONTROL_PERIOD <= self.time_limit < np.inf:
            least = f"must be finite and {CONTROL_PERIOD} or more"
            raise TestbedError(f"time_limit: {self.time_limit} s; {least}")
        check_resolution(self.resolution)


@dataclass(frozen=True, slots=True, kw_only=True)
class Episode:
    """What an episode left behind: the map, the tracks, the truth and the counts."""

    config: EpisodeConfig
    plan: FloorPlan
    truth: TruthMap
    grid: OccupancyGrid
    track: Track
    trajectory: PoseHistory
    """Where the mapper, in the end, takes the robot to have been, a row per scan."""
    stop_reason: str
    wall_time: float
    """Wall time of the loop [s], without set-up, scoring and showing."""
    contacts: int
    """How often the robot ran into something, people among it."""
    contacts_by_people: int
    """How often people ran into the robot."""
    coverage_times: NDArray[np.float64]
    """When coverage was measured ``(n,)`` [s]."""
    coverages: NDArray[np.float64]
    """Coverage at those times ``(n,)``."""
    map_updates: int
    scans_dropped: int
    map_update_seconds: NDArray[np.float64]
    """Wall time of each map update ``(n,)`` [s]."""
    map_update_stamps: NDArray[np.float64]
    """Stamp of the scan that each took in ``(n,)`` [s]."""
    navigator_seconds: NDArray[np.float64]
    """Wall time of each command ``(n,)`` [s]."""
    decision_seconds: NDArray[np.float64]
    """The same of those in which the navigator weighed where to go ``(n,)`` [s]."""
    dropped_frontiers: tuple[DroppedFrontier, ...]
    goals: tuple[ChosenGoal, ...]
    """What the navigator set out for, in order."""
    recorder: Recorder | None = None
    """What kept the run's messages, if they were to be kept."""
    pose_graph: PoseGraph | None = None
    """The mapper's keyframes and the matches between them, if it keeps such."""

    @property
    def sim_time(self) -> float:
        """Simulated time at the end [s]: when coverage was measured last."""
        return float(self.coverage_times[-1])


def run_episode(
    config: EpisodeConfig,
    on_progress: Callable[[Progress], None] | None = None,
    *,
    plan: FloorPlan | None = None,
    recorder: Recorder | None = None,
) -> Episode:
    """Run one episode to its end; Ctrl-C ends it early and keeps what there is.

    Args:
        config: What to run.
        on_progress: Called once a simulated second.
        plan: A floor plan made in code, used in place of ``config.world``.
        recorder: Notes the messages of every control period.

    Raises:
        TestbedError: If the config names something that does not exist or cannot be used.
        RunError: If anything raises an error after the first turn; it carries the episode up to
            there, and the error is its cause.
    """
    plan = load_world(config.world) if plan is None else plan
    agent = make_agent(config, plan)
    environment = make_environment(config, plan)
    try:
        return drive_episode(config, plan, agent, environment, on_progress, recorder)
    finally:
        environment.close()


def check_episode(config: EpisodeConfig) -> None:
    """Refuse what `run_episode` would refuse, without running anything.

    Raises:
        TestbedError: If the config names something that does not exist or cannot be used.
    """
    plan = load_world(config.world)
    make_agent(config, plan)
    make_environment(config, plan).close()


def make_agent(config: EpisodeConfig, plan: FloorPlan) -> MappingAgent:
    """The mapper and navigator that a config names; the start pose is known to the mapper."""
    mapper = make_mapper(
        config.mapper,
        start_pose_map=plan.start,
        resolution=config.resolution,
    )
    return MappingAgent(mapper, navigator_of(config, plan))


def navigator_of(config: EpisodeConfig, plan: FloorPlan) -> Navigator:
    """A fresh navigator that a config names."""
    return make_navigator(config.navigator, _places(config, plan))


def make_environment(config: EpisodeConfig, plan: FloorPlan) -> gymnasium.Env[Any, Any]:
    """The environment that a config describes; close it after use."""
    return gymnasium.make(
        ENVIRONMENT,
        world=plan,
        people=config.people,
        lidar=config.lidar,
        odometry=config.odometry,
        odometry_yaw=config.odometry_yaw,
        imu=config.imu,
        max_episode_steps=round(config.time_limit / CONTROL_PERIOD),
    )


def _places(config: EpisodeConfig, plan: FloorPlan) -> ArrayLike | None:
    """The waypoints that a config gives or names, None when it gives none."""
    if not config.waypoints:
        return None
    routes = {route.name: route.points for route in plan.routes}
    if config.waypoints in routes:
        return routes[config.waypoints]
    if "," not in config.waypoints:
        raise TestbedError(
            f"waypoints: {config.waypoints!r}; must be x,y x,y ... or a route of the world "
            f"({', '.join(routes) or 'it has none'})"
        )
    return parse_route(config.waypoints)


def drive_episode(
    config: EpisodeConfig,
    plan: FloorPlan,
    agent: MappingAgent,
    environment: gymnasium.Env[Any, Any],
    on_progress: Callable[[Progress], None] | None = None,
    recorder: Recorder | None = None,
) -> Episode:
    """Let an agent drive an environment to the end, as ``run_episode`` does with a config's own."""
    truth = truth_of_plan(plan, resolution=agent.mapper.grid.resolution)
    meter = CoverageMeter(truth)
    loop = EpisodeLoop(agent, environment, meter, on_progress, recorder)
    loop.run(config.seed)
    grid = with_gaps_filled(agent.mapper.grid, config.gap_filling)
    loop.coverages.append((loop.time, meter.measure(grid)))
    times, values = np.array(loop.coverages).T
    episode = Episode(
        config=config,
        plan=plan,
        truth=truth,
        track=loop.track,
        trajectory=agent.mapper.trajectory,
        stop_reason=loop.stop_reason,
        wall_time=loop.wall_time,
        contacts=int(loop.info["contacts"]),
        contacts_by_people=int(loop.info["contacts_by_people"]),
        coverage_times=times,
        coverages=values,
        grid=grid,
        map_updates=agent.mapper.updates,
        scans_dropped=agent.mapper.scans_dropped,
        map_update_seconds=np.array(agent.map_update_seconds, dtype=np.float64),
        map_update_stamps=np.array(agent.map_update_stamps, dtype=np.float64),
        navigator_seconds=np.array(agent.navigator_seconds, dtype=np.float64),
        decision_seconds=np.array(agent.decision_seconds, dtype=np.float64),
        dropped_frontiers=agent.navigator.dropped_frontiers,
        goals=agent.navigator.goals,
        recorder=recorder,
        pose_graph=pose_graph_of(agent.mapper),
    )
    if loop.error is not None:
        raise RunError(episode) from loop.error
    return episode
