"""Turns a Gaussian belief, a control and a measurement of a curved system into the next belief.

The extended Kalman filter (Probabilistic Robotics, table 3.3; thesis, table 3.4): the Kalman filter
of the system that is tangent at the mean.
"""

from collections.abc import Callable

import numpy as np
from numpy.typing import ArrayLike, NDArray

from mapping.filters import kalman
from mapping.filters.gaussian import Gaussian, symmetric

Array = NDArray[np.float64]

Model = Callable[[Array], tuple[Array, Array]]
"""What a state ``(n,)`` becomes or lets expect ``(m,)``, and the Jacobian of that ``(m, n)``."""

Difference = Callable[[Array, Array], Array]
"""One value less another; for angles it must go the short way round."""


def predict(belief: Gaussian, motion: Model, noise: ArrayLike) -> Gaussian:
    """The belief after a control: lines 2 and 3.

    Args:
        belief: Before it.
        motion: g(u_t, .) and its Jacobian G_t, for the control that was given.
        noise: Covariance R of what is added at random ``(n, n)``.
    """
    mean, jacobian = motion(belief.mean)
    return Gaussian(
        mean=mean,
        covariance=symmetric(jacobian @ belief.covariance @ jacobian.T + np.asarray(noise)),
    )


def correct(
    prior: Gaussian,
    sensor: Model,
    measurement: ArrayLike,
    noise: ArrayLike,
    *,
    difference: Difference = np.subtract,
    gate: float = np.inf,
    shared: ArrayLike | None = None,
) -> Gaussian:
    """The belief after a measurement: lines 4 to 6; the prior itself if it is not believed.

    Args:
        prior: Before it.
        sensor: h and its Jacobian H_t.
        measurement: z_t ``(m,)``.
        noise: Covariance Q of its error ``(m, m)``.
        difference: How z_t - h is taken.
        gate: A measurement this many standard deviations (Mahalanobis) from what was expected is
            not believed.
        shared: As in ``kalman.updated``.
    """
    expected, jacobian = sensor(prior.mean)
    innovation = difference(np.asarray(measurement, dtype=np.float64), expected)
    noise = np.asarray(noise, dtype=np.float64)
    both = None if shared is None else np.asarray(shared, dtype=np.float64)
    if np.isfinite(gate):
        distance = squared_distance(prior, jacobian, innovation, noise, both)
        if not distance <= gate * gate:
            return prior
    return kalman.updated(prior, jacobian, innovation, noise, both)


def squared_distance(
    prior: Gaussian, jacobian: Array, innovation: Array, noise: Array, shared: Array | None = None
) -> float:
    """The squared Mahalanobis distance of an innovation ``(m,)`` from what was expected."""
    spread = jacobian @ prior.covariance @ jacobian.T + noise
    if shared is not None:
        spread = spread + jacobian @ shared + shared.T @ jacobian.T
    return float(innovation @ np.linalg.solve(spread, innovation))
