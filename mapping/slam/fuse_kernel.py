"""Kernel that weighs what a scan says against what was predicted."""

import numpy as np
from numba import njit
from numpy.typing import NDArray

from mapping.slam.matrix_kernels import inverse3, product3, quadratic3, times3

RIDGE = 1e-9
"""Added to the scatter, relative to its largest element, so that it has an inverse."""

LEAST_SCATTER = 0.1
"""Slopes scatter at least by this share of the curvature, as readings do whose noise is a third of
the bells' width: a handful that happens to fit says no more than that."""


@njit(cache=True)
def scan_information(
    curvature: NDArray[np.float64],
    scatter: NDArray[np.float64],
    sharpest: NDArray[np.float64],
) -> NDArray[np.float64]:
    """The information ``(3, 3)`` of a scan: the inverse of its sandwich covariance (Huber 1967).

    The bells of the field are wider than the readings' noise, so the curvature alone says too
    little; how far the readings really lie from the bells' middles is in the scatter of their
    slopes. A direction without curvature has no information.

    Args:
        curvature: Of the negative log likelihood ``(3, 3)``.
        scatter: Sum of the outer products of the readings' slopes ``(3, 3)``.
        sharpest: Covariance that is added, below which no scan is believed ``(3, 3)``; diagonal.
    """
    largest = max(scatter[0, 0], max(scatter[1, 1], scatter[2, 2]))
    ridged = scatter + LEAST_SCATTER * curvature + RIDGE * largest * np.eye(3)
    told: NDArray[np.float64] = product3(product3(curvature, inverse3(ridged)), curvature)
    # (told^-1 + sharpest)^-1, also when told has no inverse (Woodbury)
    widened = told.copy()
    for i in range(3):
        widened[i, i] += 1.0 / sharpest[i, i]
    lost: NDArray[np.float64] = product3(product3(told, inverse3(widened)), told)
    return told - lost


@njit(cache=True)
def fuse(
    predicted: NDArray[np.float64],
    covariance: NDArray[np.float64],
    offset: NDArray[np.float64],
    told: NDArray[np.float64],
    nothing: float,
    surprising: float,
) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64], float]:
    """The pose between a prediction and a scan, as a Kalman filter has it.

    A prediction that the scan contradicts is taken to be as much less sure as it takes.

    Args:
        predicted: The prediction ``(3,)``.
        covariance: Its covariance ``(3, 3)``.
        offset: Where the scan says to be, less the prediction ``(3,)``, the yaw wrapped.
        told: The scan's information ``(3, 3)``.
        nothing: Information, along each axis, of a scan that tells nothing.
        surprising: Squared standard deviations beyond which the prediction is contradicted.

    Returns:
        The pose ``(3,)``, its covariance, the covariance of what the scan says, and how far the
        two contradict one another, 1 where that begins to be surprising.
    """
    seen = inverse3(told + nothing * np.eye(3))
    surprise = quadratic3(offset, inverse3(covariance + seen)) / surprising
    fused = inverse3(told + inverse3(covariance * max(surprise, 1.0)))
    return predicted + times3(fused, times3(told, offset)), fused, seen, surprise
