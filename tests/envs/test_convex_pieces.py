import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from shapely import Polygon, unary_union

from envs.convex_pieces import convex_pieces, is_simple

L_SHAPE = ((0.0, 0.0), (2.0, 0.0), (2.0, 1.0), (1.0, 1.0), (1.0, 2.0), (0.0, 2.0))
BOW_TIE = ((0.0, 0.0), (1.0, 1.0), (1.0, 0.0), (0.0, 1.0))

stars = st.lists(st.floats(0.3, 2.0), min_size=3, max_size=14).map(
    lambda radii: tuple(
        (r * math.cos(2 * math.pi * i / len(radii)), r * math.sin(2 * math.pi * i / len(radii)))
        for i, r in enumerate(radii)
    )
)


def assert_tiles(pieces, vertices):
    polygons = [Polygon(piece) for piece in pieces]
    whole = Polygon(vertices)
    assert sum(p.area for p in polygons) == pytest.approx(whole.area, abs=1e-9)
    assert unary_union(polygons).symmetric_difference(whole).area < 1e-9


def assert_strictly_convex(piece):
    before, after = piece - np.roll(piece, 1, 0), np.roll(piece, -1, 0) - piece
    assert np.all(before[:, 0] * after[:, 1] - before[:, 1] * after[:, 0] > 0.0)


@given(vertices=stars, clockwise=st.booleans())
@settings(max_examples=80, deadline=None)
def test_the_pieces_tile_the_polygon_and_are_convex(vertices, clockwise):
    vertices = vertices[::-1] if clockwise else vertices
    pieces = convex_pieces(vertices)
    assert_tiles(pieces, vertices)
    for piece in pieces:
        assert_strictly_convex(piece)


@given(points=st.lists(st.tuples(st.integers(0, 6), st.integers(0, 6)), min_size=3, max_size=7))
@settings(max_examples=200, deadline=None)
def test_simple_means_what_shapely_calls_valid(points):
    ring = [p for i, p in enumerate(points) if p != points[i - 1]]
    if len(ring) < 3:
        return
    assert is_simple([(float(x), float(y)) for x, y in ring]) == Polygon(ring).is_valid


def test_a_convex_polygon_stays_one_piece():
    hexagon = [(math.cos(i * math.pi / 3), math.sin(i * math.pi / 3)) for i in range(6)]
    (piece,) = convex_pieces(hexagon)
    assert len(piece) == 6


def test_an_l_is_two_pieces():
    assert len(convex_pieces(L_SHAPE)) == 2


def test_a_comb_with_collinear_and_repeated_points_is_tiled():
    comb = (
        *((0.0, 0.0), (1.0, 0.0), (1.0, 0.0), (3.0, 0.0), (5.0, 0.0), (5.0, 2.0), (4.0, 2.0)),
        *((4.0, 1.0), (3.0, 1.0), (3.0, 2.0), (2.0, 2.0), (2.0, 1.0), (1.0, 1.0), (1.0, 2.0)),
        *((0.0, 2.0), (0.0, 0.0)),
    )
    pieces = convex_pieces(comb)
    assert_tiles(pieces, comb)
    assert len(pieces) <= 6


def test_a_bow_tie_is_not_simple():
    assert not is_simple(BOW_TIE)
