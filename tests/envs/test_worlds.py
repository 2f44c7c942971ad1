import json
import math

import numpy as np
import pytest
import shapely
from scipy import ndimage

from envs.floor_space import floor_space
from envs.solids import distance
from envs.worlds import WORLDS, built_in_worlds, load_world
from mapping.burger import ROBOT_RADIUS
from mapping.errors import TestbedError
from mapping.grid import FREE
from mapping.io.map_server import MapFile, write_map

FLOOR_AREAS = {
    "apartment": 133.1,
    "cluttered_office": 67.75,
    "corridor_loop": 64.3,
    "cul_de_sac": 91.8,
    "empty_room": 36.0,
    "lim_hallway": 150.4,
    "lim_room": 24.9,
    "long_corridor": 72.0,
    "narrow_door": 29.7,
    "pedestrian_hall": 62.1,
    "turtlebot3_house": 112.7,
    "turtlebot3_world": 20.57,
}
"""Free floor of every built-in world [m2]. Of turtlebot3_world the facts say 20.572; the others are
as they were drawn and are here to tell when one changes."""

CLEARLY_PASSABLE = 0.45
"""A gap wider than this is easy for the robot [m]: more than twice its 0.21 m."""

SURELY_CLOSED = 0.20
"""A gap narrower than this stops the robot [m]."""


def test_there_are_twelve_worlds_each_with_a_line_about_it():
    worlds = built_in_worlds()
    assert set(worlds) == set(FLOOR_AREAS)
    assert all(worlds.values())
    assert all(load_world(name).name == name for name in worlds)


@pytest.mark.parametrize(("name", "area"), FLOOR_AREAS.items())
def test_a_world_encloses_the_floor_it_is_said_to_have(name, area):
    space = floor_space(load_world(name), resolution=0.02)
    assert space.enclosed
    # Half a 2 cm cell along the border; the walls of the longest are 250 m.
    assert space.area == pytest.approx(area, rel=0.01)


def test_turtlebot3_world_has_the_floor_that_robotis_gave_it():
    space = floor_space(load_world("turtlebot3_world"), resolution=0.005)
    assert space.area == pytest.approx(20.57, rel=0.005)


@pytest.mark.parametrize("name", FLOOR_AREAS)
def test_the_robot_reaches_every_room(name):
    for width in (2.0 * ROBOT_RADIUS, CLEARLY_PASSABLE):
        if name == "narrow_door" and width > 0.3:
            continue
        _, pieces, _ = places_for(name, width)
        assert pieces == 1


@pytest.mark.parametrize("name", sorted(set(FLOOR_AREAS) - {"narrow_door"}))
def test_no_gap_is_neither_open_nor_closed(name):
    """A gap between the two widths would join what stands on its sides, and lose a way round."""
    assert places_for(name, SURELY_CLOSED)[2] == places_for(name, CLEARLY_PASSABLE)[2]


def places_for(name, width):
    """Where a disc's centre can be, in how many pieces, and round how many islands.

    Pieces below 20 cells (20 cm2) are the corners of cells and count for nothing.
    """
    space = floor_space(load_world(name), resolution=0.01)
    clearance = ndimage.distance_transform_edt(space.free) * 0.01
    places = clearance > 0.5 * width
    labels, count = ndimage.label(places)
    pieces = int(np.sum(np.bincount(labels.ravel(), minlength=count + 1)[1:] >= 20))
    _, islands = ndimage.label(np.pad(~places, 1, constant_values=True), np.ones((3, 3)))
    return places, pieces, islands - 1


def test_the_door_of_narrow_door_is_thirty_centimetres_wide():
    plan = load_world("narrow_door")
    posts = shapely.union_all([shapely.Polygon(solid.vertices) for solid in plan.solids()[4:6]])
    south, north = posts.geoms
    assert south.distance(north) == pytest.approx(0.30, abs=1e-9)


