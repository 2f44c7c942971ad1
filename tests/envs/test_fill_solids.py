import math

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from envs.fill_solids import fill_discs, fill_prisms

SHAPE, LEFT, BOTTOM, RESOLUTION, SLACK = (23, 31), -1.3, -0.7, 0.1, 1e-9


def centres():
    for row in range(SHAPE[0]):
        for column in range(SHAPE[1]):
            yield row, column, LEFT + (column + 0.5) * RESOLUTION, BOTTOM + (row + 0.5) * RESOLUTION


def slow_prisms(polygons):
    raster = np.zeros(SHAPE, dtype=bool)
    for row, column, x, y in centres():
        for polygon in polygons:
            sides = [
                (x1 - x0) * (y - y0) - (y1 - y0) * (x - x0)
                for (x0, y0), (x1, y1) in zip(polygon, np.roll(polygon, -1, axis=0), strict=True)
            ]
            raster[row, column] |= min(sides) >= 0.0
    return raster


def slow_discs(discs):
    raster = np.zeros(SHAPE, dtype=bool)
    for row, column, x, y in centres():
        raster[row, column] = any(math.dist((x, y), (cx, cy)) <= r for cx, cy, r in discs)
    return raster


@st.composite
def regular_polygons(draw):
    count, radius = draw(st.integers(3, 7)), draw(st.floats(0.05, 2.0))
    x, y, turn = draw(st.floats(-2, 2)), draw(st.floats(-2, 2)), draw(st.floats(0.01, 1.0))
    angles = turn + np.arange(count) * 2.0 * math.pi / count
    return np.column_stack((x + radius * np.cos(angles), y + radius * np.sin(angles)))


@given(polygons=st.lists(regular_polygons(), min_size=1, max_size=3))
@settings(max_examples=30, deadline=None)
def test_filled_prisms_equal_the_plain_reference(polygons):
    raster = np.zeros(SHAPE, dtype=bool)
    firsts = np.cumsum([0, *map(len, polygons)])
    fill_prisms(raster, LEFT, BOTTOM, RESOLUTION, np.concatenate(polygons), firsts, SLACK)
    np.testing.assert_array_equal(raster, slow_prisms(polygons))


@given(
    discs=st.lists(
        st.tuples(st.floats(-2, 2), st.floats(-2, 2), st.floats(0.01, 1.5)), min_size=1, max_size=3
    )
)
@settings(max_examples=30, deadline=None)
def test_filled_discs_equal_the_plain_reference(discs):
    raster = np.zeros(SHAPE, dtype=bool)
    fill_discs(raster, LEFT, BOTTOM, RESOLUTION, np.array(discs), SLACK)
    np.testing.assert_array_equal(raster, slow_discs(discs))
