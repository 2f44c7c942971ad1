"""The follower on a robot that does exactly what it is told."""

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from mapping.errors import TestbedError
from mapping.geometry import wrap_to_pi
from mapping.messages import Twist
from nav.motion_limits import MotionLimits
from nav.path_follower import FollowerConfig, PathFollower


def drive(follower: PathFollower, pose: np.ndarray, seconds: float, clearance: float) -> np.ndarray:
    """Poses ``(n, 3)`` of a robot that follows the commands to the letter."""
    poses = [pose]
    for _ in range(round(seconds / 0.1)):
        twist = follower.command(pose, clearance)
        follower.last = twist
        yaw = pose[2] + 0.05 * twist.angular_z
        pose = pose + [
            0.1 * twist.linear_x * np.cos(yaw),
            0.1 * twist.linear_x * np.sin(yaw),
            0.1 * twist.angular_z,
        ]
        pose[2] = wrap_to_pi(pose[2])
        poses.append(pose)
    return np.array(poses)


def distance_to_path(poses: np.ndarray, path: np.ndarray) -> np.ndarray:
    shares = np.linspace(0.0, 1.0, 200)[:, None]
    dense = np.concatenate([a + shares * (b - a) for a, b in pairwise(path)])
    return np.hypot(*(poses[:, None, :2] - dense).transpose(2, 0, 1)).min(axis=1)


@pytest.mark.parametrize(("clearance", "bound"), [(0.5, 0.12), (0.13, 0.05)])
def test_a_right_angle_is_followed_closer_where_it_is_tight(clearance: float, bound: float) -> None:
    path = np.array([[0.0, 0.0], [1.5, 0.0], [1.5, 1.5]])
    follower = PathFollower()
    follower.set_path(path)
    poses = drive(follower, np.zeros(3), 60.0, clearance)
    assert distance_to_path(poses, path).max() < bound, "pure pursuit cuts by about lookahead / 3"
    assert np.hypot(*(poses[-1, :2] - path[-1])) < 0.05


def test_a_goal_behind_is_driven_to_backwards_and_back_again_forwards() -> None:
    follower = PathFollower()
    there = np.array([[0.0, 0.0], [-1.0, 0.1]])
    pose = np.zeros(3)
    for path, gear in ((there, -1.0), (there[::-1], 1.0)):
        follower.set_path(path)
        poses = drive(follower, pose, 12.0, 0.5)
        assert follower.gear == gear
        assert np.abs(poses[:, 2]).max() < 0.3, "it turns to the way, not round"
        assert distance_to_path(poses, path).max() < 0.03
        assert np.hypot(*(poses[-1, :2] - path[-1])) < 0.05
        pose = poses[-1]


def test_a_goal_behind_is_turned_to_on_the_spot_by_who_does_not_drive_backwards() -> None:
    follower = PathFollower(FollowerConfig(reverse_above=np.pi))
    follower.set_path(np.array([[0.0, 0.0], [-1.0, 0.0]]))
    poses = drive(follower, np.zeros(3), 1.0, 0.5)
    assert follower.gear == 1.0
    assert np.hypot(*poses[-1, :2]) < 0.01
    assert abs(poses[-1, 2]) > 0.5


@given(yaw=st.floats(-np.pi, np.pi))
@settings(max_examples=25, deadline=None)
def test_a_way_is_driven_alike_with_the_front_and_with_the_back_ahead(yaw: float) -> None:
    path = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 0.6]])
    follower, turned = PathFollower(), PathFollower()
    follower.set_path(path)
    turned.set_path(path)
    one = drive(follower, np.array([0.0, 0.0, yaw]), 12.0, 0.5)
    other = drive(turned, np.array([0.0, 0.0, wrap_to_pi(yaw + np.pi)]), 12.0, 0.5)
    for poses, path_follower in ((one, follower), (other, turned)):
        turns = np.abs(wrap_to_pi(np.diff(poses[:, 2])))
        still = np.hypot(*np.diff(poses[:, :2], axis=0).T) < 1e-3
        at_start = still & (np.hypot(*(poses[1:, :2] - path[0]).T) < 0.05)
        assert turns[at_start].sum() < FollowerConfig().reverse_above + 0.1
        assert distance_to_path(poses, path).max() < 0.12
        assert np.hypot(*(poses[-1, :2] - path[-1])) < 0.05
        assert path_follower.gear in (-1.0, 1.0)
    if np.abs(yaw) < 1.1 or np.abs(yaw) > 2.05:
        assert follower.gear == -turned.gear
        assert one[:, :2] == pytest.approx(other[:, :2], abs=1e-6)


@pytest.mark.parametrize("value", [1.5, np.nan])
def test_reversing_from_less_than_a_right_angle_is_refused(value: float) -> None:
    with pytest.raises(TestbedError, match=r"reverse_above: .*; must be above a right angle"):
        FollowerConfig(reverse_above=value)


@given(
    linear=st.floats(-1.0, 1.0),
    angular=st.floats(-5.0, 5.0),
    last_linear=st.floats(-0.21, 0.21),
    last_angular=st.floats(-MotionLimits().max_angular, MotionLimits().max_angular),
)
@settings(max_examples=100, deadline=None)
def test_speeds_and_accelerations_are_kept_but_braking_is_free(
    linear: float, angular: float, last_linear: float, last_angular: float
) -> None:
    limits = MotionLimits()
    last = Twist(linear_x=last_linear, angular_z=last_angular)
    next_one = limits.approach(Twist(linear_x=linear, angular_z=angular), last)
    assert abs(next_one.linear_x) <= limits.max_linear
    assert abs(next_one.angular_z) <= limits.max_angular
    gained = abs(next_one.linear_x) - abs(last_linear) * (next_one.linear_x * last_linear >= 0.0)
    assert gained <= limits.linear_acceleration * limits.period + 1e-9
    assert limits.approach(Twist(), last) == Twist()
    assert next_one.linear_x * last_linear >= 0.0


def test_distance_left_shrinks_to_nothing_along_the_way() -> None:
    follower = PathFollower()
    follower.set_path(np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0]]))
    assert follower.distance_left(np.zeros(3)) == pytest.approx(2.0)
    assert follower.distance_left(np.array([0.75, 0.0, 0.0])) == pytest.approx(1.25)
