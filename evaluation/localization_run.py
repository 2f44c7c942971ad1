"""Runs one localisation: a robot wanders through a world and finds itself on a given map."""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from time import perf_counter
from typing import Any, Literal

import gymnasium
import numpy as np
from numpy.typing import NDArray

from envs.burger_env import BurgerEnv
from envs.floor_plan import FloorPlan
from envs.truth import truth_of_plan
from envs.worlds import load_world
from evaluation.episode import CONTROL_PERIOD, ENVIRONMENT
from evaluation.track import Track
from mapping.burger import ROBOT_RADIUS
from mapping.errors import TestbedError
from mapping.geometry import Pose
from mapping.grid import GridConfig, OccupancyGrid
from mapping.io.map_server import MapFile, read_map
from mapping.localization.known_map import known_map
from mapping.localization.localizer import Localizer
from mapping.localization.localizers import FilterName, check_localizer, make_localizer
from mapping.messages import ODOMETRY_COLUMNS, Imu, LaserScan, Odometry
from nav.reactive import Reactive

DRAW_RESOLUTION = 0.05
"""Raster on which places to be put down are drawn [m]."""

ELBOW_ROOM = 0.05
"""The robot is put down no nearer to a wall than its radius and this [m]."""

TIME_TO_FIND = 60.0
"""Time a run gives the localiser, from the start and after a kidnapping [s]."""

SNAPSHOT_TIMES = (0.2, 2.0, 10.0)
"""Moments after the start, and after a kidnapping, whose belief is kept for drawing [s]."""

SNAPSHOT_POSES = 3000
"""At most so many poses of a belief are kept."""


@dataclass(frozen=True, slots=True, kw_only=True)
class LocalizationConfig:
    """Everything that defines a run; the same config gives the same run."""

    map: Path
    """The map's YAML, as map_server writes it; its frame must be the world's."""
    world: str
    """A built-in world by name, or a floor plan file."""
    filter: FilterName = "particle"
    """particle, histogram or ekf (which needs a known start)."""
    start: Literal["uniform", "known"] = "uniform"
    """uniform: all poses on the map are equally likely to the localiser; known: it is told."""
    kidnap: float | None = None
    """Time at which the robot is put down elsewhere without being told [s]."""
    odometry: str = "typical"
    """Wheel and odometry errors: ideal, typical, poor, or truth (no error at all)."""
    odometry_yaw: Literal["encoders", "imu"] = "imu"
    """Where odometry takes its yaw from."""
    lidar: str = "datasheet"
    """Lidar noise: datasheet, worst_case, measured or ideal."""
    seed: int = 0
    """Seed of every random number, the start pose and the place of the kidnapping among them."""
    time_limit: float | None = None
    """Simulated time after which the run ends [s]; None gives 60 s, and 60 s after a kidnapping."""

    def __post_init__(self) -> None:
        """Refuse figures that make no run."""
        if self.seed < 0:
            raise TestbedError(f"seed: {self.seed}; must be 0 or more")
        for name in ("kidnap", "time_limit"):
            value = getattr(self, name)
            if value is not None and not 1.0 <= value < np.inf:
                raise TestbedError(f"{name}: {value} s; must be finite and 1 or more")
        if self.kidnap is not None and self.kidnap >= self.end:
            raise TestbedError(f"kidnap: {self.kidnap} s; must be before the end, {self.end} s")
        check_localizer(self.filter, knows_start=self.start == "known")

    @property
    def end(self) -> float:
        """When the run ends [s]."""
        if self.time_limit is not None:
            return self.time_limit
        return TIME_TO_FIND + (0.0 if self.kidnap is None else self.kidnap)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Snapshot:
    """A belief at a moment."""

    time: float
    poses: Pose
    """Poses that stand for the belief ``(n, 3)``."""
    pose_map: Pose
    """The best guess ``(3,)``."""
    pose_world: Pose
    """The truth ``(3,)``."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class LocalizationRun:
    """What a run left behind."""

    config: LocalizationConfig
    map_file: MapFile
    track: Track
    weights: NDArray[np.float64]
    """Weight of the likeliest hypothesis at every control period ``(n,)``."""
    ambiguous: NDArray[np.bool_]
    """Whether the localiser said that it was ambiguous ``(n,)``."""
    sizes: NDArray[np.int64]
    """Particles, cells looked at, or landmarks ``(n,)``."""
    update_seconds: NDArray[np.float64]
    """Wall time of each update that used a scan ``(m,)`` [s]."""
    update_sizes: NDArray[np.int64]
    """The size of the belief after it ``(m,)``."""
    snapshots: tuple[Snapshot, ...]
    kidnapped_at: float | None
    wall_time: float


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
    places = _Places(plan)
    start = places.draw(rng)
    environment = _make_environment(config, plan)
    try:
        localizer = make_localizer(
            config.filter,
            known,
            start=start if config.start == "known" else None,
            seed=config.seed,
        )
        recording = _Recording(config, map_file, localizer)
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
    _Places(plan)
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
    recording: "_Recording",
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
    while True:
        if scan is None or observation["scan_stamp"][0] != scan.stamp:
            scan = LaserScan.from_observation(observation)
        recording.take(time, scan, observation, info["pose_world"])
        if on_progress is not None:
            on_progress(time)
        if time >= config.end - 0.5 * CONTROL_PERIOD:
            return
        if config.kidnap is not None and recording.kidnapped_at is None and time >= config.kidnap:
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


class _Places:
    """Places where the robot can be put down: those it can reach from the plan's start."""

    def __init__(self, plan: FloorPlan) -> None:
        truth = truth_of_plan(
            plan, resolution=DRAW_RESOLUTION, robot_radius=ROBOT_RADIUS + ELBOW_ROOM
        )
        self._origin = truth.origin
        self._cells = np.argwhere(truth.reachable)

    def draw(self, rng: np.random.Generator) -> tuple[float, float, float]:
        """A pose, uniform over the places and over headings."""
        row, column = self._cells[rng.integers(len(self._cells))]
        x = self._origin[0] + (float(column) + 0.5) * DRAW_RESOLUTION
        y = self._origin[1] + (float(row) + 0.5) * DRAW_RESOLUTION
        return x, y, float(rng.uniform(-np.pi, np.pi))


