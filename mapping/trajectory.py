"""Scores an estimated trajectory against the true one: ATE, yaw error, path length."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from mapping.errors import TestbedError
from mapping.geometry import Pose, compose, wrap_to_pi


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Trajectory:
    """Poses over time."""

    stamps: NDArray[np.float64]
    """Times ``(n,)`` [s], strictly ascending."""
    poses: Pose
    """Poses ``(n, 3)``."""

    def __post_init__(self) -> None:
        """Refuse what is no trajectory."""
        if self.stamps.ndim != 1 or self.poses.shape != (len(self.stamps), 3):
            raise TestbedError(
                f"trajectory: {self.stamps.shape} stamps and {self.poses.shape} poses; "
                "must be (n,) and (n, 3)"
            )
        if not (np.all(np.isfinite(self.stamps)) and np.all(np.isfinite(self.poses))):
            raise TestbedError("trajectory: a stamp or pose is not finite; all must be")
        if np.any(np.diff(self.stamps) <= 0.0):
            raise TestbedError("trajectory: stamps do not ascend; each must be later than the last")


@dataclass(frozen=True, slots=True, kw_only=True)
class TrajectoryScores:
    """How far an estimate was from the truth."""

    ate_rmse_m: float
    """Root mean square of the distances between estimated and true positions [m] (Sturm et al.
    2012)."""
    ate_max_m: float
    """The largest of them [m]."""
    yaw_error_max_deg: float
    """The largest difference of yaw [deg]."""
    alignment: tuple[float, float, float]
    """The pose (x, y, yaw) that the estimate was moved by before; zeros when not aligned."""


def score_trajectory(
    estimate: Trajectory, truth: Trajectory, *, align: bool = False
) -> TrajectoryScores:
    """Compare an estimate with the truth at the estimate's stamps.

    The truth is interpolated; stamps of the estimate outside of it are left out.

    Args:
        estimate: The estimated trajectory.
        truth: The true one.
        align: Move the estimate rigidly onto the truth first (Umeyama 1991, without scale).

    Raises:
        TestbedError: The two do not overlap in time.
    """
    within = (estimate.stamps >= truth.stamps[0]) & (estimate.stamps <= truth.stamps[-1])
    if not np.any(within):
        raise TestbedError("trajectory: no stamp of the estimate lies within the truth's time")
    poses = estimate.poses[within]
    true_poses = poses_at(truth, estimate.stamps[within])
    moved_by = umeyama(poses[:, :2], true_poses[:, :2]) if align else np.zeros(3)
    poses = compose(moved_by, poses)
    errors = np.hypot(*(poses[:, :2] - true_poses[:, :2]).T)
    yaw_errors = np.abs(wrap_to_pi(poses[:, 2] - true_poses[:, 2]))
    return TrajectoryScores(
        ate_rmse_m=float(np.sqrt(np.mean(errors**2))),
        ate_max_m=float(errors.max()),
        yaw_error_max_deg=float(np.degrees(yaw_errors.max())),
        alignment=(float(moved_by[0]), float(moved_by[1]), float(moved_by[2])),
    )


def poses_at(trajectory: Trajectory, stamps: ArrayLike) -> Pose:
    """The poses ``(n, 3)`` at stamps ``(n,)``, interpolated; yaw goes the short way round."""
    stamps = np.asarray(stamps, dtype=np.float64)
    x, y, yaw = trajectory.poses.T
    columns = (x, y, np.unwrap(yaw))
    poses = np.stack([np.interp(stamps, trajectory.stamps, each) for each in columns], axis=-1)
    poses[:, 2] = wrap_to_pi(poses[:, 2])
    return poses


def umeyama(points: NDArray[np.float64], targets: NDArray[np.float64]) -> Pose:
    """The pose ``(3,)`` that brings points ``(n, 2)`` closest to their targets ``(n, 2)``.

    Least squares of rotation and translation in the plane, where the rotation of Umeyama (1991)
    comes down to one angle. Points that all coincide are moved without being turned.
    """
    mean, target_mean = points.mean(axis=0), targets.mean(axis=0)
    p, q = points - mean, targets - target_mean
    cross = float(np.sum(p[:, 0] * q[:, 1] - p[:, 1] * q[:, 0]))
    yaw = float(np.arctan2(cross, np.sum(p * q)))
    turned = compose(np.array([0.0, 0.0, yaw]), np.array([mean[0], mean[1], 0.0]))
    return np.array([target_mean[0] - turned[0], target_mean[1] - turned[1], yaw])


def path_length(poses: ArrayLike) -> float:
    """Length [m] of the way through poses or points ``(n, 2 or more)``; 0 for fewer than two."""
    positions = np.asarray(poses, dtype=np.float64)[:, :2]
    return float(np.hypot(*np.diff(positions, axis=0).T).sum())
