"""The Gaussian belief in its two forms, moments and information, and the way from one to other."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from mapping.errors import TestbedError

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Gaussian:
    """A normal distribution by its moments (Probabilistic Robotics, eq. 3.1)."""

    mean: Array
    """``(n,)``."""
    covariance: Array
    """``(n, n)``, symmetric."""

    def __post_init__(self) -> None:
        """Refuse what is no Gaussian."""
        _check("covariance", self.mean, self.covariance)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Information:
    """A normal distribution by its canonical parameters (Probabilistic Robotics, eq. 3.31, 3.32).

    A matrix without inverse says nothing about some direction: full ignorance is all zeros.
    """

    vector: Array
    """xi = Sigma^-1 mu ``(n,)``."""
    matrix: Array
    """Omega = Sigma^-1 ``(n, n)``, symmetric."""

    def __post_init__(self) -> None:
        """Refuse what is no Gaussian."""
        _check("information matrix", self.vector, self.matrix)


def gaussian(mean: ArrayLike, covariance: ArrayLike) -> Gaussian:
    """The Gaussian of a mean ``(n,)`` and a covariance ``(n, n)``."""
    return Gaussian(
        mean=np.array(mean, dtype=np.float64), covariance=np.array(covariance, dtype=np.float64)
    )


def to_information(belief: Gaussian) -> Information:
    """The same belief by its canonical parameters.

    Raises:
        TestbedError: The covariance has no inverse: something is known exactly.
    """
    matrix = symmetric_inverse("covariance", belief.covariance)
    return Information(vector=matrix @ belief.mean, matrix=matrix)


def to_gaussian(belief: Information) -> Gaussian:
    """The same belief by its moments.

    Raises:
        TestbedError: The information matrix has no inverse: nothing is known of something.
    """
    covariance = symmetric_inverse("information matrix", belief.matrix)
    return Gaussian(mean=covariance @ belief.vector, covariance=covariance)


def symmetric(matrix: Array) -> Array:
    """The matrix without the asymmetry that rounding brings in."""
    return np.asarray(0.5 * (matrix + matrix.T))


def symmetric_inverse(name: str, matrix: Array) -> Array:
    """The inverse of a symmetric matrix, symmetric.

    Raises:
        TestbedError: It has none.
    """
    try:
        return symmetric(np.asarray(np.linalg.inv(matrix), dtype=np.float64))
    except np.linalg.LinAlgError:
        raise TestbedError(f"{name}: singular; must have an inverse") from None


def _check(name: str, vector: Array, matrix: Array) -> None:
    size = len(vector) if vector.ndim == 1 else -1
    if matrix.shape != (size, size):
        raise TestbedError(f"{name}: shape {matrix.shape}; must be ({size}, {size}) as the vector")
    if not (np.all(np.isfinite(vector)) and np.all(np.isfinite(matrix))):
        raise TestbedError(f"{name}: an entry is not finite; all must be")
