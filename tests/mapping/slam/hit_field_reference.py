"""Plain and slow references of the hit field's kernels."""

import numpy as np
from hypothesis import strategies as st
from numpy.typing import NDArray
from scipy.interpolate import NdBSpline

from mapping.slam.hit_field_kernels import FAINT, KNOWN, SIDES

Array = NDArray[np.float64]

FACINGS = np.array([(1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0)])
"""The sides that walls are seen from, as directions."""

SEEDS = st.integers(0, 10_000)


def turned(vectors: Array, yaw: float) -> Array:
    cos, sin = np.cos(yaw), np.sin(yaw)
    return np.asarray(vectors @ np.array([[cos, sin], [-sin, cos]]))


def directions(rng: np.random.Generator, count: int) -> Array:
    """Unit vectors, about a third of them unknown: zeros."""
    angles = rng.uniform(-np.pi, np.pi, count)
    known = rng.random(count) > 0.3
    return np.column_stack((np.cos(angles), np.sin(angles))) * known[:, None]


def slow_shares(normal: Array, unknown: float) -> Array:
    """A wall's share of each side: the squared cosine to it, where that is positive."""
    if not np.any(normal):
        return np.full(SIDES, unknown)
    return np.asarray(np.maximum(FACINGS @ normal, 0.0) ** 2)


def slow_smear(
    shape: tuple[int, int], pose: Array, surface: NDArray[np.float32], edge: float, height: float
) -> Array:
    """Bells added up over the whole field, cut where the kernel may cut them."""
    field = np.zeros((*shape, SIDES))
    rows, columns = np.indices(shape)
    for x, y, weight, nx, ny in surface.astype(float):
        at = turned(np.array([x, y]), pose[2]) / edge + pose[:2]
        dx, dy = columns + 0.5 - at[0], rows + 0.5 - at[1]
        bell = height * weight * np.exp(-0.5 * (dx**2 + dy**2))
        field += bell[..., None] * slow_shares(turned(np.array([nx, ny]), pose[2]), 0.5)
    return field


def slow_terms(
    density: Array, pose: Array, points: Array, normals: Array, weights: Array, outlier: float
) -> tuple[Array, Array, Array, float, float]:
    """Gradient, Hessian, scatter, likelihood and share, from SciPy's splines and eigenvectors."""
    gradient, hessian, scatter = np.zeros(3), np.zeros((3, 3)), np.zeros((3, 3))
    likelihood = matched = 0.0
    rows, columns, _ = density.shape
    knots = np.arange(-2.0, rows + 2.0), np.arange(-2.0, columns + 2.0)
    for point, normal, weight in zip(points, normals, weights, strict=True):
        arm, facing = turned(point, pose[2]), turned(normal, pose[2])
        x, y = pose[:2] + arm - 0.5
        if not (1 <= np.floor(y) < rows - 2 and 1 <= np.floor(x) < columns - 2):
            likelihood += weight * np.log(outlier)
            continue
        shares = slow_shares(facing, 1.0)
        shares = shares / (np.sum(shares**2) if np.any(normal) else 1.0)
        spline = NdBSpline(knots, density @ shares, 3)
        height = float(spline([[y, x]])[0])
        level = height + outlier
        likelihood += weight * np.log(level)
        matched += weight * height / (height + KNOWN)
        if height < FAINT:
            continue
        slope = np.array([spline([[y, x]], nu=nu)[0] for nu in ((0, 1), (1, 0))]) / level
        xx, xy, yy = (spline([[y, x]], nu=nu)[0] / level for nu in ((0, 2), (1, 1), (2, 0)))
        bend = np.outer(slope, slope) - np.array([[xx, xy], [xy, yy]])
        if np.any(normal):
            across = np.outer(facing, facing)
            slope, bend = across @ slope, across @ bend @ across
        values, vectors = np.linalg.eigh(bend)
        if values[1] <= 1e-15:
            continue  # beyond where the bell bends, a slope leads Newton's step astray
        jacobian = np.array([[1.0, 0.0, -arm[1]], [0.0, 1.0, arm[0]]])
        bend = vectors @ np.diag(np.maximum(values, 0.0)) @ vectors.T
        own = weight * jacobian.T @ slope
        gradient += own
        scatter += np.outer(own, own)
        hessian += weight * jacobian.T @ bend @ jacobian
    return gradient, hessian, scatter, likelihood, matched / weights.sum()
