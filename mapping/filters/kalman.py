"""Turns a Gaussian belief, a control and a measurement of a linear system into the next belief.

The Kalman filter (Probabilistic Robotics, table 3.1; thesis, table 3.2), line by line. The system:

    x_t = A x_t-1 + B u_t + noise of covariance R (the thesis's D)
    z_t = C x_t + noise of covariance Q
"""

import numpy as np
from numpy.typing import ArrayLike, NDArray

from mapping.filters.gaussian import Gaussian, symmetric

Array = NDArray[np.float64]


def predict(
    belief: Gaussian, a: ArrayLike, noise: ArrayLike, b: ArrayLike = 0.0, control: ArrayLike = 0.0
) -> Gaussian:
    """The belief after a control: lines 2 and 3.

    Args:
        belief: Before it, of ``n`` states.
        a: How the state goes on by itself ``(n, n)``.
        noise: Covariance R of what is added at random ``(n, n)``.
        b: What the control adds ``(n, k)``.
        control: u_t ``(k,)``; nothing by default.
    """
    a, b, control = (np.asarray(value, dtype=np.float64) for value in (a, b, control))
    pushed = b @ control if b.ndim == 2 else b * control
    return Gaussian(
        mean=a @ belief.mean + pushed,
        covariance=symmetric(a @ belief.covariance @ a.T + np.asarray(noise)),
    )


def correct(prior: Gaussian, c: ArrayLike, measurement: ArrayLike, noise: ArrayLike) -> Gaussian:
    """The belief after a measurement: lines 4 to 6.

    Args:
        prior: Before it, of ``n`` states.
        c: What the measurement would be without noise ``(m, n)``.
        measurement: z_t ``(m,)``.
        noise: Covariance Q of its error ``(m, m)``.
    """
    c = np.asarray(c, dtype=np.float64)
    innovation = np.asarray(measurement, dtype=np.float64) - c @ prior.mean
    return updated(prior, c, innovation, np.asarray(noise, dtype=np.float64))


def updated(
    prior: Gaussian, c: Array, innovation: Array, noise: Array, shared: Array | None = None
) -> Gaussian:
    """The belief after an innovation, of a linear or a linearised measurement.

    The covariance is written as (I - K C) Sigma (I - K C)' + K Q K' (Joseph), which is the table's
    (I - K C) Sigma and stays positive definite when rounded.

    Args:
        prior: The belief before.
        c: How the measurement changes with the state ``(m, n)``.
        innovation: What was measured less what was expected ``(m,)``.
        noise: Covariance Q of the measurement's error ``(m, m)``.
        shared: Covariance of the state's newest error with the measurement's ``(n, m)``, where
            one noise enters both (Bar-Shalom et al., Estimation, 2001, 8.3); none by default.
    """
    cross = prior.covariance @ c.T
    spread = c @ cross + noise
    if shared is not None:
        cross = cross + shared
        spread = spread + c @ shared + shared.T @ c.T
    gain = np.linalg.solve(spread.T, cross.T).T
    keep = np.eye(len(prior.mean)) - gain @ c
    covariance = keep @ prior.covariance @ keep.T + gain @ noise @ gain.T
    if shared is not None:
        both = keep @ shared @ gain.T
        covariance = covariance - both - both.T
    return Gaussian(mean=prior.mean + gain @ innovation, covariance=symmetric(covariance))
