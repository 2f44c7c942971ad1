"""Point-goal navigation: drive to a random place without hitting anything."""

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
from mapping.errors import TestbedError
from mapping.geometry import compose, inverse, transform_points

GOAL_RADIUS = 0.3
"""Distance to the goal at which it is reached [m] (turtlebot3_dqn_world: the goal's disc)."""
NEAREST_GOAL = 1.0
"""Goals are drawn at least this far from the start [m]."""
GOAL_REWARD, CONTACT_REWARD = 10.0, -10.0
RESOLUTION = 0.05
"""Edge of the cells that goals are drawn from [m]."""
_FARTHEST = 1000.0


class NavigateEnv(gym.Env[Observation, Action]):  # type: ignore[misc]  # mypy skips gymnasium
    """A TurtleBot3 Burger that is to drive to a goal it knows the direction of.

    ``envs:BurgerNavigate-v0``. World, robot, sensors, action space and step are those of
    ``envs:TurtleBot3Burger-v0``; its keyword arguments are taken and passed on.

    ## Observation space

    | key | type | meaning |
    |---|---|---|
    | ``ranges`` | (360,) float32 | the newest whole scan [m], 3.5 = nothing, 0.0 = failed |
    | ``goal`` | (3,) float32 | distance [m], cosine and sine of the bearing from straight ahead |
    | ``velocity`` | (2,) float32 | forward speed [m/s] and turn rate [rad/s] |

    The goal's place is known in the frame where the robot started; distance and bearing come from
    odometry, with its errors. So does the velocity.

    ## Reward, termination, truncation

    The sum of ``reward_progress`` (true metres nearer to the goal), ``reward_goal`` (10 on arrival
    within 0.3 m) and ``reward_contact`` (-10 on hitting anything), each told in ``info``. Arrival
    and contact terminate; ``TimeLimit`` truncates after 60 s by default.

    ## Info and options

    ``info`` is that of the robot's environment, the reward's terms, and ``goal_world`` (2,) [m].
    ``reset(options={"goal": (x, y)})`` sets the goal; else a place that the robot can reach, at
    least 1 m away, is drawn. ``start`` and ``world`` are passed on.

    Raises:
        TestbedError: A name or figure is not usable, a goal cannot be reached, or there is none.
    """

    metadata: ClassVar[dict[str, Any]] = BurgerEnv.metadata

    def __init__(
        self, world: str | Path | FloorPlan = "turtlebot3_world", **robot_settings: Any
    ) -> None:
        self._robot = BurgerEnv(world, **robot_settings)
        self.render_mode = self._robot.render_mode
        self.action_space = self._robot.action_space
        speed = np.array([10.0 * MAX_LINEAR_SPEED, 10.0 * MAX_ANGULAR_SPEED], dtype=np.float32)
        goal_high = np.array([_FARTHEST, 1.0, 1.0], dtype=np.float32)
        goal_low = np.array([0.0, -1.0, -1.0], dtype=np.float32)
        self.observation_space = spaces.Dict(
            {
                "ranges": self._robot.observation_space["ranges"],
                "goal": spaces.Box(goal_low, goal_high, dtype=np.float32),
                "velocity": spaces.Box(-speed, speed, dtype=np.float32),
            }
        )

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Observation, dict[str, Any]]:
        """Start an episode with a goal; see the class for ``options``."""
        super().reset(seed=seed)
        options = dict(options or {})
        goal = options.pop("goal", None)
        robot_seed = int(self.np_random.integers(2**31))
        observation, info = self._robot.reset(seed=robot_seed, options=options)
        self._start, self._begin = info["pose_world"], options.get("start")
        self._goal = self._checked_goal(goal) if goal is not None else self._draw_goal()
        self._distance = float(np.hypot(*(self._goal - self._start[:2])))
        return self._seen(observation), self._told(info, 0.0, 0.0, 0.0)

    def step(self, action: Action) -> tuple[Observation, float, bool, bool, dict[str, Any]]:
        """Drive for one control period."""
        observation, _, toppled, _, info = self._robot.step(action)
        distance = float(np.hypot(*(self._goal - info["pose_world"][:2])))
        progress, self._distance = self._distance - distance, distance
        arrived, touched = distance < GOAL_RADIUS, info["contacts"] > 0
        goal_reward = GOAL_REWARD if arrived and not touched else 0.0
        contact_reward = CONTACT_REWARD if touched else 0.0
        info = self._told(info, progress, goal_reward, contact_reward)
        reward = progress + goal_reward + contact_reward
        return self._seen(observation), reward, bool(arrived or touched or toppled), False, info

    def render(self) -> NDArray[np.uint8] | None:
        """The picture of this moment, as the robot's environment draws it."""
        return self._robot.render()

    def close(self) -> None:
        """Give the OpenGL context back."""
        self._robot.close()

    def _seen(self, observation: Observation) -> Observation:
        newest = observation["odometry"][-1]
        pose_world = compose(self._start, newest[1:4])
        x, y = transform_points(inverse(pose_world), self._goal[None])[0]
        distance = float(np.hypot(x, y))
        bearing = np.arctan2(y, x)
        limits = self.observation_space["velocity"].high
        return {
            "ranges": observation["ranges"],
            "goal": np.array(
                (min(distance, _FARTHEST), np.cos(bearing), np.sin(bearing)), dtype=np.float32
            ),
            "velocity": np.clip(newest[4:6].astype(np.float32), -limits, limits),
        }

    def _told(
        self, info: dict[str, Any], progress: float, goal: float, contact: float
    ) -> dict[str, Any]:
        return {
            **info,
            "goal_world": self._goal.copy(),
            "reward_progress": progress,
            "reward_goal": goal,
            "reward_contact": contact,
        }

    def _reachable(self) -> NDArray[np.float64]:
        """Centres ``(n, 2)`` of the cells that the robot's centre can reach [m]."""
        truth = truth_of_plan(self._robot.plan, resolution=RESOLUTION, start=self._begin)
        cells = np.argwhere(truth.reachable)[:, ::-1]
        places: NDArray[np.float64] = np.array(truth.origin) + (cells + 0.5) * truth.resolution
        return places

    def _draw_goal(self) -> NDArray[np.float64]:
        places = self._reachable()
        far = places[np.hypot(*(places - self._start[:2]).T) >= NEAREST_GOAL]
        if len(far) == 0:
            raise TestbedError(
                f"world {self._robot.plan.name}: nothing reachable {NEAREST_GOAL} m from the "
                "start; must have room for a goal"
            )
        return np.asarray(far[self.np_random.integers(len(far))])

    def _checked_goal(self, goal: Any) -> NDArray[np.float64]:
        """A goal from the options, or one line that says what is wrong with it."""
        try:
            x, y = (float(value) for value in goal)
        except (TypeError, ValueError) as error:
            raise TestbedError(f"goal: {goal!r}; must be two numbers (x, y)") from error
        gaps = np.hypot(*(self._reachable() - (x, y)).T)
        if not (len(gaps) and gaps.min() <= GOAL_RADIUS):
            raise TestbedError(f"goal: ({x:g}, {y:g}); must lie within 0.3 m of a reachable place")
        return np.array((x, y))
