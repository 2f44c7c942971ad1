"""Turns weighted poses into the few places that they are about."""

import math

import numpy as np
from numpy.typing import NDArray

from mapping.geometry import Pose, circular_mean, wrap_to_pi
from mapping.localization.localizer import Hypothesis

REACH, REACH_YAW = 0.5, math.radians(30.0)
"""Poses this near to the middle of a place [m, rad] are about it."""

SHIFTS = 3
"""Times that a place's middle is moved to the mean of the poses about it."""

MOST = 5
"""At most so many places are told."""

LEAST_WEIGHT = 0.02
"""A place with less of the belief is not told."""

NARROWEST = np.diag(np.square([0.01, 0.01, 0.005]))
"""No place is told more exactly than this [m2, m2, rad2]."""


def cluster(poses: Pose, weights: NDArray[np.float64]) -> list[Hypothesis]:
    """The places that weighted poses ``(n, 3)``, ``(n,)`` are about, likeliest first.

    From the fullest bin on, each place takes the poses about it, and leaves the rest to the next.
    """
    hypotheses: list[Hypothesis] = []
    total = float(weights.sum())
    while len(hypotheses) < MOST and len(poses) > 0:
        middle = _fullest_bin(poses, weights)
        for _ in range(SHIFTS):
            about = _about(poses, middle)
            if not about.any():
                break
            middle = _mean(poses[about], weights[about])
        about = _about(poses, middle)
        share = float(weights[about].sum()) / total
        if share < LEAST_WEIGHT:
            break
        spread = _covariance(poses[about], weights[about], middle)
        hypotheses.append(Hypothesis(pose=middle, covariance=spread, weight=share))
        poses, weights = poses[~about], weights[~about]
    return sorted(hypotheses, key=lambda hypothesis: -hypothesis.weight)


def _fullest_bin(poses: Pose, weights: NDArray[np.float64]) -> Pose:
    """The mean of the poses in the bin that holds most weight."""
    cells = np.floor(poses / (REACH, REACH, REACH_YAW)).astype(np.int64)
    cells -= cells.min(axis=0)
    keys = np.ravel_multi_index(tuple(cells.T), tuple(cells.max(axis=0) + 1))
    _, bins = np.unique(keys, return_inverse=True)
    inside = bins == np.argmax(np.bincount(bins, weights))
    return _mean(poses[inside], weights[inside])


def _about(poses: Pose, middle: Pose) -> NDArray[np.bool_]:
    """Whether poses lie within reach of a place."""
    apart = np.hypot(poses[:, 0] - middle[0], poses[:, 1] - middle[1])
    turned = np.abs(wrap_to_pi(poses[:, 2] - middle[2]))
    return np.asarray((apart <= REACH) & (turned <= REACH_YAW))


def _mean(poses: Pose, weights: NDArray[np.float64]) -> Pose:
    x, y = weights @ poses[:, :2] / weights.sum()
    return np.array([x, y, circular_mean(poses[:, 2], weights)])


def _covariance(poses: Pose, weights: NDArray[np.float64], middle: Pose) -> NDArray[np.float64]:
    apart = poses - middle
    apart[:, 2] = wrap_to_pi(apart[:, 2])
    return np.asarray((weights * apart.T) @ apart / weights.sum() + NARROWEST)
