"""The two shapes every floor plan comes down to: upright convex prisms and upright cylinders."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray


@dataclass(frozen=True, slots=True, kw_only=True)
class Prism:
    """A convex polygon standing on the floor."""

    vertices: NDArray[np.float64]
    """Corners ``(n, 2)`` [m], n >= 3, counter-clockwise, strictly convex."""
    height: float
    """Height above the floor [m]."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Disc:
    """A circle standing on the floor."""

    center: NDArray[np.float64]
    """Centre ``(2,)`` [m]."""
    radius: float
    height: float


Solid = Prism | Disc


def distance(solid: Solid, point: ArrayLike) -> float:
    """How far a point (x, y) lies from a solid [m]; 0 in it or on its edge."""
    point = np.asarray(point, dtype=np.float64)
    if isinstance(solid, Disc):
        return max(0.0, math.dist(point, solid.center) - solid.radius)
    edges = np.roll(solid.vertices, -1, axis=0) - solid.vertices
    to_point = point - solid.vertices
    if np.all(edges[:, 0] * to_point[:, 1] - edges[:, 1] * to_point[:, 0] >= 0.0):
        return 0.0
    along = np.clip(np.sum(edges * to_point, axis=1) / np.sum(edges * edges, axis=1), 0.0, 1.0)
    return float(np.min(np.hypot(*(to_point - along[:, None] * edges).T)))


def bounds(solid: Solid) -> tuple[float, float, float, float]:
    """The upright rectangle round a solid: left, right, bottom, top [m]."""
    if isinstance(solid, Disc):
        (x, y), r = solid.center.tolist(), solid.radius
        return x - r, x + r, y - r, y + r
    (left, bottom), (right, top) = solid.vertices.min(axis=0), solid.vertices.max(axis=0)
    return float(left), float(right), float(bottom), float(top)
