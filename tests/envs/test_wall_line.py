import math
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from shapely import LineString, Polygon, unary_union
from shapely.geometry import LinearRing

from envs.solids import Prism
from envs.wall_line import MITRE_LIMIT, SAME_POINT, wall_prisms

INNER_CIRCUMRADIUS, OUTER_CIRCUMRADIUS = 2.9329, 3.2996

NANOMETRE = 1e-9
"""Grid of the oracle's unions [m]; without one, GEOS at times loses a piece."""

millimetres = st.integers(-5000, 5000).map(lambda mm: mm / 1000.0)
lines = st.lists(st.tuples(millimetres, millimetres), min_size=2, max_size=9)


def hexagon(circumradius: float) -> list[tuple[float, float]]:
    angles = np.arange(6) * math.pi / 3.0
    return [(circumradius * math.cos(a), circumradius * math.sin(a)) for a in angles]


def stroke(points, *, closed, thickness):
    """The stroke as SVG defines it: a rectangle a segment and a join a corner, all united."""
    half = 0.5 * thickness
    kept = [p for i, p in enumerate(points) if i == 0 or math.dist(p, points[i - 1]) > 0.0]
    if closed and math.dist(kept[0], kept[-1]) > 0.0:
        kept.append(kept[0])
    pieces = [LineString(pair).buffer(half, cap_style="flat") for pair in pairwise(kept)]
    triples = list(zip(kept, kept[1:], kept[2:], strict=False))
    if kept[0] == kept[-1] and len(kept) > 3:
        triples.append((kept[-2], kept[0], kept[1]))
    joins = [join(*triple, half) for triple in triples]
    return unary_union(pieces + joins, grid_size=NANOMETRE)


def join(before, corner, after, half):
    a, b, c = map(np.array, (before, corner, after))
    u, v = (b - a) / math.dist(a, b), (c - b) / math.dist(b, c)
    turn = math.atan2(u[0] * v[1] - u[1] * v[0], u @ v)
    side = -math.copysign(half, turn)
    first, second = b + side * np.array([-u[1], u[0]]), b + side * np.array([-v[1], v[0]])
    outline = [b, first, second]
    if 1.0 / max(math.cos(turn / 2.0), 1e-12) <= MITRE_LIMIT:
        outline.insert(2, first + half * math.tan(abs(turn) / 2.0) * u)
    return Polygon(outline).buffer(0.0)


def united(prisms: tuple[Prism, ...]):
    return unary_union([Polygon(prism.vertices) for prism in prisms], grid_size=NANOMETRE)


def test_a_hexagonal_ring_is_six_exact_trapezoids():
    middle = 0.5 * (INNER_CIRCUMRADIUS + OUTER_CIRCUMRADIUS)
    thickness = (OUTER_CIRCUMRADIUS - INNER_CIRCUMRADIUS) * math.cos(math.pi / 6.0)
    prisms = wall_prisms(hexagon(middle), closed=True, thickness=thickness, height=0.97)

    found = np.concatenate([prism.vertices for prism in prisms])
    wanted = np.array(hexagon(INNER_CIRCUMRADIUS) + hexagon(OUTER_CIRCUMRADIUS))
    gaps = np.linalg.norm(found[:, None] - wanted[None], axis=2)

    assert [len(prism.vertices) for prism in prisms] == [4] * 6
    assert gaps.min(axis=1).max() < 1e-9
    assert gaps.min(axis=0).max() < 1e-9


@given(points=lines, closed=st.booleans(), thickness=st.sampled_from([0.02, 0.1, 0.4]))
@settings(max_examples=150, deadline=None)
def test_the_prisms_of_any_line_unite_to_its_stroke(points, closed, thickness):
    prisms = wall_prisms(points, closed=closed, thickness=thickness, height=1.0)
    if len(set(points)) < 2:
        assert prisms == ()
        return
    wanted = stroke(points, closed=closed and len(set(points)) > 2, thickness=thickness)

    # What may differ: slivers of 0.01 mm left out, and a mitre at the very limit drawn or not.
    assert united(prisms).symmetric_difference(wanted).buffer(-2e-5).area < 1e-9


@given(points=lines, closed=st.booleans(), thickness=st.sampled_from([0.02, 0.1, 0.4]))
@settings(max_examples=150, deadline=None)
def test_every_prism_is_strictly_convex_and_counter_clockwise(points, closed, thickness):
    for prism in wall_prisms(points, closed=closed, thickness=thickness, height=1.0):
        corners = prism.vertices
        before, after = corners - np.roll(corners, 1, 0), np.roll(corners, -1, 0) - corners
        assert np.all(before[:, 0] * after[:, 1] - before[:, 1] * after[:, 0] > 0.0)


def test_a_square_room_has_its_full_outer_corners():
    ring = [(0.0, 0.0), (4.0, 0.0), (4.0, 3.0), (0.0, 3.0)]
    walls = united(wall_prisms(ring, closed=True, thickness=0.2, height=1.0))
    room = LinearRing(ring)
    assert walls.bounds == pytest.approx((-0.1, -0.1, 4.1, 3.1), abs=1e-12)
    assert walls.area == pytest.approx(room.length * 0.2, abs=1e-9)


def test_repeated_and_collinear_points_change_nothing():
    plain = wall_prisms([(0, 0), (2, 0), (2, 2)], closed=False, thickness=0.1, height=1.0)
    noisy = wall_prisms(
        [(0, 0), (0, 0), (1, 0), (2, 0), (2, 0.1 * SAME_POINT), (2, 2), (2, 2)],
        closed=False,
        thickness=0.1,
        height=1.0,
    )
    assert len(noisy) == len(plain) == 2
    assert united(noisy).symmetric_difference(united(plain)).area < 1e-9


def test_a_line_that_ends_where_it_began_is_joined_there():
    points = [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0), (0.0, 0.0)]
    walls = united(wall_prisms(points, closed=False, thickness=0.1, height=1.0))
    assert walls.bounds == pytest.approx((-0.05, -0.05, 1.05, 1.05), abs=1e-12)


def test_a_very_sharp_corner_does_not_reach_out_far():
    spike = [(0.0, 0.0), (3.0, 0.05), (0.0, 0.1)]
    walls = united(wall_prisms(spike, closed=False, thickness=0.1, height=1.0))
    assert walls.bounds[2] < 3.0 + MITRE_LIMIT * 0.05


def test_a_ring_with_centimetre_edges_and_a_thick_wall_is_still_a_stroke():
    ring = [(0, 0), (1, 0), (1, 0.01), (1.01, 0.01), (1.01, 1), (0, 1)]
    prisms = wall_prisms(ring, closed=True, thickness=0.2, height=1.0)
    wanted = stroke(ring, closed=True, thickness=0.2)
    assert united(prisms).symmetric_difference(wanted).area < 1e-6
