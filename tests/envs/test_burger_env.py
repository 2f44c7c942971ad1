"""The environment keeps Gymnasium's contract and its own docstring's."""

import subprocess
import sys
import warnings
from typing import Any

import gymnasium as gym
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env
from hypothesis import given, settings
from hypothesis import strategies as st

from envs.burger_env import BurgerEnv
from envs.camera import SceneCamera
from envs.floor_plan import Box, FloorPlan, Wall
from envs.lidar_noise import LidarConfig
from mapping.errors import TestbedError
from mapping.messages import Imu, LaserScan, Odometry

ID = "envs:TurtleBot3Burger-v0"
ROOM = FloorPlan(
    name="room",
    start=(0.2, -0.3, 0.5),
    walls=(Wall(points=((-1.5, -1.5), (3.0, -1.5), (3.0, 3.0), (-1.5, 3.0)), closed=True),),
    boxes=(Box(center=(1.2, 1.3), size=(0.4, 0.2)),),
)
INFO_KEYS = {"pose_world", "velocity_base", "contacts", "contacts_by_people", "pedestrians"}
STRAIGHT = np.array((0.2, 0.0), dtype=np.float32)


@pytest.fixture(scope="module")
def env() -> BurgerEnv:
    return BurgerEnv(ROOM)


def same(first: dict[str, np.ndarray], second: dict[str, np.ndarray]) -> bool:
    return all(first[key].tobytes() == second[key].tobytes() for key in first)


def test_gymnasiums_checker_finds_nothing_but_the_physical_units_of_the_action() -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        # Commands are in m/s and rad/s on purpose, as /cmd_vel.
        warnings.filterwarnings("ignore", message=".*symmetric and normalized space.*")
        check_env(gym.make(ID, world=ROOM).unwrapped, skip_render_check=True)


def test_make_needs_no_other_import_and_importing_envs_loads_no_mujoco() -> None:
    code = (
        "import sys, gymnasium\n"
        "import envs\n"
        "assert 'mujoco' not in sys.modules and 'numba' not in sys.modules\n"
        f"env = gymnasium.make({ID!r})\n"
        "observation, info = env.reset(seed=1)\n"
        "assert observation in env.observation_space\n"
    )
    subprocess.run([sys.executable, "-c", code], check=True)


def test_it_runs_in_two_processes_at_once_with_the_results_of_one() -> None:
    vector = gym.make_vec(ID, num_envs=2, vectorization_mode="async", world=ROOM)
    try:
        vector.reset(seed=[3, 4])
        observations = vector.step(np.tile(STRAIGHT, (2, 1)))[0]
    finally:
        vector.close()
    alone = gym.make(ID, world=ROOM)
    alone.reset(seed=4)
    assert same(alone.step(STRAIGHT)[0], {key: row[1] for key, row in observations.items()})


def test_the_same_seed_gives_the_same_episode_and_the_next_one_differs() -> None:
    env = BurgerEnv(ROOM)
    first, _ = env.reset(seed=7)
    ahead = env.step(STRAIGHT)[0]
    other, _ = env.reset()
    again, _ = env.reset(seed=7)
    assert same(first, again)
    assert same(ahead, env.step(STRAIGHT)[0])
    assert not same(first, other)


@settings(deadline=None, max_examples=15)
@given(
    actions=st.lists(st.tuples(st.floats(-0.22, 0.22), st.floats(-2.84, 2.84)), max_size=12),
    seed=st.integers(0, 2**31 - 1),
)
def test_observations_stay_in_their_space_whatever_the_robot_does(
    env: BurgerEnv, actions: list[tuple[float, float]], seed: int
) -> None:
    observation, info = env.reset(seed=seed)
    assert observation in env.observation_space
    keys = set(info)
    for action in actions:
        observation, reward, terminated, truncated, info = env.step(np.array(action, np.float32))
        assert observation in env.observation_space
        assert (reward, terminated, truncated) == (0.0, False, False)
        assert set(info) == keys == INFO_KEYS


def test_the_first_observation_has_a_whole_scan_taken_standing_at_the_start() -> None:
    env = BurgerEnv(ROOM, lidar="ideal", odometry="ideal")
    observation, info = env.reset(seed=0)
    np.testing.assert_allclose(info["pose_world"], ROOM.start, atol=1e-3)
    assert observation["time"][0] == pytest.approx(0.2)
    assert observation["scan_stamp"][0] == 0.0
    # Ahead of (0.2 - 0.032 cos, -0.3 - 0.032 sin) at 0.5 rad the wall x = 2.95 is 3.165 m away.
    assert observation["ranges"][0] == pytest.approx((2.95 - 0.2) / np.cos(0.5) + 0.032, abs=1e-3)


