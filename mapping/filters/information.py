"""Turns a belief in information form, a control and a measurement into the next such belief.

The information filter (Probabilistic Robotics, table 3.4; thesis, table 3.3), the dual of the
Kalman filter: correcting is an addition, predicting takes two inversions.
"""

import numpy as np
from numpy.typing import ArrayLike

from mapping.filters.gaussian import Information, symmetric, symmetric_inverse, to_gaussian


def predict(
    belief: Information,
    a: ArrayLike,
    noise: ArrayLike,
    b: ArrayLike = 0.0,
    control: ArrayLike = 0.0,
) -> Information:
    """The belief after a control: lines 2 and 3; arguments as ``kalman.predict``.

    Raises:
        TestbedError: Nothing is known of some direction, so that there is no mean to move.
    """
    a, b, control = (np.asarray(value, dtype=np.float64) for value in (a, b, control))
    pushed = b @ control if b.ndim == 2 else b * control
    before = to_gaussian(belief)
    spread = a @ before.covariance @ a.T + np.asarray(noise)
    matrix = symmetric_inverse("prior covariance", spread)
    return Information(vector=matrix @ (a @ before.mean + pushed), matrix=matrix)


def correct(
    prior: Information, c: ArrayLike, measurement: ArrayLike, noise: ArrayLike
) -> Information:
    """The belief after a measurement: lines 4 and 5; arguments as ``kalman.correct``.

    Raises:
        TestbedError: The noise has no inverse: a measurement without error.
    """
    c = np.asarray(c, dtype=np.float64)
    weighed = c.T @ symmetric_inverse("measurement noise", np.asarray(noise, dtype=np.float64))
    return Information(
        vector=prior.vector + weighed @ np.asarray(measurement, dtype=np.float64),
        matrix=symmetric(prior.matrix + weighed @ c),
    )
