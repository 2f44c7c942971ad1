import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from shapely import Point, Polygon

from envs.solids import Disc, Prism, bounds, distance

TRIANGLE = Prism(vertices=np.array([[0.0, 0.0], [2.0, 0.5], [0.5, 1.5]]), height=1.0)
DISC = Disc(center=np.array([1.0, -1.0]), radius=0.5, height=1.0)


@given(x=st.floats(-3, 3), y=st.floats(-3, 3))
@settings(max_examples=100, deadline=None)
def test_the_distance_to_a_prism_is_what_shapely_measures(x, y):
    wanted = Polygon(TRIANGLE.vertices).distance(Point(x, y))
    assert distance(TRIANGLE, (x, y)) == pytest.approx(wanted, abs=1e-9)


def test_the_distance_to_a_disc_is_measured_from_its_edge():
    assert distance(DISC, (1.0, 1.0)) == pytest.approx(1.5)
    assert distance(DISC, (1.2, -1.0)) == 0.0


def test_bounds_hold_the_solid_tightly():
    assert bounds(TRIANGLE) == (0.0, 2.0, 0.0, 1.5)
    assert bounds(DISC) == (0.5, 1.5, -1.5, -0.5)
