"""Turns an information belief, a control and a measurement of a curved system into the next one.

The extended information filter (Probabilistic Robotics, table 3.5), the dual of the extended Kalman
filter. Both models are linearised at the mean, which must be recovered from the belief every time.
"""

import numpy as np
from numpy.typing import ArrayLike

from mapping.filters.extended_kalman import Difference, Model
from mapping.filters.gaussian import Information, symmetric, symmetric_inverse, to_gaussian


def predict(belief: Information, motion: Model, noise: ArrayLike) -> Information:
    """The belief after a control: lines 2 to 5; arguments as ``extended_kalman.predict``.

    Raises:
        TestbedError: Nothing is known of some direction, so that there is no mean to move.
    """
    before = to_gaussian(belief)
    mean, jacobian = motion(before.mean)
    spread = jacobian @ before.covariance @ jacobian.T + np.asarray(noise)
    matrix = symmetric_inverse("prior covariance", spread)
    return Information(vector=matrix @ mean, matrix=matrix)


def correct(
    prior: Information,
    sensor: Model,
    measurement: ArrayLike,
    noise: ArrayLike,
    *,
    difference: Difference = np.subtract,
) -> Information:
    """The belief after a measurement: lines 6 to 8; arguments as ``extended_kalman.correct``.

    Raises:
        TestbedError: There is no mean to linearise at, or the measurement has no error.
    """
    mean = to_gaussian(prior).mean
    expected, jacobian = sensor(mean)
    innovation = difference(np.asarray(measurement, dtype=np.float64), expected)
    noise = np.asarray(noise, dtype=np.float64)
    weighed = jacobian.T @ symmetric_inverse("measurement noise", noise)
    return Information(
        vector=prior.vector + weighed @ (innovation + jacobian @ mean),
        matrix=symmetric(prior.matrix + weighed @ jacobian),
    )
