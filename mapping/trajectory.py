"""Poses over time: what they were in between, and how long the way was."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from mapping.errors import TestbedError
from mapping.geometry import Pose, between, compose, wrap_to_pi


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


def poses_at(trajectory: Trajectory, stamps: ArrayLike) -> Pose:
    """The poses ``(n, 3)`` at stamps ``(n,)``, interpolated; yaw goes the short way round."""
    stamps = np.asarray(stamps, dtype=np.float64)
    x, y, yaw = trajectory.poses.T
    columns = (x, y, np.unwrap(yaw))
    poses = np.stack([np.interp(stamps, trajectory.stamps, each) for each in columns], axis=-1)
    poses[:, 2] = wrap_to_pi(poses[:, 2])
    return poses


def completed(sparse: Trajectory, odometry: Trajectory) -> Trajectory:
    """Corrected poses at all of odometry's stamps, from those known at some of them.

    Between two known poses the robot went as odometry says; what then is left to the second one,
    the correction, is spread evenly over the time between. Before the first and after the last
    known pose odometry alone tells.

    Args:
        sparse: Corrected poses, in the map frame; at least one.
        odometry: Poses in the odometry frame.
    """
    odometry_there = poses_at(odometry, sparse.stamps)
    after = np.searchsorted(sparse.stamps, odometry.stamps, side="right")
    before = np.clip(after - 1, 0, None)
    gone = between(odometry_there[before], odometry.poses)
    steps = between(odometry_there[:-1], odometry_there[1:])
    left_over = between(compose(sparse.poses[:-1], steps), sparse.poses[1:])
    corrections = np.concatenate((left_over, np.zeros((1, 3))))  # none after the last
    times = np.append(np.diff(sparse.stamps), 1.0)
    share = np.clip((odometry.stamps - sparse.stamps[before]) / times[before], 0.0, 1.0)
    corrected = compose(compose(sparse.poses[before], gone), share[:, None] * corrections[before])
    return Trajectory(stamps=odometry.stamps, poses=corrected)


def path_length(poses: ArrayLike) -> float:
    """Length [m] of the way through poses or points ``(n, 2 or more)``; 0 for fewer than two."""
    positions = np.asarray(poses, dtype=np.float64)[:, :2]
    return float(np.hypot(*np.diff(positions, axis=0).T).sum())
