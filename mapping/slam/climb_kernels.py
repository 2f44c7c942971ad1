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

TINY = 1e-30
"""Keeps a division by nothing from failing."""

HALF_LEVER = 0.5
"""A turn counts as the way of a point half as far away as the farthest."""

FAR_STEEPER = 10.0
"""Times the whole curvature: what a dropped direction is given, so that it is not found again."""

SINGULAR = 1e-9
"""Added to a curvature, relative to its size, so that it has an inverse."""


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

    A direction about which the scan tells less than ``least`` a reading, as along a bare corridor,
    is left to the prior (``drop_flat``): what slope there is comes from the noise of the walls.

    Args:
        density: The field ``(rows, columns, SIDES)``.
        start: Where to start climbing ``(3,)``: x, y in cells, yaw [rad].
        prior: Mean of the prior ``(3,)`` in the same units.
        information: Its inverse covariance ``(3, 3)``.
        points: Readings in the scan's frame, in cells ``(n, 2)``.
        normals: Directions that their walls face ``(n, 2)``, zeros where unknown.
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
        length = max(math.hypot(step[0], step[1]), HALF_LEVER * lever * abs(step[2]))
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
        gradient, tried_gradient = tried_gradient, gradient
        hessian, tried_hessian = tried_hessian, hessian
        scatter, tried_scatter = tried_scatter, scatter
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
    """Take directions that tell too little out of a gradient and a Hessian, in place.

    A direction is one of shift and turn together, as around the middle of a round room; a turn
    counts by how far it moves a typical reading.

    Args:
        gradient: Slope over x, y [1/cell] and yaw ``(3,)``.
        hessian: Negative curvature ``(3, 3)``.
        points: Readings in the scan's frame, in cells ``(n, 2)``.
        weights: How much each tells ``(n,)``.
        total: The weight that lies on walls.
        least: Least curvature per weight [1/cells^2] of a direction that is kept.
    """
    around = 0.0
    for i in range(len(weights)):
        around += weights[i] * (points[i, 0] ** 2 + points[i, 1] ** 2)
    lever = math.sqrt(around / max(weights.sum(), TINY))
    if total <= 0.0 or lever <= 0.0:
        gradient[:] = 0.0
        hessian[:] = 0.0
        return
    scale = np.array([1.0, 1.0, lever])
    slope, curvature = gradient / scale, hessian.copy()
    for i in range(3):
        for j in range(3):
            curvature[i, j] /= scale[i] * scale[j]
    dropped = np.zeros((3, 3))
    for count in range(3):
        direction = _flattest(curvature, dropped)
        if quadratic3(direction, curvature) >= least * total:
            break
        for i in range(3):
            for j in range(3):
                dropped[i, j] += direction[i] * direction[j]
        if count == 2:
            dropped = np.eye(3)
        keep = np.eye(3) - dropped
        slope = times3(keep, slope)
        curvature = product3(product3(keep, curvature), keep)
    for i in range(3):
        gradient[i] = slope[i] * scale[i]
        for j in range(3):
            hessian[i, j] = curvature[i, j] * scale[i] * scale[j]


@njit(cache=True)
def _flattest(curvature: NDArray[np.float64], dropped: NDArray[np.float64]) -> NDArray[np.float64]:
    """The direction ``(3,)`` of least curvature but for those dropped already.

    By inverse iteration, squared: seven squarings are 128 steps. Dropped directions are given more
    curvature than any other has.
    """
    size = curvature[0, 0] + curvature[1, 1] + curvature[2, 2] + TINY
    power = inverse3(curvature + FAR_STEEPER * size * dropped + SINGULAR * size * np.eye(3))
    for _ in range(7):
        power = product3(power, power)
        power /= power[0, 0] + power[1, 1] + power[2, 2]
    best = 0
    for k in range(3):
        if power[k, k] > power[best, best]:
            best = k
    direction: NDArray[np.float64] = power[:, best].copy()
    length = math.sqrt((direction * direction).sum())
    for k in range(3):
        direction[k] /= length
    return direction


@njit(cache=True)
def _cost(
    pose: NDArray[np.float64], prior: NDArray[np.float64], information: NDArray[np.float64]
) -> float:
    """Half the squared Mahalanobis distance from the prior."""
    return float(0.5 * quadratic3(pose - prior, information))
