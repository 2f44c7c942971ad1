import math

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from envs.floor_plan import Box, Cylinder, FloorPlan, Polygon, Route, Wall
from envs.plan_yaml import load_yaml, plan_from_fields, plan_to_yaml, read_plan, write_plan
from mapping.errors import TestbedError

HEAD = "name: p\nstart: [0, 0, 0]\n"
BOX = "boxes: [{center: [3, 3], size: [1, 1]}]\n"

# Parts lie from 1 m east of the start on, so that every plan made of them has a free start.
east = st.floats(1.5, 1000.0)
north = st.floats(-1000.0, 1000.0)
points = st.tuples(east, north)
heights = st.floats(0.25, 10.0)
sizes = st.floats(0.001, 0.5)
walls = st.builds(
    lambda corner, length, closed, thickness, height: Wall(
        points=(corner, (corner[0] + length, corner[1]), (corner[0], corner[1] + 1.0)),
        closed=closed,
        thickness=thickness,
        height=height,
    ),
    *(points, st.floats(0.5, 9.0), st.booleans(), st.floats(0.001, 0.1), heights),
)
boxes = st.builds(
    Box,
    center=points,
    size=st.tuples(sizes, sizes),
    yaw=st.floats(-math.pi, math.pi),
    height=heights,
)
cylinders = st.builds(Cylinder, center=points, radius=sizes, height=heights)
polygons = st.builds(
    lambda corner, side, height: Polygon(
        vertices=(corner, (corner[0] + side, corner[1]), (corner[0], corner[1] + side)),
        height=height,
    ),
    *(points, st.floats(0.1, 5.0), heights),
)
names = st.text(st.characters(categories=("L", "N", "P", "S")), min_size=1, max_size=20)
routes = st.builds(Route, name=names, points=st.lists(points, min_size=1, max_size=3).map(tuple))
plans = st.builds(
    lambda box, **fields: FloorPlan(boxes=tuple(box), **fields),
    box=st.lists(boxes, min_size=1, max_size=3),
    name=names,
    description=names | st.just(""),
    start=st.tuples(st.just(0.0), st.just(0.0), st.floats(-math.pi, math.pi)),
    walls=st.lists(walls, max_size=3).map(tuple),
    cylinders=st.lists(cylinders, max_size=3).map(tuple),
    polygons=st.lists(polygons, max_size=3).map(tuple),
    routes=st.lists(routes, max_size=2, unique_by=lambda route: route.name).map(tuple),
)


@given(plan=plans)
@settings(max_examples=40, deadline=None)
def test_a_plan_that_was_written_reads_back_equal_to_the_last_bit(plan, tmp_path_factory):
    path = tmp_path_factory.mktemp("plan") / "plan.yaml"
    write_plan(plan, path)
    assert read_plan(path) == plan


def test_the_example_in_the_docstring_reads(tmp_path):
    import envs.plan_yaml

    text = envs.plan_yaml.__doc__.split("::\n", 1)[1].split("``name``")[0]
    path = tmp_path / "example.yaml"
    path.write_text("\n".join(line.removeprefix("    ") for line in text.splitlines()))
    plan = read_plan(path)
    assert plan.boxes[0].yaw == pytest.approx(math.radians(30.0))
    assert [len(parts) for parts in plan.kinds().values()] == [1, 1, 1, 1]
    assert len(plan.pedestrians) == 1