def test_messages_read_the_observation() -> None:
    env = BurgerEnv(ROOM, lidar="ideal")
    env.reset(seed=0)
    for _ in range(3):
        observation = env.step(STRAIGHT)[0]
    scan = LaserScan.from_observation(observation)
    assert scan is not None
    assert scan.stamp == pytest.approx(0.2)
    assert np.isinf(scan.ranges).any()
    assert np.isinf(scan.ranges).sum() == (observation["ranges"] == np.float32(3.5)).sum()
    assert len(Odometry.from_observation(observation)) == 3
    assert Imu.from_observation(observation)[-1].stamp == pytest.approx(observation["time"][0])


def test_with_no_return_zero_open_space_reads_zero() -> None:
    env = BurgerEnv(ROOM, lidar=LidarConfig(no_return="zero"))
    ranges = env.reset(seed=0)[0]["ranges"]
    assert (ranges == 0.0).sum() > 10
    assert ranges.max() <= 3.5


def test_a_scan_is_repeated_until_the_next_is_whole() -> None:
    env = BurgerEnv(ROOM)
    env.reset(seed=0)
    stamps = [float(env.step(STRAIGHT)[0]["scan_stamp"][0]) for _ in range(5)]
    np.testing.assert_allclose(stamps, (0.0, 0.2, 0.2, 0.4, 0.4))


def test_observations_are_copies() -> None:
    env = BurgerEnv(ROOM)
    observation, _ = env.reset(seed=0)
    observation["ranges"][:] = -1.0
    assert env.step(STRAIGHT)[0]["ranges"].min() >= 0.0


def test_options_choose_start_and_world() -> None:
    env = BurgerEnv(ROOM)
    _, info = env.reset(seed=0, options={"start": (1.0, 0.0, -1.0)})
    np.testing.assert_allclose(info["pose_world"], (1.0, 0.0, -1.0), atol=1e-3)
    env.reset(options={"world": "empty_room"})
    assert env.plan.name == "empty_room"
    env.reset()
    assert env.plan.name == "empty_room"


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"start": (1.2, 1.3, 0.0)}, r"start: .*inside boxes\[0\]"),
        ({"start": (np.nan, 0.0, 0.0)}, "start: .*finite"),
        ({"start": (0.0, 0.0)}, "start: .*three numbers"),
        ({"start": (30.0, 0.0, 0.0)}, r"start: \(30, 0\) is off the plan; must be x -1.55 to 3.05"),
        ({"world": "atlantis"}, "atlantis"),
        ({"pose": (0.0, 0.0, 0.0)}, "reset option: 'pose'"),
    ],
)
def test_options_that_make_no_sense_are_refused(options: dict[str, object], message: str) -> None:
    with pytest.raises(TestbedError, match=message):
        BurgerEnv(ROOM).reset(options=options)


@pytest.mark.parametrize("action", [(np.nan, 0.0), (0.1, 0.0, 0.0), 0.1])
def test_an_action_that_makes_no_sense_is_refused(action: object) -> None:
    env = BurgerEnv(ROOM)
    env.reset(seed=0)
    with pytest.raises(TestbedError, match=r"(command|action): .*must be"):
        env.step(np.array(action, dtype=np.float32))


def test_a_render_mode_that_is_not_there_is_refused() -> None:
    with pytest.raises(TestbedError, match="render_mode: 'ascii'"):
        BurgerEnv(ROOM, render_mode="ascii")


def test_rendering_gives_a_picture_only_when_asked_for(monkeypatch: pytest.MonkeyPatch) -> None:
    picture = np.zeros((480, 640, 3), dtype=np.uint8)
    monkeypatch.setattr(SceneCamera, "picture", lambda *_: picture)
    env = BurgerEnv(ROOM, render_mode="rgb_array")
    env.reset(seed=0)
    assert env.render() is picture
    assert BurgerEnv(ROOM).render() is None
    env.close()
    env.close()


def test_odometry_yaw_chooses_the_source_of_the_heading() -> None:
    wheels = BurgerEnv(ROOM, odometry="poor", odometry_yaw="encoders", imu="ideal")
    gyro = BurgerEnv(ROOM, odometry="poor", odometry_yaw="imu", imu="ideal")
    errors = []
    for env in (wheels, gyro):
        _, info = env.reset(seed=2)
        start = info["pose_world"][2]
        for _ in range(30):
            observation, *_, info = env.step(np.array((0.0, 1.0), dtype=np.float32))
        turned = np.mod(info["pose_world"][2] - start, 2.0 * np.pi)
        errors.append(abs(np.mod(observation["odometry"][-1, 3], 2.0 * np.pi) - turned))
    assert errors[1] < 0.01 < errors[0]


@pytest.mark.parametrize(
    ("wrong", "told"),
    [
        ({"people": 1.5}, "people: 1.5; must be from 0 to 100, a whole number"),
        ({"people": "3"}, "people: 3; must be"),
        ({"camera": "nope"}, "camera: 'nope'; must be one of chase, portrait, top"),
    ],
)
def test_what_it_cannot_be_made_with_is_told_at_once(wrong: dict[str, Any], told: str) -> None:
    with pytest.raises(TestbedError, match=told):
        BurgerEnv(ROOM, **wrong)
