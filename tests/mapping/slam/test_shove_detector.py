"""Shoves are noticed, and the robot's own jerks are none."""

import numpy as np
import pytest

from envs.burger_env import BurgerEnv
from envs.floor_plan import FloorPlan, Wall
from mapping.messages import Imu, Odometry, Twist
from mapping.slam.shove_detector import SHOVE_TIME, ShoveDetector

PERIOD = 0.1
HALL = FloorPlan(
    name="hall",
    start=(0.0, 0.0, 0.0),
    walls=(Wall(points=((-5.0, -5.0), (5.0, -5.0), (5.0, 5.0), (-5.0, 5.0)), closed=True),),
)


def odometry(stamp: float, speed: float) -> Odometry:
    return Odometry(stamp=stamp, pose_odom=np.zeros(3), twist=Twist(linear_x=speed))


def imu(stamp: float, ahead: float, aside: float = 0.0) -> Imu:
    return Imu(
        stamp=stamp,
        orientation=np.array([0.0, 0.0, 0.0, 1.0]),
        angular_velocity=np.zeros(3),
        linear_acceleration=np.array([ahead, aside, 9.81]),
    )


@pytest.mark.parametrize(("ahead", "aside"), [(3.6, 0.0), (-3.6, 0.0), (2.6, -2.6)])
def test_a_jolt_that_the_wheels_know_nothing_of_is_a_shove_for_a_second(
    ahead: float, aside: float
) -> None:
    detector = ShoveDetector()
    shoved = []
    for k in range(20):
        stamp = (k + 1) * PERIOD
        jolt = imu(stamp, ahead, aside) if k == 3 else imu(stamp, 0.1)
        detector.add([odometry(stamp, 0.2)], [jolt])
        shoved.append(detector.is_shoved)
    first = shoved.index(True)
    assert first == 3
    assert sum(shoved) == pytest.approx(SHOVE_TIME / PERIOD, abs=1)


def test_the_same_jolt_as_the_wheels_are_thrown_into_reverse_is_none_but_a_harder_one_is() -> None:
    for jolt, expected in ((-3.6, False), (-20.0, True)):
        detector = ShoveDetector()
        detector.add([odometry(0.1, 0.2)], [imu(0.1, 0.1)])
        detector.add([odometry(0.2, -0.1)], [imu(0.2, jolt)])
        assert detector.is_shoved is expected


def test_after_the_robot_has_come_to_rest_the_same_jolt_is_a_shove_again() -> None:
    detector = ShoveDetector()
    for k in range(10):
        stamp = (k + 1) * PERIOD
        detector.add([odometry(stamp, 0.2 if k < 2 else 0.0)], [imu(stamp, 0.0)])
    detector.add([odometry(1.1, 0.0)], [imu(1.1, 3.6)])
    assert detector.is_shoved


def test_without_an_imu_nothing_is_a_shove() -> None:
    detector = ShoveDetector()
    for k in range(10):
        detector.add([odometry(k * PERIOD, 0.2 * (-1.0) ** k)], [])
    assert not detector.is_shoved


def test_speeds_and_stamps_that_are_no_numbers_hide_no_shove() -> None:
    detector = ShoveDetector()
    for stamp, speed in ((0.1, np.nan), (np.nan, 0.2), (0.2, np.inf)):
        detector.add([odometry(stamp, speed)], [])
    detector.add([odometry(0.3, 0.2)], [imu(0.3, 4.0)])
    assert detector.is_shoved


def test_after_time_ran_backwards_only_what_came_since_counts() -> None:
    detector = ShoveDetector()
    detector.add([odometry(100.0, 0.2), odometry(1.0, 0.0)], [imu(1.0, 4.0)])
    assert detector.is_shoved


def test_a_robot_thrown_about_by_its_own_wheels_is_never_shoved() -> None:
    """Random commands to both ends of what the firmware takes, in the simulator."""
    env, detector, rng = BurgerEnv(HALL), ShoveDetector(), np.random.default_rng(0)
    observation, info = env.reset(seed=0)
    hardest = 0.0
    for k in range(600):
        if k % 3 == 0:
            speed = 0.22 * rng.choice([-1.0, 0.0, 1.0])
            command = np.array([speed, rng.uniform(-2.84, 2.84)], dtype=np.float32)
        observation, _, _, _, info = env.step(command)
        messages = Imu.from_observation(observation)
        detector.add(Odometry.from_observation(observation), messages)
        hardest = max(hardest, *(abs(float(each.linear_acceleration[0])) for each in messages))
        assert not detector.is_shoved, f"at {(k + 1) * PERIOD:.1f} s"
    env.close()
    assert info["contacts"] == 0
    assert hardest > 3.5, "or it was not thrown about"
