"""Exploration as a task: see as much of the floor as possible, with a mapper in the loop."""

from pathlib import Path
from typing import Any, ClassVar

import gymnasium as gym
import numpy as np
from gymnasium import spaces
from numpy.typing import NDArray

from envs.burger_env import Action, BurgerEnv, Observation
from envs.floor_plan import FloorPlan
from envs.truth import truth_of_plan
from mapping.burger import MAX_ANGULAR_SPEED, MAX_LINEAR_SPEED
from mapping.coverage import CoverageMeter
from mapping.errors import TestbedError
from mapping.geometry import transform_points
from mapping.mappers import make_mapper
from mapping.messages import Imu, LaserScan, Odometry

MAP_RESOLUTION = 0.05
"""Edge of the mapper's cells [m]: ROBOTIS's own, and fast."""
VIEW_CELLS = 96
"""Cells along each edge of the observed map: 4.8 m, what the lidar sees around the robot."""
DONE_COVERAGE = 0.99
"""Coverage at which the floor counts as explored."""
DONE_REWARD, CONTACT_REWARD = 10.0, -10.0
SHADE_UNKNOWN, SHADE_FREE, SHADE_OCCUPIED = 0, 127, 255
"""Values of the observed map, as an image."""


class ExploreEnv(gym.Env[Observation, Action]):  # type: ignore[misc]  # mypy skips gymnasium
    """A TurtleBot3 Burger that is paid for newly seen floor.

    ``envs:BurgerExplore-v0``. World, robot, sensors, action space and step are those of
    ``envs:TurtleBot3Burger-v0``; its keyword arguments are taken and passed on. The mapper sees the
    sensor messages only.

    ## Observation space

    | key | type | meaning |
    |---|---|---|
    | ``ranges`` | (360,) float32 | the newest whole scan [m], 3.5 = nothing, 0.0 = failed |
    | ``map`` | (96, 96) uint8 | the map around the robot: 0 unknown, 127 free, 255 occupied |
    | ``velocity`` | (2,) float32 | odometry's forward speed [m/s] and turn rate [rad/s] |

    The map turns with the robot: row 0 is ahead, column 0 to its left, 5 cm a cell, the robot in
    the middle.

    ## Reward, termination, truncation

    The sum of ``reward_area`` (square metres of true floor newly free in the map; wiping them out
    again costs as much), ``reward_done`` (10 at 99 % coverage) and ``reward_contact`` (-10 on
    running into anything), each told in ``info``. Both of the latter terminate; ``TimeLimit``
    truncates after 10 minutes by default.

    ## Info and options

    ``info`` is that of the robot's environment, the reward's terms, and ``coverage`` (0..1, of the
    floor that the lidar could see from places in reach). ``options`` are passed on.

    Args:
        world: A built-in world, a file or a plan.
        mapper: A mapper's name.
        robot_settings: Keyword arguments of ``BurgerEnv``.

    Raises:
        TestbedError: A name or figure is not usable.
    """

    metadata: ClassVar[dict[str, Any]] = BurgerEnv.metadata

    def __init__(
        self,
        world: str | Path | FloorPlan = "lim_room",
        *,
        mapper: str = "ogm",
        **robot_settings: Any,
    ) -> None:
        self._robot = BurgerEnv(world, **robot_settings)
        self._mapper_name = mapper
        self.render_mode = self._robot.render_mode
        self.action_space = self._robot.action_space
        speed = np.array([10.0 * MAX_LINEAR_SPEED, 10.0 * MAX_ANGULAR_SPEED], dtype=np.float32)
        self.observation_space = spaces.Dict(
            {
                "ranges": self._robot.observation_space["ranges"],
                "map": spaces.Box(0, 255, (VIEW_CELLS, VIEW_CELLS), np.uint8),
                "velocity": spaces.Box(-speed, speed, dtype=np.float32),
            }
        )
        self._view = _view_points()

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Observation, dict[str, Any]]:
        """Start an episode with an empty map."""
        super().reset(seed=seed)
        robot_seed = int(self.np_random.integers(2**31))
        observation, info = self._robot.reset(seed=robot_seed, options=options)
        start = (options or {}).get("start")
        truth = truth_of_plan(self._robot.plan, resolution=MAP_RESOLUTION, start=start)
        self._floor = float(np.count_nonzero(truth.visible_free)) * MAP_RESOLUTION**2
        if self._floor == 0.0:
            raise TestbedError(f"world {self._robot.plan.name}: no floor to see; must have some")
        self._meter = CoverageMeter(truth)
        self._mapper = make_mapper(
            self._mapper_name, start_pose_map=info["pose_world"], resolution=MAP_RESOLUTION
        )
        self._map(observation)
        self._coverage = self._meter.measure(self._mapper.grid)
        return self._seen(observation), self._told(info, 0.0, 0.0, 0.0)

    def step(self, action: Action) -> tuple[Observation, float, bool, bool, dict[str, Any]]:
        """Drive for one control period and map what was seen."""
        observation, _, toppled, _, info = self._robot.step(action)
        self._map(observation)
        before, self._coverage = self._coverage, self._meter.measure(self._mapper.grid)
        area = (self._coverage - before) * self._floor
        done, touched = self._coverage >= DONE_COVERAGE, info["contacts"] > 0
        done_reward = DONE_REWARD if done and not touched else 0.0
        contact_reward = CONTACT_REWARD if touched else 0.0
        info = self._told(info, area, done_reward, contact_reward)
        reward = area + done_reward + contact_reward
        return self._seen(observation), reward, bool(done or touched or toppled), False, info

    def render(self) -> NDArray[np.uint8] | None:
        """The picture of this moment, as the robot's environment draws it."""
        return self._robot.render()

    def close(self) -> None:
        """Give the OpenGL context back."""
        self._robot.close()

    def _map(self, observation: Observation) -> None:
        self._mapper.update(
            LaserScan.from_observation(observation),
            Odometry.from_observation(observation),
            Imu.from_observation(observation),
        )

    def _seen(self, observation: Observation) -> Observation:
        limits = self.observation_space["velocity"].high
        velocity = observation["odometry"][-1, 4:6].astype(np.float32)
        return {
            "ranges": observation["ranges"],
            "map": self._map_ahead(),
            "velocity": np.clip(velocity, -limits, limits),
        }

    def _map_ahead(self) -> NDArray[np.uint8]:
        """The map around the robot, turned so that ahead is up."""
        grid = self._mapper.grid
        cells = grid.world_to_cell(transform_points(self._mapper.pose_map, self._view))
        inside = grid.contains(cells)
        log_odds = np.zeros(len(cells), dtype=np.float32)
        log_odds[inside] = grid.log_odds[cells[inside, 0], cells[inside, 1]]
        shades = np.full(len(cells), SHADE_UNKNOWN, dtype=np.uint8)
        shades[log_odds < grid.config.free_below] = SHADE_FREE
        shades[log_odds > grid.config.occupied_above] = SHADE_OCCUPIED
        return shades.reshape(VIEW_CELLS, VIEW_CELLS)

    def _told(
        self, info: dict[str, Any], area: float, done: float, contact: float
    ) -> dict[str, Any]:
        return {
            **info,
            "coverage": self._coverage,
            "reward_area": area,
            "reward_done": done,
            "reward_contact": contact,
        }


def _view_points() -> NDArray[np.float64]:
    """Centres ``(n, 2)`` of the observed cells in base_footprint [m], row by row from ahead."""
    steps = (VIEW_CELLS / 2 - 0.5 - np.arange(VIEW_CELLS)) * MAP_RESOLUTION
    ahead, left = np.meshgrid(steps, steps, indexing="ij")
    return np.column_stack((ahead.ravel(), left.ravel()))
