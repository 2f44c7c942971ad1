import numpy as np
import pytest

from mapping.pose_history import FIRST_ROWS, PoseHistory


def filled(count: int) -> PoseHistory:
    history = PoseHistory()
    for k in range(count):
        history.add(0.1 * k, np.array([k, -k, 0.001 * k]))
    return history


@pytest.mark.parametrize("count", [0, 1, FIRST_ROWS, FIRST_ROWS + 1, 5 * FIRST_ROWS])
def test_every_pose_is_kept_in_order(count: int) -> None:
    history, rows = filled(count), np.arange(count)
    assert len(history) == count
    assert history.stamps == pytest.approx(0.1 * rows)
    assert history.poses == pytest.approx(np.column_stack((rows, -rows, 0.001 * rows)))


def test_a_history_of_tables_can_be_added_to() -> None:
    stamps, poses = np.array([1.0, 2.0]), np.array([[1.0, 2.0, 3.0], [4.0, 5.0, 6.0]])
    history = PoseHistory.of(stamps, poses)
    assert len(history) == 2
    for k in range(3 * FIRST_ROWS):
        history.add(3.0 + k, np.full(3, float(k)))
    assert len(history) == 3 * FIRST_ROWS + 2
    assert history.stamps[:3].tolist() == [1.0, 2.0, 3.0]
    assert np.array_equal(history.poses[:2], poses)
    assert history.poses[-1].tolist() == [3.0 * FIRST_ROWS - 1.0] * 3


def test_a_history_of_empty_tables_is_empty() -> None:
    history = PoseHistory.of(np.zeros(0), np.zeros((0, 3)))
    assert len(history) == 0
    history.add(1.0, np.ones(3))
    assert history.stamps.tolist() == [1.0]


def test_what_is_given_out_and_taken_in_are_copies() -> None:
    stamps, poses = np.zeros(2), np.zeros((2, 3))
    history = PoseHistory.of(stamps, poses)
    stamps[:], poses[:] = 7.0, 7.0
    history.stamps[:], history.poses[:] = 8.0, 8.0
    pose = np.ones(3)
    history.add(1.0, pose)
    pose[:] = 9.0
    assert history.stamps.tolist() == [0.0, 0.0, 1.0]
    assert history.poses.tolist() == [[0.0] * 3, [0.0] * 3, [1.0] * 3]
