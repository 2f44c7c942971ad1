"""The two tasks keep Gymnasium's contract, pay what they say, and end when they say."""

import math
import warnings
from typing import Any

import gymnasium as gym
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env

from envs.burger_env import BurgerEnv
from envs.explore_env import VIEW_CELLS, ExploreEnv
from envs.floor_plan import Box, FloorPlan, Wall
from envs.navigate_env import GOAL_RADIUS, NEAREST_GOAL, NavigateEnv
from mapping.errors import TestbedError

ROOM = FloorPlan(
    name="room",
    start=(0.0, 0.0, 0.0),
    walls=(Wall(points=((-1.0, -1.5), (3.0, -1.5), (3.0, 2.0), (-1.0, 2.0)), closed=True),),
    boxes=(Box(center=(1.2, 1.3), size=(0.4, 0.2)),),
)
AHEAD = np.array((0.2, 0.0), dtype=np.float32)
LEFT = np.array((0.0, 1.0), dtype=np.float32)


@pytest.mark.parametrize("name", ["BurgerExplore-v0", "BurgerNavigate-v0"])
def test_gymnasiums_checker_finds_nothing_but_the_physical_units(name: str) -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        # Commands are in m/s and rad/s on purpose, as /cmd_vel.
        warnings.filterwarnings("ignore", message=".*symmetric and normalized space.*")
        check_env(gym.make(f"envs:{name}", world=ROOM).unwrapped, skip_render_check=True)


def run_out(env: gym.Env[Any, Any], action: np.ndarray, steps: int) -> tuple[float, dict[str, Any]]:
    """Sum of rewards and the last info of an episode that repeats one action."""
    total = 0.0
    for _ in range(steps):
        _, reward, terminated, _, info = env.step(action)
        terms = sum(value for key, value in info.items() if key.startswith("reward_"))
        assert reward == pytest.approx(terms)
        total += reward
        if terminated:
            break
    return total, info


def test_driving_to_the_goal_pays_the_way_and_the_arrival() -> None:
    env = NavigateEnv(ROOM, odometry="ideal", odometry_yaw="encoders", lidar="ideal")
    observation, _ = env.reset(seed=1, options={"goal": (1.5, 0.0)})
    assert observation["goal"] == pytest.approx([1.5, 1.0, 0.0], abs=0.01)
    total, info = run_out(env, AHEAD, 100)
    assert info["reward_goal"] == 10.0
    assert total == pytest.approx(10.0 + 1.5 - GOAL_RADIUS, abs=0.05)


def test_a_goal_to_the_left_lies_to_the_left_until_the_robot_has_turned() -> None:
    env = NavigateEnv(ROOM, odometry="ideal", odometry_yaw="encoders")
    observation, _ = env.reset(seed=1, options={"goal": (0.0, 1.2)})
    assert observation["goal"][2] == pytest.approx(1.0, abs=0.01)
    for _ in range(16):
        observation, *_ = env.step(LEFT)
    assert observation["goal"][1] > 0.99


def test_driving_into_the_wall_costs_and_ends_the_episode() -> None:
    near_the_wall = {"start": (2.5, 0.0, 0.0)}
    for env, goal in ((NavigateEnv(ROOM), {"goal": (-0.6, 1.2)}), (ExploreEnv(ROOM), {})):
        env.reset(seed=2, options={**near_the_wall, **goal})
        _, info = run_out(env, AHEAD, 60)
        assert info["reward_contact"] == -10.0


def test_goals_are_drawn_in_reach_far_enough_and_by_the_seed() -> None:
    env = NavigateEnv(ROOM)
    goals = [env.reset(seed=seed)[1]["goal_world"] for seed in range(20)]
    assert all(np.hypot(*goal) >= NEAREST_GOAL for goal in goals)
    assert all(-1.0 < x < 3.0 and -1.5 < y < 2.0 for x, y in goals)
    assert len({tuple(goal) for goal in goals}) > 15
    assert np.array_equal(env.reset(seed=3)[1]["goal_world"], goals[3])


@pytest.mark.parametrize("goal", [(9.0, 9.0), (1.0,), "there"])
def test_a_goal_out_of_reach_is_refused(goal: object) -> None:
    with pytest.raises(TestbedError, match="goal"):
        NavigateEnv(ROOM).reset(options={"goal": goal})


def test_what_is_paid_for_exploring_is_the_floor_that_was_seen() -> None:
    env = ExploreEnv(ROOM, odometry="truth", lidar="ideal")
    _, first = env.reset(seed=0)
    total, info = run_out(env, LEFT, 80)
    floor = 3.9 * 3.4 - 0.4 * 0.2
    paid = total - info["reward_done"]
    assert paid == pytest.approx((info["coverage"] - first["coverage"]) * floor, rel=0.02)
    assert info["coverage"] > 0.9, "one turn in the middle of a small room shows most of it"


def test_the_observed_map_turns_with_the_robot() -> None:
    env = ExploreEnv(ROOM, odometry="truth", lidar="ideal")
    env.reset(seed=0)
    for _ in range(12):
        observation, *_ = env.step(np.zeros(2, dtype=np.float32))
    middle = VIEW_CELLS // 2
    wall_behind = observation["map"][middle + 17 : middle + 22, middle]  # 0.95 m behind
    assert (wall_behind == 255).any()
    assert (observation["map"][middle - 30 : middle - 2, middle] == 127).all(), "free ahead"
    for _ in range(16):
        observation, *_ = env.step(np.array((0.0, np.pi / 1.6), dtype=np.float32))
    turned = observation["map"][middle - 22 : middle - 16, middle - 1 : middle + 2]
    assert (turned == 255).any(), "half a turn brings the near wall ahead"


def test_a_start_in_another_room_has_its_goals_and_its_floor_there() -> None:
    def square(x: float) -> Wall:
        return Wall(points=((x, 0.0), (x + 3.0, 0.0), (x + 3.0, 3.0), (x, 3.0)), closed=True)

    rooms = FloorPlan(name="rooms", start=(1.0, 1.0, 0.0), walls=(square(0.0), square(5.0)))
    there = {"start": (6.5, 1.5, 0.0)}
    _, info = NavigateEnv(rooms).reset(seed=0, options=there)
    assert info["goal_world"][0] > 5.0
    explore = ExploreEnv(rooms)
    explore.reset(seed=0, options=there)
    assert run_out(explore, LEFT, 20)[1]["coverage"] > 0.5


@pytest.mark.parametrize("kind", [BurgerEnv, ExploreEnv, NavigateEnv])
def test_an_episode_ends_when_the_robot_has_toppled(kind: type[gym.Env[Any, Any]]) -> None:
    env = kind(ROOM)  # type: ignore[call-arg]
    env.reset(seed=1)
    assert not env.step(AHEAD)[2]
    robot = env if isinstance(env, BurgerEnv) else env._robot  # type: ignore[attr-defined]
    qpos, _ = robot.scene_state
    qpos[2:7] = (0.1, math.sqrt(0.5), math.sqrt(0.5), 0.0, 0.0)
    _, _, terminated, truncated, _ = env.step(AHEAD)
    assert terminated
    assert not truncated
