"""Kernels for matrices of 3 x 3; NumPy's are made for large ones and would take half of a match."""

import numpy as np
from numba import njit
from numpy.typing import NDArray

Matrix = NDArray[np.float64]


@njit(cache=True)
def inverse3(m: Matrix) -> Matrix:
    """The inverse ``(3, 3)`` of a matrix, by its cofactors; NaN or infinite when it has none."""
    out = np.empty((3, 3))
    for i in range(3):
        a, b = (i + 1) % 3, (i + 2) % 3
        for j in range(3):
            c, d = (j + 1) % 3, (j + 2) % 3
            out[j, i] = m[a, c] * m[b, d] - m[a, d] * m[b, c]
    determinant = m[0, 0] * out[0, 0] + m[0, 1] * out[1, 0] + m[0, 2] * out[2, 0]
    out /= determinant
    return out


@njit(cache=True)
def product3(a: Matrix, b: Matrix) -> Matrix:
    """The product ``(3, 3)`` of two matrices."""
    out = np.zeros((3, 3))
    for i in range(3):
        for j in range(3):
            for k in range(3):
                out[i, j] += a[i, k] * b[k, j]
    return out


@njit(cache=True)
def times3(a: Matrix, v: NDArray[np.float64]) -> NDArray[np.float64]:
    """A matrix times a vector ``(3,)``."""
    out = np.zeros(3)
    for i in range(3):
        for k in range(3):
            out[i] += a[i, k] * v[k]
    return out


@njit(cache=True)
def quadratic3(v: NDArray[np.float64], a: Matrix) -> float:
    """A vector ``(3,)`` times a matrix times the vector."""
    w = times3(a, v)
    return float(v[0] * w[0] + v[1] * w[1] + v[2] * w[2])
