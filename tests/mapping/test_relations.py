import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from mapping.errors import TestbedError
from mapping.geometry import between, compose
from mapping.relations import STAMP_TOLERANCE, Relations, score_relations
from mapping.trajectory import Trajectory

STAMPS = 1e9 + np.arange(50.0)


def there_and_back(seed: int = 0) -> Trajectory:
    rng = np.random.default_rng(seed)
    poses = np.cumsum(rng.normal(0.0, 0.5, (50, 3)), axis=0)
    return Trajectory(stamps=STAMPS, poses=compose(np.zeros(3), poses))


def relations_of(trajectory: Trajectory, pairs: list[tuple[int, int]]) -> Relations:
    first, second = np.array(pairs).T
    poses = between(trajectory.poses[first], trajectory.poses[second])
    return Relations(stamps=np.column_stack((STAMPS[first], STAMPS[second])), poses=poses)


PAIRS = [(0, 49), (10, 3), (20, 21)]


@given(frame=st.tuples(st.floats(-50, 50), st.floats(-50, 50), st.floats(-3, 3)))
@settings(max_examples=20, deadline=None)
def test_the_true_trajectory_has_no_error_in_any_frame(frame: tuple[float, float, float]) -> None:
    truth = there_and_back()
    moved = Trajectory(stamps=STAMPS, poses=compose(frame, truth.poses))
    scores = score_relations(moved, relations_of(truth, PAIRS))
    assert scores.used == 3
    assert scores.trans_max_m == pytest.approx(0.0, abs=1e-9)
    assert scores.rot_max_deg == pytest.approx(0.0, abs=1e-7)


def test_errors_are_told_as_mean_spread_and_largest() -> None:
    stamps = np.arange(4.0)
    poses = np.array([[0, 0, 0], [1, 0, 0], [0, 0, 0], [0, 0, 0.2]], dtype=np.float64)
    # the first is 0.3 m off across, the second 0.1 m along, the third turned by 0.2 rad
    told = Relations(
        stamps=np.array([[0.0, 1.0], [0.0, 2.0], [0.0, 3.0]]),
        poses=np.array([[1.0, 0.3, 0.0], [0.1, 0.0, 0.0], [0.0, 0.0, 0.4]]),
    )
    scores = score_relations(Trajectory(stamps=stamps, poses=poses), told)
    assert scores.trans_mean_m == pytest.approx(0.4 / 3)
    assert scores.trans_std_m == pytest.approx(np.std([0.3, 0.1, 0.0]))
    assert scores.trans_max_m == pytest.approx(0.3)
    assert scores.rot_mean_deg == pytest.approx(np.degrees(0.2) / 3)
    assert scores.rot_max_deg == pytest.approx(np.degrees(0.2))


def test_a_relation_is_used_when_both_moments_are_in_the_trajectory() -> None:
    truth = there_and_back()
    relations = relations_of(truth, PAIRS)
    near, far = 0.9 * STAMP_TOLERANCE, 1.2 * STAMP_TOLERANCE
    for shift, used in ((near, 3), (-near, 3), (far, 2), (-far, 2)):
        stamps = relations.stamps.copy()
        stamps[1, 1] += shift
        scores = score_relations(truth, Relations(stamps=stamps, poses=relations.poses))
        assert scores.used == used
        assert scores.trans_max_m == pytest.approx(0.0, abs=1e-9)


@pytest.mark.parametrize("count", [0, 1])
def test_a_trajectory_that_has_none_of_the_moments_has_no_scores(count: int) -> None:
    trajectory = Trajectory(stamps=np.zeros(count), poses=np.zeros((count, 3)))
    scores = score_relations(trajectory, relations_of(there_and_back(), PAIRS))
    assert scores.used == 0
    assert scores.trans_mean_m is None
    assert scores.rot_max_deg is None


@pytest.mark.parametrize(
    ("stamps", "poses"),
    [
        (np.zeros((2, 3)), np.zeros((2, 3))),
        (np.zeros((2, 2)), np.zeros((1, 3))),
        (np.zeros((1, 2)), np.full((1, 3), np.nan)),
    ],
)
def test_what_makes_no_relations_is_told(stamps: np.ndarray, poses: np.ndarray) -> None:
    with pytest.raises(TestbedError, match="relations"):
        Relations(stamps=stamps, poses=poses)
