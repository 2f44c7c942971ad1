import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from mapping.errors import TestbedError
from mapping.geometry import between, compose
from mapping.trajectory import Trajectory, completed, path_length, poses_at

STAMPS = np.linspace(0.0, 10.0, 101)


def circle() -> Trajectory:
    """One turn of radius 1 m, heading along it."""
    turn = 2.0 * np.pi * STAMPS / 10.0
    poses = np.column_stack((np.cos(turn), np.sin(turn), turn + np.pi / 2.0))
    return Trajectory(stamps=STAMPS, poses=compose(np.zeros(3), poses))


def every(nth: int, trajectory: Trajectory) -> Trajectory:
    return Trajectory(stamps=trajectory.stamps[::nth], poses=trajectory.poses[::nth])


@given(
    frame=st.tuples(st.floats(-50, 50), st.floats(-50, 50), st.floats(-3, 3)),
    nth=st.integers(1, 60),
)
@settings(max_examples=30, deadline=None)
def test_odometry_without_error_fills_the_gaps_exactly_in_any_frame(
    frame: tuple[float, float, float], nth: int
) -> None:
    odometry = circle()
    truth = Trajectory(stamps=STAMPS, poses=compose(frame, odometry.poses))
    filled = completed(every(nth, truth), odometry)
    assert np.allclose(between(filled.poses, truth.poses), 0.0, atol=1e-9)


def test_a_pose_that_is_known_stays_as_it_is() -> None:
    known = every(10, circle())
    bent = circle().poses + np.column_stack((STAMPS, 0.1 * STAMPS**2, 0.05 * STAMPS))
    filled = completed(known, Trajectory(stamps=STAMPS, poses=bent))
    assert np.allclose(between(filled.poses[::10], known.poses), 0.0, atol=1e-9)


def test_a_slip_is_spread_over_the_time_in_which_it_came_about() -> None:
    standing = Trajectory(stamps=np.arange(5.0), poses=np.zeros((5, 3)))
    known = Trajectory(stamps=np.array([0.0, 4.0]), poses=np.array([[0, 0, 0], [0.4, 0, 0.2]]))
    filled = completed(known, standing)
    assert np.allclose(filled.poses[:, 0], [0.0, 0.1, 0.2, 0.3, 0.4])
    assert np.allclose(filled.poses[:, 2], [0.0, 0.05, 0.1, 0.15, 0.2])


def test_outside_of_the_known_poses_odometry_alone_tells() -> None:
    line = np.column_stack((np.arange(5.0), np.zeros((5, 2))))
    known = Trajectory(stamps=np.array([2.0]), poses=np.array([[0.0, 0.0, np.pi / 2]]))
    filled = completed(known, Trajectory(stamps=np.arange(5.0), poses=line))
    assert np.allclose(filled.poses[:, :2], [[0, -2], [0, -1], [0, 0], [0, 1], [0, 2]])


def test_yaw_in_between_goes_the_short_way_round() -> None:
    turning = Trajectory(stamps=np.arange(2.0), poses=np.array([[0, 0, 3.0], [0, 0, -3.0]]))
    halfway = poses_at(turning, [0.5])[0]
    assert abs(halfway[2]) == pytest.approx(np.pi)


def test_path_length_adds_up_the_steps() -> None:
    assert path_length([[0, 0, 0], [3, 4, 1], [3, 5, 2]]) == pytest.approx(6.0)
    assert path_length(np.zeros((1, 3))) == 0.0


@pytest.mark.parametrize(
    ("stamps", "poses"),
    [
        ([0.0, 0.0], np.zeros((2, 3))),
        ([0.0, 1.0], np.zeros((1, 3))),
        ([0.0], np.full((1, 3), np.nan)),
    ],
)
def test_what_is_no_trajectory_is_told(stamps: list[float], poses: np.ndarray) -> None:
    with pytest.raises(TestbedError, match="trajectory"):
        Trajectory(stamps=np.array(stamps), poses=poses)