@pytest.mark.parametrize(
    ("text", "named"),
    [
        ("name: p\nstart: [0, 0}\n", "line 2: not YAML"),
        ("- 1\n- 2\n", "no mapping"),
        ("", "no mapping"),
        ("name: p\nname: q\n", "line 2: not YAML ('name' stands twice)"),
        ("name: 2020-13-45\n", "not YAML"),
        ("name: p\n" + BOX, "start: missing"),
        (HEAD, "zero area"),
        (HEAD + "wals: []\n", "wals: unknown key; must be one of name, start, description, walls"),
        (HEAD + "boxes: {center: [3, 3]}\n", "boxes: {'center': [3, 3]}; must be a list"),
        (HEAD + "boxes: [7]\n", "boxes[0]: 7; must be keys and values: center, size, yaw, height"),
        (HEAD + "boxes: [{center: [3, 3]}]\n", "boxes[0]: size: missing"),
        (HEAD + "boxes: [{center: [3], size: [1, 1]}]\n", "boxes[0]: center: [3]; must be two"),
        (HEAD + "boxes: [{center: [3, x], size: [1, 1]}]\n", "boxes[0]: center: [3, 'x']"),
        (HEAD + "boxes: [{center: [3, true], size: [1, 1]}]\n", "boxes[0]: center: [3, True]"),
        (
            HEAD + "boxes: [{center: [3, 3], size: [1, 1], yaw: 1, yaw_deg: 2}]\n",
            "boxes[0]: yaw: stands beside yaw_deg",
        ),
        (HEAD + "boxes: [{center: [3, .nan], size: [1, 1]}]\n", "boxes[0]: center: (3.0, nan)"),
        (HEAD + "walls: [{points: [[3, 3], 4]}]\n", "walls[0]: points[1]: 4; must be two numbers"),
        (HEAD + "walls: [{points: [[3, 3], [4, 4]], closed: 1}]\n", "walls[0]: closed: 1; must be"),
        (HEAD + "cylinders: [{center: [3, 3], radius: -1}]\n", "cylinders[0]: radius: -1.0 m"),
        (HEAD + "cylinders: [{center: [3, 3], radius: 1" + "0" * 400 + "}]\n", "radius: 1000"),
        ("name: 5\nstart: [0, 0, 0]\n" + BOX, "name: 5; must be one line of text"),
        ("name: p\nstart: [0, 0]\n" + BOX, "start: [0, 0]; must be [x, y, yaw]"),
        ("name: p\nstart: {x: 0}\n" + BOX, "start: y: missing"),
        ("name: p\nstart: [3, 3, 0]\n" + BOX, "start: (3, 3) is inside boxes[0]"),
        ("name: p\nstart: [0, .inf, 0]\n" + BOX, "start: (0.0, inf)"),
    ],
)
def test_a_fault_is_told_on_one_line_with_file_and_place(text, named, tmp_path):
    path = tmp_path / "bad.yaml"
    path.write_text(text)
    with pytest.raises(TestbedError) as raised:
        read_plan(path)
    message = str(raised.value)
    assert message.startswith(f"{path}: ")
    assert named in message
    assert "\n" not in message


def test_a_start_may_give_its_heading_in_degrees():
    plan = plan_from_fields(
        {
            "name": "p",
            "start": {"x": 0, "y": 1, "yaw_deg": 90},
            "boxes": [{"center": [3, 3], "size": [1, 1]}],
        }
    )
    assert plan.start == (0.0, 1.0, math.radians(90.0))


def test_numbers_in_scientific_notation_are_numbers(tmp_path):
    path = tmp_path / "plan.yaml"
    path.write_text(HEAD + "boxes: [{center: [3e0, -3E+0], size: [5e-1, 1.e0]}]\n")
    box = read_plan(path).boxes[0]
    assert (box.center, box.size) == ((3.0, -3.0), (0.5, 1.0))


def test_a_missing_file_and_a_folder_are_told_as_such(tmp_path):
    with pytest.raises(TestbedError, match="no such file"):
        read_plan(tmp_path / "none.yaml")
    with pytest.raises(TestbedError, match="cannot be read"):
        load_yaml(tmp_path)


def test_a_plan_is_written_one_part_a_line():
    plan = FloorPlan(
        name="p",
        start=(0.0, 0.0, 0.0),
        boxes=(Box(center=(3.0, 3.0), size=(1.0, 0.5)), Box(center=(5.0, 3.0), size=(1.0, 0.5))),
    )
    assert plan_to_yaml(plan).splitlines()[2:] == [
        "boxes:",
        "  - {center: [3.0, 3.0], size: [1.0, 0.5], yaw: 0.0, height: 0.5}",
        "  - {center: [5.0, 3.0], size: [1.0, 0.5], yaw: 0.0, height: 0.5}",
    ]


def test_a_file_that_cannot_be_written_leaves_nothing_behind(tmp_path):
    plan = FloorPlan(
        name="p", start=(0.0, 0.0, 0.0), boxes=(Box(center=(3.0, 3.0), size=(1.0, 0.5)),)
    )
    with pytest.raises(TestbedError, match="cannot be written"):
        write_plan(plan, tmp_path / "no_such_folder" / "plan.yaml")
    assert list(tmp_path.iterdir()) == []


def test_routes_are_read_and_written_by_name(tmp_path):
    path = tmp_path / "plan.yaml"
    path.write_text(
        HEAD + "boxes: [{center: [3, 3], size: [1, 1]}]\nroutes: {a: [[1, 2], [3, 4.5]]}\n"
    )
    plan = read_plan(path)
    assert plan.routes == (Route(name="a", points=((1.0, 2.0), (3.0, 4.5))),)
    write_plan(plan, path)
    assert read_plan(path) == plan


@pytest.mark.parametrize(
    ("routes", "told"),
    [
        ("[[1, 2]]", "routes: .*; must be names with lists"),
        ("{a: [1, 2]}", r"routes: a: points\[0\]: 1; must be two numbers"),
        ("{a: []}", "routes: a: points: none"),
        ("{a: [[.nan, 0]]}", "routes: a: points: .*must be finite"),
    ],
)
def test_a_route_that_is_none_is_refused_by_its_name(tmp_path, routes, told):
    path = tmp_path / "plan.yaml"
    path.write_text(HEAD + f"boxes: [{{center: [3, 3], size: [1, 1]}}]\nroutes: {routes}\n")
    with pytest.raises(TestbedError, match=told):
        read_plan(path)
