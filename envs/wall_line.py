"""Turn a wall's centre line into convex prisms: one a segment, joined at mitres.

The outline is that of a stroked line with mitred joints and flat ends, as SVG 2 (13.5.4) draws it:
where a mitre would reach out farther than ``MITRE_LIMIT`` half thicknesses, a bevel stands instead.
"""

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from envs.solids import Prism

MITRE_LIMIT = 4.0
"""Longest mitre, in half thicknesses from the corner: the initial value of SVG's stroke-miterlimit.
Corners sharper than 29 degrees get a bevel."""

SAME_POINT = 1e-4
"""Points of a line nearer than this are one [m]; a tenth of what the lidar resolves (1 mm)."""

_SLIVER = 1e-5
"""A piece thinner than this is left out [m], as are corners this near one another."""

_STRAIGHT = 1e-9
"""A turn [rad] smaller than this is no corner: over a 100 m segment it moves a point by 0.1 um."""

Vector = NDArray[np.float64]


def wall_prisms(
    points: Sequence[tuple[float, float]], *, closed: bool, thickness: float, height: float
) -> tuple[Prism, ...]:
    """The prisms of a wall whose thickness is centred on a line.

    Neighbouring segments meet along the mitre without gap or overlap. Where a segment is too short
    for that (its inner edge would turn over) or the corner too sharp, the segments keep their
    square ends, which overlap, and a wedge fills the outside of the corner. Either way the union
    is the stroke.

    Args:
        points: Corners of the line [m]. Repeated points, points on a straight line, crossings and
            turning back are all allowed.
        closed: Whether the last point joins the first; a line that ends where it began is joined
            there in any case.
        thickness: Thickness [m].
        height: Height above the floor [m].

    Returns:
        The prisms; none when the line has no length.
    """
    line, closed = corners(points, closed=closed)
    count = len(line) if closed else len(line) - 1
    if count < 1:
        return ()
    segments = np.roll(line, -1, axis=0)[:count] - line[:count]
    lengths = np.hypot(*segments.T)
    directions = segments / lengths[:, None]
    half = 0.5 * thickness
    starts, ends = np.zeros(count), np.zeros(count)  # lean of each segment's two ends [m]
    wedges: list[Vector] = []
    for first in range(count if closed else count - 1):
        second = (first + 1) % count
        lean = _mitre_lean(directions[first], directions[second])
        if half * abs(lean) <= 0.5 * min(lengths[first], lengths[second]) and _in_limit(lean):
            ends[first], starts[second] = -half * lean, half * lean
        else:
            corner = line[second]
            wedges.append(_wedge(corner, directions[first], directions[second], half, lean))
    quads = [
        _quad(line[i], lengths[i], directions[i], half, starts[i], ends[i]) for i in range(count)
    ]
    return tuple(
        Prism(vertices=piece, height=height) for piece in quads + wedges if _width(piece) >= _SLIVER
    )


def corners(points: Sequence[tuple[float, float]], *, closed: bool) -> tuple[Vector, bool]:
    """The corners ``(n, 2)`` of a line without repeats and straight-on points; whether it closes.

    A closed line that is left with two corners or fewer is an open one there and back.
    """
    kept: list[tuple[float, float]] = []
    for point in points:
        if not kept or math.dist(kept[-1], point) >= SAME_POINT:
            kept.append(point)
    if len(kept) > 2 and math.dist(kept[0], kept[-1]) < SAME_POINT:
        kept.pop()
        closed = True
    if closed and len(kept) < 3:
        closed = False
    line = np.array(kept, dtype=np.float64).reshape(-1, 2)
    before, after = line - np.roll(line, 1, axis=0), np.roll(line, -1, axis=0) - line
    cross = before[:, 0] * after[:, 1] - before[:, 1] * after[:, 0]
    turns = np.abs(np.arctan2(cross, np.sum(before * after, axis=1))) > _STRAIGHT
    if not closed:
        turns[[0, -1]] = True
    return line[turns], closed


def _mitre_lean(first: Vector, second: Vector) -> float:
    """tan(turn / 2): how far the mitre leans, per half thickness; positive for a left turn."""
    cross = float(first[0] * second[1] - first[1] * second[0])
    return math.tan(0.5 * math.atan2(cross, float(first @ second)))


def _in_limit(lean: float) -> bool:
    """Whether a mitre that leans so much stays within the limit: 1 / cos(turn / 2)."""
    return math.hypot(1.0, lean) <= MITRE_LIMIT


def _quad(
    start: Vector, length: float, direction: Vector, half: float, lean_start: float, lean_end: float
) -> Vector:
    """One segment, counter-clockwise; the leans [m] move the left corners on, the right ones back.

    Corners that fall together come out as one.
    """
    left = np.array([-direction[1], direction[0]]) * half
    end = start + length * direction
    quad = np.array(
        [
            start - lean_start * direction - left,
            end - lean_end * direction - left,
            end + lean_end * direction + left,
            start + lean_start * direction + left,
        ]
    )
    apart: NDArray[np.bool_] = np.hypot(*(quad - np.roll(quad, 1, axis=0)).T) > _SLIVER
    return np.asarray(quad[apart])


def _wedge(corner: Vector, first: Vector, second: Vector, half: float, lean: float) -> Vector:
    """What two square ends leave open on the outside of a corner, counter-clockwise."""
    side = -math.copysign(half, lean)  # the outside lies to the right of a left turn
    before = corner + side * np.array([-first[1], first[0]])
    after = corner + side * np.array([-second[1], second[0]])
    outline = [corner, before, after]
    if _in_limit(lean):
        outline.insert(2, before + half * abs(lean) * first)
    return np.array(outline if lean > 0.0 else outline[::-1])


def _width(piece: Vector) -> float:
    """How wide a counter-clockwise convex piece is across its longest edge, on average [m]."""
    if len(piece) < 3:
        return 0.0
    following = np.roll(piece, -1, axis=0)
    area = 0.5 * np.sum(piece[:, 0] * following[:, 1] - piece[:, 1] * following[:, 0])
    return float(area / np.max(np.hypot(*(following - piece).T)))
