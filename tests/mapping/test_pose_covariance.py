"""Covariances of poses: against the spread of drawn poses, and there and back."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mapping.geometry import between, compose
from mapping.pose_covariance import carried, turned

SIGMAS = np.array([[4.0, 1.0, 0.5], [1.0, 2.0, -0.3], [0.5, -0.3, 1.0]])
"""A covariance with every entry of its own."""


def test_carried_is_the_spread_of_drawn_poses_that_are_moved_by_drawn_motions() -> None:
    rng = np.random.default_rng(0)
    pose, motion = np.array([1.0, -2.0, 0.7]), np.array([0.8, 0.1, 0.4])
    # small, so that the motion is straight over the spread of the heading
    before, spread = 1e-6 * SIGMAS, 1e-7 * SIGMAS[::-1, ::-1]
    count = 200_000
    poses = pose + rng.multivariate_normal(np.zeros(3), before, count)
    motions = motion + rng.multivariate_normal(np.zeros(3), spread, count)
    drawn = np.cov(compose(poses, motions).T)
    found = carried(before, pose, compose(pose, motion), spread)
    # the standard error of a covariance's entry is sqrt(2 / n) of the variances at most; four of it
    scale = np.sqrt(np.outer(np.diag(found), np.diag(found)))
    assert np.all(np.abs(found - drawn) < 4.0 * np.sqrt(2.0 / count) * scale)


@given(st.floats(-10.0, 10.0))
def test_turning_there_and_back_changes_nothing(yaw: float) -> None:
    assert np.allclose(turned(turned(SIGMAS, yaw), -yaw), SIGMAS, atol=1e-12)


@given(st.floats(-3.0, 3.0))
def test_turning_is_what_a_change_of_frame_does_to_errors(yaw: float) -> None:
    errors = np.linalg.cholesky(SIGMAS).T  # rows whose products sum to the covariance
    frame = np.array([0.0, 0.0, yaw])
    seen = compose(frame, errors * [1.0, 1.0, 0.0])
    moved = np.column_stack((seen[:, :2], errors[:, 2]))
    assert turned(SIGMAS, yaw) == pytest.approx(moved.T @ moved)
    assert between(frame, seen)[:, :2] == pytest.approx(errors[:, :2])
