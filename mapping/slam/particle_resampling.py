"""Turns particles' log weights into shares, into their effective number, and into survivors."""

import numpy as np
from numpy.typing import ArrayLike, NDArray


def normalised_weights(log_weights: ArrayLike) -> NDArray[np.float64]:
    """Weights ``(n,)`` that sum to 1 from their logarithms ``(n,)``, however small those are."""
    logs = np.asarray(log_weights, dtype=np.float64)
    weights = np.exp(logs - logs.max())
    return np.asarray(weights / weights.sum())


def effective_number(weights: ArrayLike) -> float:
    """Neff, between 1 (one particle has all the weight) and n (Grisetti et al. 2007, eq. 20)."""
    weights = np.asarray(weights, dtype=np.float64)
    return float(np.sum(weights) ** 2 / np.sum(weights**2))


def low_variance_sample(weights: ArrayLike, offset: float) -> NDArray[np.int64]:
    """Which particles survive ``(n,)``, ascending: n pointers a stride apart on the heaped weights.

    A particle of weight w gets floor(n w) or ceil(n w) offspring, n w on average (Thrun et al.
    2005, table 4.4).

    Args:
        weights: ``(n,)``, summing to 1.
        offset: Of the first pointer in strides, uniform in [0, 1).
    """
    weights = np.asarray(weights, dtype=np.float64)
    heaped = np.cumsum(weights)
    pointers = (np.arange(len(weights)) + offset) / len(weights) * heaped[-1]
    survivors = np.searchsorted(heaped, pointers, side="right")
    last_alive = np.flatnonzero(weights)[-1]  # a pointer may be rounded onto the very end
    return np.asarray(np.minimum(survivors, last_alive), dtype=np.int64)
