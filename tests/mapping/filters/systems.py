"""Random linear systems and beliefs for the tests of filters."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mapping.filters.gaussian import Gaussian

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class LinearSystem:
    a: Array
    b: Array
    c: Array
    motion_noise: Array
    sensor_noise: Array
    start: Gaussian
    controls: Array
    measurements: Array


def random_system(seed: int, *, states: int = 3, steps: int = 12) -> LinearSystem:
    """A stable system with as many steps of controls and measurements that fit it."""
    rng = np.random.default_rng(seed)
    rotation, _ = np.linalg.qr(rng.standard_normal((states, states)))
    a = 0.95 * rotation
    b, c = rng.standard_normal((states, 2)), rng.standard_normal((2, states))
    motion_noise, sensor_noise = random_covariance(rng, states), random_covariance(rng, 2)
    start = Gaussian(mean=rng.standard_normal(states), covariance=random_covariance(rng, states))
    controls = rng.standard_normal((steps, 2))
    state, measurements = start.mean, []
    for control in controls:
        state = a @ state + b @ control + rng.multivariate_normal(np.zeros(states), motion_noise)
        measurements.append(c @ state + rng.multivariate_normal(np.zeros(2), sensor_noise))
    return LinearSystem(
        a=a,
        b=b,
        c=c,
        motion_noise=motion_noise,
        sensor_noise=sensor_noise,
        start=start,
        controls=controls,
        measurements=np.array(measurements),
    )


def random_covariance(rng: np.random.Generator, size: int) -> Array:
    root = rng.standard_normal((size, size))
    return np.asarray(root @ root.T + 0.1 * np.eye(size))
