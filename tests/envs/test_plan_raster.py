import math
import time

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

from envs.floor_plan import Box, Cylinder, FloorPlan, Polygon, Wall
from envs.plan_raster import lattice_for, rasterize
from envs.worlds import load_world
from mapping.errors import TestbedError

PLAN = FloorPlan(
    name="mixed",
    start=(1.0, 1.0, 0.0),
    walls=(Wall(points=((0.0, 0.0), (4.0, 0.3), (3.8, 3.1), (0.1, 2.9)), closed=True),),
    boxes=(Box(center=(2.6, 1.1), size=(0.9, 0.35), yaw=0.4),),
    cylinders=(Cylinder(center=(1.2, 2.2), radius=0.27),),
    polygons=(Polygon(vertices=((3.0, 1.9), (3.5, 1.8), (3.2, 2.1), (3.4, 2.6), (2.9, 2.5))),),
)


def outlines(plan):
    """The plan's parts by shapely's own buffers, not by our prisms."""
    for wall in plan.walls:
        ring = shapely.LinearRing(wall.points)
        yield ring.buffer(0.5 * wall.thickness, join_style="mitre", mitre_limit=4.0)
    for box in plan.boxes:
        upright = shapely.box(
            *(np.array(box.center) - 0.5 * np.array(box.size)),
            *(np.array(box.center) + 0.5 * np.array(box.size)),
        )
        yield shapely.affinity.rotate(upright, box.yaw, use_radians=True)
    for cylinder in plan.cylinders:
        yield shapely.Point(cylinder.center).buffer(cylinder.radius, quad_segs=1000)
    for polygon in plan.polygons:
        yield shapely.Polygon(polygon.vertices)


@pytest.mark.parametrize("resolution", [0.05, 0.013])
def test_a_cell_is_solid_when_shapely_finds_its_centre_in_the_plan(resolution):
    origin, shape = lattice_for(PLAN, resolution, margin=0.2)
    raster = rasterize(PLAN, resolution=resolution, origin=origin, shape=shape)
    rows, columns = np.indices(shape)
    points = shapely.points(
        origin[0] + (columns + 0.5) * resolution, origin[1] + (rows + 0.5) * resolution
    )
    solid = shapely.union_all(list(outlines(PLAN)))
    differ = raster != shapely.contains(solid, points)
    # 4000 chords stand for the circle: they differ from it by r (1 - cos(pi / 4000)) = 0.1 um.
    assert np.all(shapely.distance(solid.boundary, points[differ]) < 1e-6)


def test_no_cell_falls_through_the_mitres_of_a_wall():
    square = ((0.0, 0.0), (2.0, 0.0), (2.0, 2.0), (0.0, 2.0))
    plan = FloorPlan(
        name="p", start=(1.0, 1.0, 0.0), walls=(Wall(points=square, closed=True, thickness=0.3),)
    )
    # Cell centres lie exactly on the diagonals where the segments meet.
    raster = rasterize(plan, resolution=0.01, origin=(-0.15, -0.15), shape=(230, 230))
    wanted = np.ones((230, 230), dtype=bool)
    wanted[30:200, 30:200] = False
    np.testing.assert_array_equal(raster, wanted)


@given(resolution=st.floats(0.01, 0.5), margin=st.floats(0.0, 1.0), x=st.integers(-3000, 3000))
@settings(max_examples=30, deadline=None)
def test_the_lattice_holds_the_plan_and_lies_on_whole_cells(resolution, margin, x):
    box = Box(center=(x / 100.0, -2.0), size=(1.0, 2.0))
    plan = FloorPlan(name="p", start=(x / 100.0, 5.0, 0.0), boxes=(box,))
    (left, bottom), (rows, columns) = lattice_for(plan, resolution, margin)
    assert left / resolution == pytest.approx(round(left / resolution), abs=1e-6)
    assert bottom / resolution == pytest.approx(round(bottom / resolution), abs=1e-6)
    slack = 1e-6 * resolution + 1e-9  # what is taken for rounding
    assert left <= plan.bounds[0] - margin + slack
    assert left + columns * resolution >= plan.bounds[1] + margin - slack
    assert bottom <= plan.bounds[2] - margin + slack
    assert bottom + rows * resolution >= plan.bounds[3] + margin - slack


def test_the_hallway_is_drawn_at_one_centimetre_in_a_tenth_of_a_second():
    plan = load_world("lim_hallway")
    origin, shape = lattice_for(plan, 0.01)
    rasterize(plan, resolution=0.5, origin=origin, shape=(2, 2))  # compiles the kernels
    begun = time.perf_counter()
    rasterize(plan, resolution=0.01, origin=origin, shape=shape)
    assert time.perf_counter() - begun < 0.1  # measured 5 ms


@pytest.mark.parametrize("resolution", [0.0, -0.1, math.nan, math.inf])
def test_a_resolution_of_no_size_is_refused(resolution):
    with pytest.raises(TestbedError, match="resolution"):
        lattice_for(PLAN, resolution)
    with pytest.raises(TestbedError, match="resolution"):
        rasterize(PLAN, resolution=resolution, origin=(0.0, 0.0), shape=(2, 2))


@pytest.mark.parametrize("shape", [(0, 5), (100_000, 100_000)])
def test_a_raster_of_no_cells_or_too_many_is_refused(shape):
    with pytest.raises(TestbedError, match="raster"):
        rasterize(PLAN, resolution=0.01, origin=(0.0, 0.0), shape=shape)
