"""Turns importance weights into the particles that survive, and into how many there should be."""

import math

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.special import ndtri

from mapping.errors import TestbedError

Array = NDArray[np.float64]


def normalised(log_weights: ArrayLike) -> Array:
    """Weights ``(n,)`` that sum to 1 from their logarithms ``(n,)``, however small those are.

    Raises:
        TestbedError: No weight is above 0, or one is not a number.
    """
    logs = np.asarray(log_weights, dtype=np.float64)
    highest = float(logs.max()) if logs.size else -math.inf
    if not math.isfinite(highest):
        raise TestbedError(f"weights: highest log weight {highest}; must be finite")
    weights = np.exp(logs - highest)
    return np.asarray(weights / weights.sum())


def effective_number(weights: ArrayLike) -> float:
    """How many particles carry the weight: 1 (one has it all) to n (Liu 1996).

    Neff of Grisetti et al. 2007, eq. 20.
    """
    weights = np.asarray(weights, dtype=np.float64)
    return float(np.sum(weights) ** 2 / np.sum(weights**2))


def importance_sample(weights: ArrayLike, count: int, rng: np.random.Generator) -> NDArray[np.intp]:
    """Survivors ``(count,)``, each drawn by itself with probability proportional to its weight.

    The drawing of the particle filter's lines 8 to 11 (Probabilistic Robotics, table 4.3; thesis,
    table 3.5).
    """
    heaped = np.cumsum(np.asarray(weights, dtype=np.float64))
    return _pointed_at(heaped, rng.random(count) * heaped[-1])


def low_variance_sample(weights: ArrayLike, count: int, offset: float) -> NDArray[np.intp]:
    """Survivors ``(count,)``, ascending: pointers a stride apart on the heaped weights.

    A particle of weight w (of a sum of 1) gets floor(count w) or ceil(count w) offspring, count w
    on average (Probabilistic Robotics, table 4.4).

    Args:
        weights: ``(n,)``.
        count: How many to draw.
        offset: Of the first pointer in strides, uniform in [0, 1).
    """
    heaped = np.cumsum(np.asarray(weights, dtype=np.float64))
    return _pointed_at(heaped, (np.arange(count) + offset) / count * heaped[-1])


def kld_sample_size(bins: int, error: float, confidence: float) -> int:
    """How many particles keep the approximation of a belief good (Fox 2003).

    With so many, the Kullback-Leibler divergence between the belief and its particles is below
    ``error`` with probability ``confidence``, if the belief covers ``bins`` bins: the quantile of
    the chi-square distribution with bins - 1 degrees of freedom, over twice the error, in the
    approximation of Wilson and Hilferty (Probabilistic Robotics, table 8.4, line 16).

    Args:
        bins: Bins of the state space that the belief covers.
        error: epsilon [nats].
        confidence: 1 - delta.

    Returns:
        The number of particles; 1 for up to one bin.
    """
    if bins <= 1:
        return 1
    degrees = bins - 1
    spread = 2.0 / (9.0 * degrees)
    quantile = degrees * (1.0 - spread + math.sqrt(spread) * float(ndtri(confidence))) ** 3
    return math.ceil(quantile / (2.0 * error))


def _pointed_at(heaped: Array, pointers: Array) -> NDArray[np.intp]:
    """The particles that pointers on the heap hit; none without weight, however rounded."""
    last_alive = int(np.searchsorted(heaped, heaped[-1], side="left"))
    return np.minimum(np.searchsorted(heaped, pointers, side="right"), last_alive)
