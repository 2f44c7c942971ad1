import dataclasses
import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from envs.floor_plan import MIN_HEIGHT, Box, Cylinder, FloorPlan, Polygon, Wall
from envs.solids import Disc, Prism
from mapping.burger import ROBOT_RADIUS
from mapping.errors import TestbedError

NAN, INF = math.nan, math.inf
ROOM = Wall(points=((0.0, 0.0), (4.0, 0.0), (4.0, 3.0), (0.0, 3.0)), closed=True, thickness=0.2)
LINE = ((0.0, 0.0), (1.0, 0.0))
SQUARE = ((0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0))


@pytest.mark.parametrize(
    ("make", "named"),
    [
        (lambda: Wall(points=((0.0, NAN), (1.0, 0.0))), "points: (0.0, nan)"),
        (lambda: Wall(points=((0.0, INF), (1.0, 0.0))), "points: (0.0, inf)"),
        (lambda: Wall(points=((0.0, 1e300), (1.0, 0.0))), "points"),
        (lambda: Wall(points=LINE, thickness=0.0), "thickness: 0.0 m"),
        (lambda: Wall(points=LINE, thickness=NAN), "thickness: nan m"),
        (lambda: Wall(points=LINE, height=0.15), "height: 0.15 m"),
        (lambda: Wall(points=LINE, height=INF), "height: inf m"),
        (lambda: Wall(points=()), "points: 0 that differ"),
        (lambda: Wall(points=((1.0, 1.0), (1.0, 1.0))), "points: 1 that differ"),
        (lambda: Wall(points=LINE, closed=True), "points: 2 that differ; a closed wall"),
        (lambda: Wall(points=(*LINE, (2.0, 0.0)), closed=True), "on one line"),
        (lambda: Box(center=(0.0, 0.0), size=(1.0, -1.0)), "size: -1.0 m"),
        (lambda: Box(center=(0.0, 0.0), size=(1.0, 1.0), yaw=NAN), "yaw: nan"),
        (lambda: Cylinder(center=(NAN, 0.0), radius=1.0), "center: (nan, 0.0)"),
        (lambda: Cylinder(center=(0.0, 0.0), radius=0.0), "radius: 0.0 m"),
        (lambda: Polygon(vertices=LINE), "vertices: 2 that differ"),
        (lambda: Polygon(vertices=(*LINE, (2.0, 0.0))), "enclose nothing"),
        (lambda: Polygon(vertices=(SQUARE[0], SQUARE[2], SQUARE[1], SQUARE[3])), "cross"),
        (lambda: Polygon(vertices=SQUARE, height=0.0), "height: 0.0 m"),
        (lambda: FloorPlan(name="p", start=(0.0, 0.0, 0.0)), "zero area"),
        (lambda: FloorPlan(name="p", start=(NAN, 0.0, 0.0), walls=(ROOM,)), "start: (nan, 0.0)"),
        (lambda: FloorPlan(name="p", start=(2.0, 1.0, NAN), walls=(ROOM,)), "start yaw: nan"),
    ],
)
def test_a_figure_that_makes_no_plan_is_named_on_one_line(make, named):
    with pytest.raises(TestbedError) as raised:
        make()
    assert named in str(raised.value)
    assert "\n" not in str(raised.value)


def test_a_start_inside_a_thing_names_the_thing():
    box = Box(center=(2.0, 1.0), size=(0.5, 0.5))
    with pytest.raises(TestbedError, match=r"start: \(2, 1\) is inside boxes\[0\]"):
        FloorPlan(name="p", start=(2.0, 1.0, 0.0), walls=(ROOM,), boxes=(box,))


@given(yaw=st.floats(-math.pi, math.pi), gap=st.floats(0.0, 0.3))
@settings(max_examples=50, deadline=None)
def test_a_start_is_refused_exactly_when_the_robot_does_not_fit(yaw, gap):
    if abs(gap - ROBOT_RADIUS) < 1e-9:
        return  # the sum below rounds
    reach = 0.25 + gap
    box = Box(center=(-reach * math.cos(yaw), -reach * math.sin(yaw)), size=(0.5, 0.5), yaw=yaw)
    if gap < ROBOT_RADIUS:
        with pytest.raises(TestbedError, match="start: "):
            FloorPlan(name="p", start=(0.0, 0.0, 0.0), boxes=(box,))
    else:
        FloorPlan(name="p", start=(0.0, 0.0, 0.0), boxes=(box,))


def test_of_several_obstacles_the_nearest_is_named():
    near, nearer = (Cylinder(center=(x, 1.0), radius=0.1) for x in (1.81, 2.16))
    with pytest.raises(TestbedError, match=r"0\.060 m from cylinders\[1\]"):
        FloorPlan(name="p", start=(2.0, 1.0, 0.0), walls=(ROOM,), cylinders=(near, nearer))


def test_the_lowest_thing_allowed_is_above_the_lidar_plane():
    assert MIN_HEIGHT > 0.182
    Box(center=(0.0, 0.0), size=(1.0, 1.0), height=MIN_HEIGHT)


def test_bounds_include_the_walls_outer_faces():
    plan = FloorPlan(name="p", start=(2.0, 1.0, 0.0), walls=(ROOM,))
    assert plan.bounds == pytest.approx((-0.1, 4.1, -0.1, 3.1), abs=1e-12)


def test_solids_stand_in_the_order_of_the_parts():
    plan = FloorPlan(
        name="p",
        start=(2.0, 1.5, 0.0),
        walls=(ROOM,),
        boxes=(Box(center=(1.0, 0.5), size=(0.4, 0.2), yaw=0.5 * math.pi),),
        cylinders=(Cylinder(center=(3.0, 2.0), radius=0.2),),
        polygons=(Polygon(vertices=((3.0, 0.2), (3.5, 0.2), (3.5, 0.7)), height=0.4),),
    )
    *walls, box, disc, triangle = plan.solids()
    assert [label for label, _ in plan.parts()] == [
        *("walls[0]", "boxes[0]", "cylinders[0]", "polygons[0]")
    ]
    assert len(walls) == 4
    assert isinstance(box, Prism)
    np.testing.assert_allclose(np.ptp(box.vertices, axis=0), (0.2, 0.4), atol=1e-12)
    assert isinstance(disc, Disc)
    assert isinstance(triangle, Prism)
    assert triangle.height == 0.4


def test_a_replaced_start_is_checked_again():
    plan = FloorPlan(name="p", start=(2.0, 1.0, 0.0), walls=(ROOM,))
    with pytest.raises(TestbedError, match=r"walls\[0\]"):
        dataclasses.replace(plan, start=(0.0, 0.0, 0.0))
