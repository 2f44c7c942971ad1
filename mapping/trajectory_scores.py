"""Scores an estimated trajectory against the true one: absolute and relative errors, yaw error."""

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from mapping.errors import TestbedError
from mapping.geometry import Pose, between, compose, wrap_to_pi
from mapping.trajectory import Trajectory, poses_at

DELTA_TOLERANCE = 0.1
"""Of all pairs of poses those count that are this share of the wanted distance off it, or less."""

DeltaUnit = Literal["frames", "m", "s"]
"""What a pair's distance is told in: poses, metres of the estimated way, seconds."""


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
    """Compare an estimate with the truth at the estimate's stamps: the absolute trajectory error.

    The truth is interpolated; stamps of the estimate outside of it are left out.

    Args:
        estimate: The estimated trajectory.
        truth: The true one.
        align: Move the estimate rigidly onto the truth first (Umeyama 1991, without scale).

    Raises:
        TestbedError: The two do not overlap in time.
    """
    _, poses, true_poses = _overlap(estimate, truth)
    moved_by = umeyama(poses[:, :2], true_poses[:, :2]) if align else np.zeros(3)
    poses = compose(moved_by, poses)
    errors = np.hypot(*(poses[:, :2] - true_poses[:, :2]).T)
    yaw_errors = np.abs(wrap_to_pi(poses[:, 2] - true_poses[:, 2]))
    return TrajectoryScores(
        ate_rmse_m=_rms(errors),
        ate_max_m=float(errors.max()),
        yaw_error_max_deg=float(np.degrees(yaw_errors.max())),
        alignment=(float(moved_by[0]), float(moved_by[1]), float(moved_by[2])),
    )


@dataclass(frozen=True, slots=True, kw_only=True)
class RelativeScores:
    """How far an estimate went wrong from one pose to another a little later."""

    pairs: int
    """Pairs of poses compared."""
    trans_rmse_m: float
    """Root mean square of the errors of the way between the two [m]."""
    trans_max_m: float
    """The largest of them [m]."""
    rot_rmse_deg: float
    """Root mean square of the errors of the turn between the two [deg]."""
    rot_max_deg: float
    """The largest of them [deg]."""


def score_relative(
    estimate: Trajectory,
    truth: Trajectory,
    *,
    delta: float = 1.0,
    unit: DeltaUnit = "s",
    all_pairs: bool = True,
) -> RelativeScores | None:
    """Compare how poses lie to one another: the relative pose error (Sturm et al. 2012).

    The truth is interpolated at the estimate's stamps; those outside of it are left out.

    Args:
        estimate: The estimated trajectory.
        truth: The true one.
        delta: How far the two poses of a pair are apart, above 0; a whole number of frames.
        unit: What ``delta`` is told in.
        all_pairs: Every pose starts a pair, with the pose nearest to ``delta`` farther on if that
            is within DELTA_TOLERANCE of it; else pairs follow one another, each ended by the first
            pose that is ``delta`` or farther on.

    Returns:
        None when there is no such pair.

    Raises:
        TestbedError: A delta that is none, or the two do not overlap in time.
    """
    if not (np.isfinite(delta) and delta > 0.0) or (unit == "frames" and delta != round(delta)):
        raise TestbedError(f"delta: {delta} {unit}; must be above 0, and whole for frames")
    stamps, poses, true_poses = _overlap(estimate, truth)
    along = _along(stamps, poses, unit)
    if all_pairs:
        tolerance = 0.0 if unit == "frames" else DELTA_TOLERANCE * delta
        first, second = _all_pairs(along, delta, tolerance)
    else:
        first, second = _consecutive_pairs(along, delta)
    if first.size == 0:
        return None
    true_steps = between(true_poses[first], true_poses[second])
    errors = between(true_steps, between(poses[first], poses[second]))
    distances = np.hypot(errors[:, 0], errors[:, 1])
    turns = np.degrees(np.abs(errors[:, 2]))
    return RelativeScores(
        pairs=len(first),
        trans_rmse_m=_rms(distances),
        trans_max_m=float(distances.max()),
        rot_rmse_deg=_rms(turns),
        rot_max_deg=float(turns.max()),
    )


def _overlap(estimate: Trajectory, truth: Trajectory) -> tuple[NDArray[np.float64], Pose, Pose]:
    """The estimate's stamps within the truth's time, its poses there and the true ones."""
    if len(estimate.stamps) == 0 or len(truth.stamps) == 0:
        raise TestbedError("trajectory: there is no pose; must have at least one")
    within = (estimate.stamps >= truth.stamps[0]) & (estimate.stamps <= truth.stamps[-1])
    if not np.any(within):
        raise TestbedError("trajectory: no stamp of the estimate lies within the truth's time")
    stamps = estimate.stamps[within]
    return stamps, estimate.poses[within], poses_at(truth, stamps)


def _along(stamps: NDArray[np.float64], poses: Pose, unit: DeltaUnit) -> NDArray[np.float64]:
    """How far on each pose is ``(n,)``, in the unit; never descends."""
    if unit == "frames":
        return np.arange(len(stamps), dtype=np.float64)
    if unit == "s":
        return np.asarray(stamps - stamps[0])
    steps = np.hypot(*np.diff(poses[:, :2], axis=0).T)
    return np.concatenate(([0.0], np.cumsum(steps)))


def _all_pairs(
    along: NDArray[np.float64], delta: float, tolerance: float
) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Each pose and the one nearest to ``delta`` farther on, where that is near enough."""
    first = np.arange(len(along) - 1)
    target = along[first] + delta
    above = np.clip(np.searchsorted(along, target), 1, len(along) - 1)
    nearer_below = target - along[above - 1] <= along[above] - target
    nearest = np.where(nearer_below, above - 1, above)
    second = np.maximum(np.searchsorted(along, along[nearest]), first + 1)
    near_enough = np.abs(along[second] - target) <= tolerance
    return first[near_enough], second[near_enough]


def _consecutive_pairs(
    along: NDArray[np.float64], delta: float
) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Pairs one after another, each begun where the last one ended."""
    ends = [0]
    while (end := int(np.searchsorted(along, along[ends[-1]] + delta))) < len(along):
        ends.append(end)
    return np.array(ends[:-1], dtype=np.int64), np.array(ends[1:], dtype=np.int64)


def _rms(errors: NDArray[np.float64]) -> float:
    """Root mean square of errors ``(n,)``."""
    return float(np.sqrt(np.mean(errors**2)))


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
