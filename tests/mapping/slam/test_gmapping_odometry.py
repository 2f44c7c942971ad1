import numpy as np
import pytest

from mapping.geometry import between
from mapping.messages import Odometry, Twist
from mapping.slam.gmapping_motion import SIDEWAYS, sample_motion
from mapping.slam.gmapping_odometry import SteadyOdometry


def message(
    stamp: float, x: float, y: float = 0.0, yaw: float = 0.0, speed: float = 0.2
) -> Odometry:
    return Odometry(stamp=stamp, pose_odom=np.array([x, y, yaw]), twist=Twist(linear_x=speed))


def test_odometry_without_jumps_stays_as_it_is() -> None:
    messages = [message(0.1 * k, 0.02 * k, yaw=0.25 * k) for k in range(20)]
    for told, steady in zip(messages, SteadyOdometry(2.0).steady(messages), strict=True):
        assert steady.pose_odom == pytest.approx([*told.pose_odom[:2], _wrapped(told.pose_odom[2])])


@pytest.mark.parametrize("jump", [(5.0, 0.0, 0.0), (-3.0, 4.0, 2.0), (0.0, 0.0, 3.0)])
def test_a_jump_is_read_on_from_where_the_robot_was(jump: tuple[float, float, float]) -> None:
    messages = [message(0.0, 1.0), message(0.1, 1.02)]
    x, y, yaw = np.array([1.02, 0.0, 0.0]) + jump
    c, s = np.cos(yaw), np.sin(yaw)
    messages += [message(0.2, x, y, yaw), message(0.3, x + 0.1 * c, y + 0.1 * s, yaw)]
    odometry = SteadyOdometry(2.0)
    steady = list(odometry.steady(messages))
    assert odometry.jumps == 1
    assert steady[2].pose_odom == pytest.approx([1.02, 0.0, 0.0])
    assert steady[3].pose_odom == pytest.approx([1.12, 0.0, 0.0])


def test_a_long_way_after_a_long_time_is_no_jump() -> None:
    odometry = SteadyOdometry(2.0)
    steady = list(odometry.steady([message(0.0, 0.0), message(5.0, 5.0, yaw=3.0)]))
    assert odometry.jumps == 0
    assert between(steady[0].pose_odom, steady[1].pose_odom) == pytest.approx([5.0, 0.0, 3.0])


def test_messages_that_are_not_finite_or_not_newer_are_left_out() -> None:
    bad = [message(np.nan, 0.0), message(0.1, np.inf), message(0.1, 0.0, speed=np.nan)]
    steady = list(SteadyOdometry(2.0).steady([message(0.0, 0.0), *bad, message(-1.0, 0.0)]))
    assert len(steady) == 1


def test_a_twist_that_no_robot_has_is_taken_as_standing_still() -> None:
    (steady,) = SteadyOdometry(2.0).steady([message(0.0, 0.0, speed=1e9)])
    assert steady.twist == Twist()


def test_the_motion_models_spread_is_as_its_settings_say() -> None:
    rng = np.random.default_rng(0)
    step, noise = np.array([0.4, -0.1, 0.3]), {"srr": 0.1, "srt": 0.2, "str_": 0.05, "stt": 0.3}
    start = np.array([1.0, 2.0, 0.0])
    poses = sample_motion(
        np.tile(start, (20_000, 1)), step, **noise, normals=rng.standard_normal((20_000, 3))
    )
    expected = [
        0.1 * 0.4 + SIDEWAYS * 0.1 * 0.1 + 0.05 * 0.3,
        0.1 * 0.1 + SIDEWAYS * 0.1 * 0.4 + 0.05 * 0.3,
        0.3 * 0.3 + 0.2 * np.hypot(0.4, 0.1),
    ]
    # of 20,000 samples a deviation is known to 0.5 %, a mean to 0.7 % of it
    assert poses.std(axis=0) == pytest.approx(expected, rel=0.03)
    assert np.all(np.abs(poses.mean(axis=0) - start - step) < 0.03 * np.array(expected))


def _wrapped(angle: float) -> float:
    return float(np.pi - (np.pi - angle) % (2.0 * np.pi))
