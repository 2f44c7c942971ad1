import numpy as np
import pytest
from evo.core import metrics
from evo.core.trajectory import PoseTrajectory3D
from hypothesis import given, settings
from hypothesis import strategies as st

from mapping.errors import TestbedError
from mapping.geometry import compose, inverse
from mapping.trajectory import Trajectory
from mapping.trajectory_scores import DeltaUnit, score_relative, score_trajectory, umeyama

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


def wandering(seed: int, count: int = 200) -> Trajectory:
    """A robot that goes 1 cm to 10 cm and turns up to 0.2 rad from pose to pose, at 5 Hz."""
    rng = np.random.default_rng(seed)
    pose, poses = np.zeros(3), []
    for _ in range(count):
        pose = compose(pose, (rng.uniform(0.01, 0.1), 0.0, rng.uniform(-0.2, 0.2)))
        poses.append(pose)
    return Trajectory(stamps=0.2 * np.arange(count), poses=np.array(poses))


def drifting(truth: Trajectory, seed: int) -> Trajectory:
    """The same way with errors from pose to pose, seen from another frame."""
    rng = np.random.default_rng(seed)
    errors = np.cumsum(rng.normal(0.0, 0.01, truth.poses.shape), axis=0)
    poses = compose((0.4, -0.2, 0.3), compose(truth.poses, errors))
    return Trajectory(stamps=truth.stamps, poses=poses)


def as_evo(trajectory: Trajectory) -> PoseTrajectory3D:
    x, y, yaw = trajectory.poses.T
    zeros = np.zeros_like(x)
    return PoseTrajectory3D(
        positions_xyz=np.column_stack((x, y, zeros)),
        orientations_quat_wxyz=np.column_stack((np.cos(yaw / 2), zeros, zeros, np.sin(yaw / 2))),
        timestamps=trajectory.stamps,
    )


@pytest.mark.parametrize("align", [False, True])
@pytest.mark.parametrize("seed", range(3))
def test_the_absolute_error_is_the_one_that_evo_finds(seed: int, align: bool) -> None:
    truth = wandering(seed)
    estimate = drifting(truth, seed + 10)
    reference, other = as_evo(truth), as_evo(estimate)
    if align:
        other.align(reference)
    error = metrics.APE(metrics.PoseRelation.translation_part)
    error.process_data((reference, other))
    scores = score_trajectory(estimate, truth, align=align)
    assert scores.ate_rmse_m == pytest.approx(error.get_statistic(metrics.StatisticsType.rmse))
    assert scores.ate_max_m == pytest.approx(error.get_statistic(metrics.StatisticsType.max))


@pytest.mark.parametrize("all_pairs", [False, True])
@pytest.mark.parametrize(
    ("delta", "unit", "evo_delta", "evo_unit"),
    [
        (1, "frames", 1, metrics.Unit.frames),
        (7, "frames", 7, metrics.Unit.frames),
        (1.0, "m", 1.0, metrics.Unit.meters),
        (0.3, "m", 0.3, metrics.Unit.meters),
        (1.0, "s", 5, metrics.Unit.frames),  # evo knows no seconds; here 5 poses are one
    ],
)
def test_the_relative_error_is_the_one_that_evo_finds(
    delta: float, unit: DeltaUnit, evo_delta: float, evo_unit: metrics.Unit, all_pairs: bool
) -> None:
    truth = wandering(4)
    estimate = drifting(truth, 5)
    scores = score_relative(estimate, truth, delta=delta, unit=unit, all_pairs=all_pairs)
    assert scores is not None
    for relation, rmse, largest in (
        (metrics.PoseRelation.translation_part, scores.trans_rmse_m, scores.trans_max_m),
        (metrics.PoseRelation.rotation_angle_deg, scores.rot_rmse_deg, scores.rot_max_deg),
    ):
        error = metrics.RPE(relation, evo_delta, evo_unit, all_pairs=all_pairs)
        error.process_data((as_evo(truth), as_evo(estimate)))
        assert scores.pairs == len(error.error)
        assert rmse == pytest.approx(error.get_statistic(metrics.StatisticsType.rmse))
        assert largest == pytest.approx(error.get_statistic(metrics.StatisticsType.max))


@given(pose=st.tuples(st.floats(-5, 5), st.floats(-5, 5), st.floats(-3, 3)))
@settings(max_examples=20, deadline=None)
def test_a_rigid_move_of_the_whole_leaves_no_relative_error(
    pose: tuple[float, float, float],
) -> None:
    scores = score_relative(moved(circle(), pose), circle())
    assert scores is not None
    assert scores.trans_max_m == pytest.approx(0.0, abs=1e-9)
    assert scores.rot_max_deg == pytest.approx(0.0, abs=1e-7)


def test_a_robot_that_stands_makes_pairs_by_time_and_none_by_way() -> None:
    still = Trajectory(stamps=STAMPS[::2], poses=np.zeros((51, 3)))
    by_time = score_relative(still, still)
    assert by_time is not None
    assert by_time.pairs == 46, "every pose but those of the last second"
    assert score_relative(still, still, unit="m") is None
    assert score_relative(still, still, unit="m", all_pairs=False) is None


def test_a_trajectory_of_one_pose_has_no_relative_error() -> None:
    one = Trajectory(stamps=np.zeros(1), poses=np.zeros((1, 3)))
    assert score_relative(one, one) is None


@pytest.mark.parametrize(
    ("delta", "unit"), [(0.0, "s"), (-1.0, "m"), (float("nan"), "s"), (1.5, "frames")]
)
def test_a_distance_that_makes_no_pairs_is_told(delta: float, unit: DeltaUnit) -> None:
    with pytest.raises(TestbedError, match="delta"):
        score_relative(circle(), circle(), delta=delta, unit=unit)


def test_no_pose_at_all_is_told() -> None:
    nothing = Trajectory(stamps=np.empty(0), poses=np.empty((0, 3)))
    for score in (score_trajectory, score_relative):
        with pytest.raises(TestbedError, match="no pose"):
            score(nothing, circle())
