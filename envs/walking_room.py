"""Tells whether a person's legs stay clear of what stands on the floor."""

from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray

from envs.pedestrians import LEG_RADIUS, Pedestrian
from envs.plan_parts import Part
from envs.solids import Disc, Prism, Solid, bounds
from mapping.errors import TestbedError

Segments = NDArray[np.float64]


def check_walk(person: Pedestrian, parts: Iterable[tuple[str, Part]]) -> None:
    """Refuse a walk on which a leg would touch a part of the plan.

    Raises:
        TestbedError: It names the part and the place.
    """
    swings = swings_of(person)
    low, high = swings.min(axis=(0, 1)) - LEG_RADIUS, swings.max(axis=(0, 1)) + LEG_RADIUS
    for label, part in parts:
        for solid in part.solids():
            left, right, bottom, top = bounds(solid)
            if left > high[0] or right < low[0] or bottom > high[1] or top < low[1]:
                continue
            gaps = gaps_to(solid, swings)
            worst = int(np.argmin(gaps))
            if gaps[worst] < LEG_RADIUS:
                x, y = swings[worst].mean(axis=0)
                where = "through" if gaps[worst] <= 0.0 else f"{gaps[worst]:.3f} m past"
                raise TestbedError(
                    f"waypoints: near ({x:.2f}, {y:.2f}) a leg goes {where} {label}; "
                    f"legs need {LEG_RADIUS} m"
                )


def swings_of(person: Pedestrian) -> Segments:
    """The straight ways ``(n, 2, 2)`` on which the legs' axes move in one round [m]."""
    footsteps = person.footsteps()
    return np.stack((footsteps, np.roll(footsteps, -2, axis=0)), axis=1)


def gaps_to(solid: Solid, segments: Segments) -> NDArray[np.float64]:
    """Distances ``(n,)`` [m] of segments ``(n, 2, 2)`` to a solid; 0 where one meets it."""
    if isinstance(solid, Disc):
        center = np.asarray(solid.center)[None]
        to_center = _to_points(segments, center)[:, 0]
        return np.asarray(np.maximum(to_center - solid.radius, 0.0))
    edges = np.stack((solid.vertices, np.roll(solid.vertices, -1, axis=0)), axis=1)
    corners = _to_points(segments, solid.vertices).min(axis=1)
    ends = np.stack([_to_points(edges, segments[:, end]).min(axis=0) for end in (0, 1)], axis=1)
    apart = np.minimum(corners, ends.min(axis=1))
    return np.where(_meets(solid, segments), 0.0, apart)


def _to_points(segments: Segments, points: NDArray[np.float64]) -> NDArray[np.float64]:
    """Distances ``(n, k)`` of segments ``(n, 2, 2)`` to points ``(k, 2)``."""
    starts, along = segments[:, 0], segments[:, 1] - segments[:, 0]
    offsets = points[None] - starts[:, None]
    lengths = np.maximum(np.sum(along * along, axis=1), np.finfo(np.float64).tiny)
    shares = np.clip(np.sum(offsets * along[:, None], axis=2) / lengths[:, None], 0.0, 1.0)
    nearest = offsets - shares[..., None] * along[:, None]
    return np.asarray(np.hypot(nearest[..., 0], nearest[..., 1]))


def _meets(prism: Prism, segments: Segments) -> NDArray[np.bool_]:
    """Which segments have a point in a convex prism: its edges clip each from both ends."""
    edges = np.roll(prism.vertices, -1, axis=0) - prism.vertices
    inward = np.stack((-edges[:, 1], edges[:, 0]), axis=1)
    depth = np.einsum("nek,vk->env", segments, inward) - np.sum(inward * prism.vertices, axis=1)
    start, change = depth[0], depth[1] - depth[0]
    with np.errstate(divide="ignore", invalid="ignore"):
        crossing = -start / change
    enters = np.where(change > 0.0, crossing, np.where(start >= 0.0, 0.0, np.inf))
    leaves = np.where(change < 0.0, crossing, 1.0)
    first, last = np.maximum(enters.max(axis=1), 0.0), np.minimum(leaves.min(axis=1), 1.0)
    return np.asarray(first <= last)
