"""Turns true poses and a floor plan into the least gap ever left between robot and things."""

import numpy as np
from numpy.typing import NDArray

from envs.solids import Disc, Prism, Solid
from nav.outline import BURGER_OUTLINE, Rectangle

LOOK_WITHIN = 0.5
"""Gaps wider than this are not measured: they are of no interest [m]."""


def min_clearance(
    poses_world: NDArray[np.float64],
    solids: tuple[Solid, ...],
    outline: tuple[Rectangle, ...] = BURGER_OUTLINE,
) -> float | None:
    """The least distance [m] between the robot's outline and any solid, over all poses.

    People are no solids: they come as near as they please, and ``contacts`` tells who touched whom.
    Exact while nothing overlaps; 0 when a corner of one lies in the other.

    Args:
        poses_world: True poses of base_footprint ``(n, 3)``.
        solids: What stands on the floor.
        outline: The rectangles that the robot consists of.

    Returns:
        None when nothing was ever nearer than 0.5 m, or there are no poses.
    """
    least = LOOK_WITHIN
    reach = LOOK_WITHIN + max(np.hypot(max(front, back), side) for front, back, side in outline)
    for solid in solids:
        middle, radius = _bounding_circle(solid)
        gaps = np.hypot(*(poses_world[:, :2] - middle).T) - radius
        near = poses_world[gaps < min(reach, least + reach - LOOK_WITHIN)]
        if len(near):
            gaps = [_gaps(near, solid, rectangle).min() for rectangle in outline]
            least = min(least, float(min(gaps)))
    return least if least < LOOK_WITHIN else None


def _bounding_circle(solid: Solid) -> tuple[NDArray[np.float64], float]:
    if isinstance(solid, Disc):
        return solid.center, solid.radius
    middle = solid.vertices.mean(axis=0)
    return middle, float(np.hypot(*(solid.vertices - middle).T).max())


def _gaps(poses: NDArray[np.float64], solid: Solid, rectangle: Rectangle) -> NDArray[np.float64]:
    """Distance ``(n,)`` from a rectangle of the robot at each pose to one solid."""
    if isinstance(solid, Disc):
        centers = _in_base(poses, solid.center[None])
        return np.maximum(_to_rectangle(centers, rectangle)[:, 0] - solid.radius, 0.0)
    corners_of_solid = _to_rectangle(_in_base(poses, solid.vertices), rectangle).min(axis=1)
    corners_of_robot = _to_prism(_corners(poses, rectangle), solid).min(axis=1)
    gaps: NDArray[np.float64] = np.minimum(corners_of_solid, corners_of_robot)
    return gaps


def _in_base(poses: NDArray[np.float64], points: NDArray[np.float64]) -> NDArray[np.float64]:
    """Points ``(k, 2)`` of the world in the base frame of each pose, ``(n, k, 2)``."""
    offsets = points[None] - poses[:, None, :2]
    cos, sin = np.cos(poses[:, 2])[:, None], np.sin(poses[:, 2])[:, None]
    return np.stack(
        (
            cos * offsets[..., 0] + sin * offsets[..., 1],
            -sin * offsets[..., 0] + cos * offsets[..., 1],
        ),
        axis=-1,
    )


def _to_rectangle(points: NDArray[np.float64], rectangle: Rectangle) -> NDArray[np.float64]:
    """Distance ``(n, k)`` of points ``(n, k, 2)`` in the base frame to a rectangle of it."""
    front, back, side = rectangle
    x, y = points[..., 0], points[..., 1]
    beyond_x = np.maximum(np.maximum(x - front, -back - x), 0.0)
    beyond_y = np.maximum(np.abs(y) - side, 0.0)
    distances: NDArray[np.float64] = np.hypot(beyond_x, beyond_y)
    return distances


def _corners(poses: NDArray[np.float64], rectangle: Rectangle) -> NDArray[np.float64]:
    """A rectangle's corners in the world ``(n, 4, 2)``."""
    front, back, side = rectangle
    base = np.array([(x, y) for x in (front, -back) for y in (side, -side)])
    cos, sin = np.cos(poses[:, 2])[:, None], np.sin(poses[:, 2])[:, None]
    return np.stack(
        (
            poses[:, :1] + cos * base[:, 0] - sin * base[:, 1],
            poses[:, 1:2] + sin * base[:, 0] + cos * base[:, 1],
        ),
        axis=-1,
    )


def _to_prism(points: NDArray[np.float64], prism: Prism) -> NDArray[np.float64]:
    """Distance ``(n, k)`` of points ``(n, k, 2)`` to a convex polygon; 0 inside."""
    starts = prism.vertices
    edges = np.roll(starts, -1, axis=0) - starts
    offsets = points[..., None, :] - starts
    shares = np.clip(np.sum(offsets * edges, axis=-1) / np.sum(edges**2, axis=-1), 0.0, 1.0)
    gaps = np.hypot(*np.moveaxis(offsets - shares[..., None] * edges, -1, 0)).min(axis=-1)
    crosses = edges[:, 0] * offsets[..., 1] - edges[:, 1] * offsets[..., 0]
    inside: NDArray[np.bool_] = np.all(crosses > 0.0, axis=-1)
    return np.where(inside, 0.0, gaps)