def test_the_loop_is_forty_two_metres_round():
    plan = load_world("corridor_loop")
    (ring,), (block,) = plan.walls, plan.polygons
    outer = shapely.box(*shapely.LineString(corners_of(ring.points)).bounds)
    inner = shapely.LineString(corners_of(block.vertices))
    width = 0.5 * (outer.length - 4.0 * ring.thickness - 4.0 * 9.0) / 4.0
    assert inner.bounds == pytest.approx((-4.5, -4.5, 4.5, 4.5))
    assert width == pytest.approx(1.5)
    assert 4.0 * (9.0 + width) == pytest.approx(42.0)


def corners_of(points):
    """The points at the four corners of a square outline: those as far out along x as along y."""
    return [(x, y) for x, y in points if abs(x) == pytest.approx(abs(y))]


def test_the_trash_can_of_lim_room_stands_off_the_corner_but_lets_nobody_behind():
    can = load_world("lim_room").cylinders[0]
    gaps = [coordinate - can.radius for coordinate in can.center]
    assert all(0.05 < gap < 2.0 * ROBOT_RADIUS for gap in gaps)


def test_lines_of_the_worlds_are_kept_readable():
    for path in WORLDS.glob("*.yaml"):
        lines = path.read_text().splitlines()
        assert max(len(line) for line in lines if "#" in line) <= 100


def test_each_kind_of_file_is_read_as_what_it_is(tmp_path):
    box = "boxes: [{center: [3, 3], size: [1, 1]}]\n"
    (tmp_path / "plan.yml").write_text("name: by_hand\nstart: [0, 0, 0]\n" + box)
    (tmp_path / "maze.txt").write_text("###\n#S#\n###\n")
    ring = [[0, 0], [4, 0], [4, 3], [0, 3]]
    (tmp_path / "house.json").write_text(json.dumps({"id": "expo", "verts": ring}))
    states = np.full((30, 30), FREE, dtype=np.int8)
    write_map(tmp_path / "slam.yaml", MapFile(resolution=0.05, origin=(0.0, 0.0), states=states))
    assert load_world(str(tmp_path / "plan.yml")).name == "by_hand"
    assert load_world(tmp_path / "maze.txt").name == "maze"
    assert load_world(tmp_path / "house.json").name == "expo"
    assert load_world(tmp_path / "slam.yaml").name == "slam"


@pytest.mark.parametrize(
    ("name", "named"),
    [
        ("lim_rom", "did you mean lim_room?"),
        ("Apartment", "did you mean apartment?"),
        ("xyz", "built in are apartment, cluttered_office"),
        ("no/such/file.yaml", "no such world or file"),
        ("", "built in are"),
    ],
)
def test_an_unknown_world_is_told_what_is_allowed(name, named):
    with pytest.raises(TestbedError) as raised:
        load_world(name)
    assert named in str(raised.value)
    assert "\n" not in str(raised.value)


def test_a_file_of_another_kind_is_refused(tmp_path):
    path = tmp_path / "plan.svg"
    path.write_text("<svg/>")
    with pytest.raises(TestbedError, match=r"unknown kind of file '\.svg'; must be"):
        load_world(path)


def test_headings_of_the_worlds_lie_within_half_a_turn():
    assert all(abs(load_world(name).start[2]) <= math.pi for name in built_in_worlds())


@pytest.mark.parametrize("name", FLOOR_AREAS)
def test_the_robot_fits_at_every_place_of_a_route(name):
    plan = load_world(name)
    for route in plan.routes:
        for point in route.points:
            gap = min(distance(solid, point) for solid in plan.solids())
            assert gap > 1.5 * ROBOT_RADIUS, (route.name, point)


def test_the_worlds_of_the_long_runs_have_their_routes_and_they_end_at_the_start():
    for name, wanted in (("lim_hallway", "there_and_back"), ("corridor_loop", "twice_round")):
        plan = load_world(name)
        points = {route.name: route.points for route in plan.routes}[wanted]
        assert points[-1] == plan.start[:2]
