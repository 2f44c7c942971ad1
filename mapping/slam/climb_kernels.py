"""Kernel that climbs the log likelihood of a scan to its top: Newton's method with a prior."""

import math

import numpy as np
from numba import njit
from numpy.typing import NDArray

from mapping.slam.hit_field_kernels import newton_terms
from mapping.slam.matrix_kernels import inverse3, product3, quadratic3, times3

MOST_STEPS = 20
"""Steps after which climbing ends; ten are seldom needed."""

LONGEST_STEP = 1.0
"""No step is longer [cells]: beyond the bell's slope the curvature says nothing."""

STILL = 1e-3
"""A step shorter than this [cells] ends the climb."""

SHORTEST_SHARE = 0.05
"""A step that must be shortened to less than this share of itself is not taken."""


@njit(cache=True)
def climb(
    density: NDArray[np.float32],
    start: NDArray[np.float64],
    prior: NDArray[np.float64],
    information: NDArray[np.float64],
    points: NDArray[np.float64],
    normals: NDArray[np.float64],
    weights: NDArray[np.float64],
    outlier: float,
    least: float,
) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64], float]:
    """The most likely pose of a scan, given a field and a prior.

    A direction in the plane about which the scan tells less than ``least`` a reading, along a bare
    corridor, is left to the prior: what slope there is comes from the noise of the walls. The same
    holds for the yaw in a round room.

    Args:
        density: The field ``(rows, columns)``.
        start: Where to start climbing ``(3,)``: x, y in cells, yaw [rad].
        prior: Mean of the prior ``(3,)`` in the same units.
        information: Its inverse covariance ``(3, 3)``.
        points: Readings in the scan's frame, in cells ``(n, 2)``.
        normals: Directions across the walls that they lie on ``(n, 2)``, zeros where unknown.
        weights: How much each tells ``(n,)``.
        outlier: Density of unknown things.
        least: Least curvature per matched weight [1/cells^2] that counts.

    Returns:
        The pose, the scan's curvature ``(3, 3)`` there without directions that do not count, the
        scatter of its readings' slopes ``(3, 3)``, and the share of readings matched.
    """
    pose = start.copy()
    gradient, hessian = np.empty(3), np.empty((3, 3))
    tried_gradient, tried_hessian = np.empty(3), np.empty((3, 3))
    scatter, tried_scatter = np.empty((3, 3)), np.empty((3, 3))
    lever = 0.0
    total = 0.0
    for i in range(len(weights)):
        lever = max(lever, math.hypot(points[i, 0], points[i, 1]))
        total += weights[i]
    likelihood, matched = newton_terms(
        density, pose, points, normals, weights, outlier, gradient, hessian, scatter
    )
    value = likelihood - _cost(pose, prior, information)
    drop_flat(gradient, hessian, points, weights, total * matched, least)
    for _ in range(MOST_STEPS):
        offset = pose - prior
        slope = gradient - times3(information, offset)
        step = times3(inverse3(hessian + information), slope)
        length = max(math.hypot(step[0], step[1]), 0.5 * lever * abs(step[2]))
        if length > LONGEST_STEP:
            step *= LONGEST_STEP / length
            length = LONGEST_STEP
        share = 1.0
        while True:
            tried = pose + share * step
            likelihood, tried_matched = newton_terms(
                density,
                tried,
                points,
                normals,
                weights,
                outlier,
                tried_gradient,
                tried_hessian,
                tried_scatter,
            )
            tried_value = likelihood - _cost(tried, prior, information)
            if tried_value >= value or share * length < STILL:
                break
            share *= 0.5
            if share < SHORTEST_SHARE:
                break
        if tried_value < value:
            break
        gain = share * length
        pose, value, matched = tried, tried_value, tried_matched
        gradient[:] = tried_gradient
        hessian[:] = tried_hessian
        scatter[:] = tried_scatter
        drop_flat(gradient, hessian, points, weights, total * matched, least)
        if gain < STILL:
            break
    return pose, hessian, scatter, matched


@njit(cache=True)
def drop_flat(
    gradient: NDArray[np.float64],
    hessian: NDArray[np.float64],
    points: NDArray[np.float64],
    weights: NDArray[np.float64],
    total: float,
    least: float,
) -> None:
    """Take directions that tell too little out of a gradient and a Hessian, in place."""
    if total <= 0.0 or hessian[2, 2] <= 0.0:
        gradient[:] = 0.0
        hessian[:] = 0.0
        return
    a = hessian[0, 0] - hessian[0, 2] ** 2 / hessian[2, 2]
    b = hessian[0, 1] - hessian[0, 2] * hessian[1, 2] / hessian[2, 2]
    c = hessian[1, 1] - hessian[1, 2] ** 2 / hessian[2, 2]
    middle, spread = 0.5 * (a + c), math.hypot(0.5 * (a - c), b)
    if (middle - spread) / total < least:
        angle = 0.5 * math.atan2(2.0 * b, a - c) + 0.5 * math.pi
        _drop(gradient, hessian, np.array([math.cos(angle), math.sin(angle), 0.0]))
    if (middle + spread) / total < least:
        angle = 0.5 * math.atan2(2.0 * b, a - c)
        _drop(gradient, hessian, np.array([math.cos(angle), math.sin(angle), 0.0]))
    around = 0.0
    for i in range(len(weights)):
        around += weights[i] * (points[i, 0] ** 2 + points[i, 1] ** 2)
    if hessian[2, 2] < least * around:
        _drop(gradient, hessian, np.array([0.0, 0.0, 1.0]))


@njit(cache=True)
def _drop(
    gradient: NDArray[np.float64], hessian: NDArray[np.float64], direction: NDArray[np.float64]
) -> None:
    """Take one direction out of a gradient and a Hessian, in place."""
    keep = np.eye(3)
    for i in range(3):
        for j in range(3):
            keep[i, j] -= direction[i] * direction[j]
    gradient[:] = times3(keep, gradient)
    hessian[:] = product3(product3(keep, hessian), keep)


@njit(cache=True)
def _cost(
    pose: NDArray[np.float64], prior: NDArray[np.float64], information: NDArray[np.float64]
) -> float:
    """Half the squared Mahalanobis distance from the prior."""
    return float(0.5 * quadratic3(pose - prior, information))