class _Recording:
    """Feeds the localiser and notes what it says."""

    def __init__(self, config: LocalizationConfig, map_file: MapFile, localizer: Localizer) -> None:
        self.config = config
        self.kidnapped_at: float | None = None
        self._map_file = map_file
        self._localizer = localizer
        self._track = Track()
        self._rows: list[tuple[float, bool, int]] = []
        self._updates: list[tuple[float, int]] = []
        self._snapshots: list[Snapshot] = []

    def take(self, time: float, scan: LaserScan | None, observation: Any, pose_world: Pose) -> None:
        """Take the messages of one control period."""
        localizer, before = self._localizer, self._localizer.updates
        odometry = Odometry.from_observation(observation)
        imu = Imu.from_observation(observation)
        started = perf_counter()
        localizer.update(scan, odometry, imu)
        took = perf_counter() - started
        if localizer.updates > before:
            self._updates.append((took, localizer.size))
        newest = observation["odometry"][-1]
        x = ODOMETRY_COLUMNS.index("x")
        self._track.note(time, localizer.pose_map, pose_world, newest[x : x + 3])
        best = localizer.hypotheses[0].weight if localizer.hypotheses else 0.0
        self._rows.append((best, localizer.is_ambiguous, localizer.size))
        if self._is_moment(time):
            poses = localizer.sample
            kept = poses[:: max(1, -(-len(poses) // SNAPSHOT_POSES))].copy()
            self._snapshots.append(
                Snapshot(
                    time=time,
                    poses=kept,
                    pose_map=localizer.pose_map,
                    pose_world=pose_world.copy(),
                )
            )

    def run(self, wall_time: float) -> LocalizationRun:
        """What there is now."""
        weights, ambiguous, sizes = zip(*self._rows, strict=True)
        seconds, update_sizes = zip(*self._updates, strict=True)
        return LocalizationRun(
            config=self.config,
            map_file=self._map_file,
            track=self._track,
            weights=np.array(weights, dtype=np.float64),
            ambiguous=np.array(ambiguous, dtype=np.bool_),
            sizes=np.array(sizes, dtype=np.int64),
            update_seconds=np.array(seconds, dtype=np.float64),
            update_sizes=np.array(update_sizes, dtype=np.int64),
            snapshots=tuple(self._snapshots),
            kidnapped_at=self.kidnapped_at,
            wall_time=wall_time,
        )

    def _is_moment(self, time: float) -> bool:
        """Whether the belief of now is to be kept."""
        since = time if self.kidnapped_at is None else time - self.kidnapped_at
        return any(abs(since - moment) < 0.5 * CONTROL_PERIOD for moment in SNAPSHOT_TIMES)
