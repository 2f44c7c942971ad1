"""The kidnapped robot: it stands elsewhere, and none of its sensors but the lidar noticed."""

import numpy as np
import pytest

from envs.burger_env import BurgerEnv
from mapping.errors import TestbedError

ELSEWHERE = (0.5, -0.5, 2.0)


def test_only_the_lidar_notices() -> None:
    environment = BurgerEnv("turtlebot3_world", odometry_yaw="imu")
    environment.reset(seed=3)
    for _ in range(10):
        before, _, _, _, _ = environment.step(np.array([0.2, 0.3], dtype=np.float32))
    environment.carry_off(ELSEWHERE)
    stand = np.zeros(2, dtype=np.float32)
    after, _, _, _, info = environment.step(stand)
    assert info["pose_world"] == pytest.approx(np.array(ELSEWHERE), abs=0.01)
    assert after["time"][0] == pytest.approx(before["time"][0] + 0.1)
    moved = np.abs(after["odometry"][:, 1:4] - before["odometry"][-1, 1:4])
    # the robot was slowing down from 0.2 m/s; carried, it would have moved by metres
    assert moved.max() < 0.03
    assert np.abs(after["imu"][:, 5:8]).max() < 0.05
    assert np.abs(after["imu"][:, 8:11] - [0.0, 0.0, 9.81]).max() < 1.0
    ranges = environment.step(stand)[0]["ranges"]
    ranges = environment.step(stand)[0]["ranges"]
    fresh = BurgerEnv("turtlebot3_world").reset(seed=4, options={"start": ELSEWHERE})[0]["ranges"]
    assert np.median(np.abs(ranges - fresh)) < 0.05
    environment.close()


def test_it_cannot_be_put_into_a_wall() -> None:
    environment = BurgerEnv("turtlebot3_world")
    environment.reset(seed=0)
    with pytest.raises(TestbedError, match="start"):
        environment.carry_off((0.0, 0.0, 0.0))
    environment.close()
