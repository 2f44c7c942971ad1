import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from mapping.errors import TestbedError
from mapping.geometry import compose, inverse
from mapping.trajectory import Trajectory, path_length, score_trajectory, umeyama

STAMPS = np.linspace(0.0, 10.0, 101)


def circle() -> Trajectory:
    """One turn of radius 1 m, heading along it."""
    turn = 2.0 * np.pi * STAMPS / 10.0
    poses = np.column_stack((np.cos(turn), np.sin(turn), turn + np.pi / 2.0))
    return Trajectory(stamps=STAMPS, poses=compose(np.zeros(3), poses))


def moved(trajectory: Trajectory, pose: tuple[float, float, float]) -> Trajectory:
    return Trajectory(stamps=trajectory.stamps, poses=compose(pose, trajectory.poses))


def test_the_truth_itself_has_no_error() -> None:
    scores = score_trajectory(circle(), circle())
    assert (scores.ate_rmse_m, scores.ate_max_m) == pytest.approx((0.0, 0.0))
    assert scores.yaw_error_max_deg == pytest.approx(0.0)


def test_a_shift_is_the_error_everywhere() -> None:
    scores = score_trajectory(moved(circle(), (0.3, 0.4, 0.0)), circle())
    assert scores.ate_rmse_m == pytest.approx(0.5)
    assert scores.ate_max_m == pytest.approx(0.5)


def test_a_drift_that_grows_evenly_has_the_rmse_of_a_ramp() -> None:
    poses = circle().poses + np.column_stack((STAMPS / 10.0, np.zeros((101, 2))))
    scores = score_trajectory(Trajectory(stamps=STAMPS, poses=poses), circle())
    assert scores.ate_max_m == pytest.approx(1.0)
    assert scores.ate_rmse_m == pytest.approx(np.sqrt(np.mean((STAMPS / 10.0) ** 2)))


def test_yaw_errors_are_taken_the_short_way_round() -> None:
    one = Trajectory(stamps=STAMPS, poses=np.tile([0.0, 0.0, 3.1], (101, 1)))
    other = Trajectory(stamps=STAMPS, poses=np.tile([0.0, 0.0, -3.1], (101, 1)))
    expected = np.degrees(2.0 * np.pi - 6.2)
    assert score_trajectory(one, other).yaw_error_max_deg == pytest.approx(expected)


@given(pose=st.tuples(st.floats(-5, 5), st.floats(-5, 5), st.floats(-3, 3)))
@settings(max_examples=40, deadline=None)
def test_alignment_undoes_any_rigid_move(pose: tuple[float, float, float]) -> None:
    scores = score_trajectory(moved(circle(), pose), circle(), align=True)
    assert scores.ate_max_m == pytest.approx(0.0, abs=1e-9)
    assert compose(pose, scores.alignment) == pytest.approx(np.zeros(3), abs=1e-9)
    assert scores.alignment == pytest.approx(tuple(inverse(pose)), abs=1e-9)


def test_stamps_in_between_are_interpolated() -> None:
    line = np.column_stack((STAMPS, 0.0 * STAMPS, 0.0 * STAMPS))
    half = STAMPS[:-1] + 0.05
    estimate = Trajectory(stamps=half, poses=np.column_stack((half, 0.0 * half, 0.0 * half)))
    scores = score_trajectory(estimate, Trajectory(stamps=STAMPS, poses=line))
    assert scores.ate_max_m == pytest.approx(0.0, abs=1e-12)


def test_what_lies_outside_the_truths_time_is_left_out() -> None:
    late = Trajectory(stamps=STAMPS + 100.0, poses=circle().poses)
    with pytest.raises(TestbedError, match="no stamp"):
        score_trajectory(late, circle())


def test_points_that_coincide_are_moved_without_being_turned() -> None:
    assert umeyama(np.ones((3, 2)), np.zeros((3, 2))) == pytest.approx([-1.0, -1.0, 0.0])


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
