"""Cut a simple polygon into few convex pieces: ear clipping, then merging across its diagonals.

Ear clipping after Meisters (1975), "Polygons have ears"; merging after Hertel and Mehlhorn (1983),
"Fast triangulation of simple polygons", who show that it leaves at most four times the fewest.
"""

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

Vertices = NDArray[np.float64]
Ring = list[int]
"""Indices of vertices, counter-clockwise."""

_ZERO_AREA = 1e-12
"""A triangle of less area [m2] than this counts as flat (a micrometre square)."""


def convex_pieces(vertices: Sequence[tuple[float, float]]) -> list[Vertices]:
    """Strictly convex, counter-clockwise pieces ``(n, 2)`` that tile a simple polygon.

    Args:
        vertices: Corners [m] in either orientation; the first may be repeated at the end.
            The polygon must be simple (see ``is_simple``).
    """
    points = outline(vertices)
    rings = _merge(points, _clip_ears(points))
    pieces = [_without_straight(points[ring]) for ring in rings]
    return [piece for piece in pieces if len(piece) >= 3]


def is_simple(vertices: Sequence[tuple[float, float]]) -> bool:
    """Whether a polygon encloses an area and its edges meet only where they follow one another."""
    points = outline(vertices)
    if len(points) < 3 or abs(signed_area(points)) <= _ZERO_AREA:
        return False
    first, second = np.triu_indices(len(points), k=1)
    neighbours = (second - first == 1) | ((first == 0) & (second == len(points) - 1))
    ends = np.roll(points, -1, axis=0)
    a, b, c, d = points[first], ends[first], points[second], ends[second]
    meet = _touch(a, b, c, d)
    if np.any(meet & ~neighbours):
        return False
    # Neighbours share a point by nature; they must not fold back onto one another.
    ahead, behind = ends - points, np.roll(points, 1, axis=0) - points
    return not np.any((_cross(ahead, behind) == 0.0) & (np.sum(ahead * behind, axis=1) > 0.0))


def outline(vertices: Sequence[tuple[float, float]]) -> Vertices:
    """The corners ``(n, 2)`` counter-clockwise, without points repeated one after the other."""
    points = np.array(vertices, dtype=np.float64).reshape(-1, 2)
    points = points[np.any(points != np.roll(points, 1, axis=0), axis=1)]
    return points[::-1] if len(points) and signed_area(points) < 0.0 else points


def signed_area(points: Vertices) -> float:
    """Area of a polygon [m2], positive when its corners run counter-clockwise."""
    return 0.5 * float(np.sum(_cross(points, np.roll(points, -1, axis=0))))


def _clip_ears(points: Vertices) -> list[Ring]:
    """Triangles of a simple, counter-clockwise polygon; flat corners are dropped on the way.

    The plumpest ear goes first, which keeps slivers few. Cutting an ear off changes only what its
    two neighbours are, so the others' plumpness is kept.
    """
    ring, triangles = list(range(len(points))), []
    plumpness = {corner: _plumpness(points, ring, spot) for spot, corner in enumerate(ring)}
    while len(ring) > 3:
        spot = max(range(len(ring)), key=lambda spot: plumpness[ring[spot]])
        if plumpness[ring[spot]] == 0.0:  # rounding hid the ear that there must be
            spot = int(np.argmax([_corner_area(points, ring, i) for i in range(len(ring))]))
        if _corner_area(points, ring, spot) > _ZERO_AREA:
            triangles.append(_triangle(ring, spot))
        del ring[spot]
        for beside in (spot - 1, spot % len(ring)):
            plumpness[ring[beside]] = _plumpness(points, ring, beside)
    return [*triangles, ring]


def _plumpness(points: Vertices, ring: Ring, spot: int) -> float:
    """Area of an ear over its longest side squared; 0 for no ear, infinity for a flat corner."""
    area = _corner_area(points, ring, spot)
    if abs(area) <= _ZERO_AREA:
        return math.inf
    triangle = points[_triangle(ring, spot)]
    sides = np.roll(triangle, -1, axis=0) - triangle
    if area < 0.0 or _holds_another_corner(triangle, points[ring]):
        return 0.0
    return area / float(np.max(np.sum(sides * sides, axis=1)))


def _holds_another_corner(triangle: Vertices, corners: Vertices) -> bool:
    """Whether a corner that is not the triangle's own lies in a triangle or on its edge."""
    inside = ~np.any(np.all(corners[:, None] == triangle[None], axis=2), axis=1)
    for start, end in zip(triangle, np.roll(triangle, -1, axis=0), strict=True):
        inside &= _cross(end - start, corners - start) >= 0.0
    return bool(np.any(inside))


def _corner_area(points: Vertices, ring: Ring, spot: int) -> float:
    """Signed area [m2] of the triangle at a corner of the ring; positive when convex."""
    a, b, c = points[_triangle(ring, spot)]
    return 0.5 * float(_cross(b - a, c - a))


def _triangle(ring: Ring, spot: int) -> Ring:
    """A corner of the ring between its two neighbours."""
    return [ring[spot - 1], ring[spot], ring[(spot + 1) % len(ring)]]


def _merge(points: Vertices, rings: list[Ring]) -> list[Ring]:
    """Join pieces that share an edge, as long as the join is convex."""
    done = 0
    while done < len(rings):
        joined = next(
            (
                (other, merged)
                for other in range(done + 1, len(rings))
                if (merged := _join(points, rings[done], rings[other])) is not None
            ),
            None,
        )
        if joined is None:
            done += 1
            continue
        other, rings[done] = joined
        del rings[other]
        done = 0
    return rings


def _join(points: Vertices, one: Ring, other: Ring) -> Ring | None:
    """The ring round two pieces, or None when they share no edge or it would not be convex."""
    for i, start in enumerate(one):
        end = one[(i + 1) % len(one)]
        for j, candidate in enumerate(other):
            if candidate == end and other[(j + 1) % len(other)] == start:
                rest = [other[(j + 1 + k) % len(other)] for k in range(1, len(other) - 1)]
                merged = one[: i + 1] + rest + one[i + 1 :]
                corner_areas = [_corner_area(points, merged, k) for k in range(len(merged))]
                return merged if min(corner_areas) >= -_ZERO_AREA else None
    return None


def _without_straight(piece: Vertices) -> Vertices:
    """A convex piece without the corners that lie on a straight line."""
    before, after = piece - np.roll(piece, 1, axis=0), np.roll(piece, -1, axis=0) - piece
    return piece[_cross(before, after) > 2.0 * _ZERO_AREA]


def _touch(a: Vertices, b: Vertices, c: Vertices, d: Vertices) -> NDArray[np.bool_]:
    """Whether closed segments ab and cd meet, pair by pair."""
    c_side, d_side = np.sign(_cross(b - a, c - a)), np.sign(_cross(b - a, d - a))
    a_side, b_side = np.sign(_cross(d - c, a - c)), np.sign(_cross(d - c, b - c))
    boxes_meet = np.all(
        (np.maximum(a, b) >= np.minimum(c, d)) & (np.maximum(c, d) >= np.minimum(a, b)), axis=1
    )
    meet: NDArray[np.bool_] = boxes_meet & (c_side * d_side <= 0.0) & (a_side * b_side <= 0.0)
    return meet


def _cross(u: Vertices, v: Vertices) -> Vertices:
    """The z component of the cross product of plane vectors ``(..., 2)``."""
    return np.asarray(u[..., 0] * v[..., 1] - u[..., 1] * v[..., 0])
