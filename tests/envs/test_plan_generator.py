"""Plans drawn from seeds: sound, joined, as large and as divided as asked, the same every time."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy import ndimage
from shapely.geometry import LineString, Point
from shapely.geometry import Polygon as Shape
from shapely.ops import unary_union

from envs.building import Building, Door
from envs.floor_plan import Box, FloorPlan
from envs.plan_generator import draw_building, random_plan
from envs.plan_raster import lattice_for, rasterize
from envs.plan_yaml import plan_to_yaml
from envs.random_world import MIN_ROOM_AREA, MIN_STYLE_AREA, STYLES, RandomWorld
from envs.solids import Disc, Solid
from envs.worlds import load_world
from mapping.burger import ROBOT_RADIUS
from mapping.errors import TestbedError

SEEDS = st.integers(0, 10**9)


def reached_rooms(plan: FloorPlan, building: Building) -> set[int]:
    """Rooms the robot gets into from the start, with 1 cm to spare, by flooding a fine raster."""
    resolution = 0.015
    origin, shape = lattice_for(plan, resolution, margin=0.1)
    solid = rasterize(plan, resolution=resolution, origin=origin, shape=shape)
    clearance = np.asarray(ndimage.distance_transform_edt(~solid)) * resolution
    pieces, _ = ndimage.label(clearance >= ROBOT_RADIUS + 0.01)
    row, column = (int((plan.start[1 - i] - origin[1 - i]) // resolution) for i in (0, 1))
    assert pieces[row, column] > 0
    rows, columns = np.nonzero(pieces == pieces[row, column])
    points = (np.column_stack((columns, rows)) + 0.5) * resolution + origin
    return set(building.room_at(points).tolist())


def drawn(style: str, area: float, rooms: int, seed: int) -> Building:
    for rng in np.random.default_rng(seed).spawn(100):
        building = draw_building(style, area, rooms, rng)
        if building is not None:
            return building
    raise AssertionError("no building in 100 draws")


def shape_of(solid: Solid) -> Shape:
    if isinstance(solid, Disc):
        return Point(*solid.center).buffer(solid.radius)
    return Shape(solid.vertices)


def door_filled(door: Door) -> Shape:
    """A box that shuts a door."""
    box = Box(center=door.center, size=(door.width + 0.02, door.thickness), yaw=door.yaw)
    return shape_of(box.solids()[0])


@given(seed=SEEDS, data=st.data())
@settings(max_examples=12)
def test_a_building_has_the_area_and_the_rooms_that_were_asked_for(
    seed: int, data: st.DataObject
) -> None:
    style = data.draw(st.sampled_from(STYLES))
    rooms = data.draw(st.integers(3, 15))
    least = max(MIN_STYLE_AREA[style], 1.5 * rooms * MIN_ROOM_AREA[style])
    area = data.draw(st.floats(least, 450.0))
    building = drawn(style, area, rooms, seed)
    walls = unary_union([shape_of(solid) for wall in building.walls for solid in wall.solids()])
    shut = unary_union([walls, *(door_filled(door) for door in building.doors)])
    largest = max(getattr(shut, "geoms", [shut]), key=lambda piece: piece.envelope.area)
    within = Shape(largest.exterior)
    outer = max(wall.thickness for wall in building.walls)
    assert within.buffer(-0.5 * outer, join_style="mitre").area == pytest.approx(area, rel=0.01)
    inside = within.difference(shut)
    assert len([piece for piece in inside.geoms if piece.area > 0.3]) == rooms


@given(seed=SEEDS)
@settings(max_examples=8)
def test_doors_are_as_wide_as_they_say_and_passable(seed: int) -> None:
    building = drawn("apartment", 90.0, 6, seed)
    walls = unary_union([shape_of(solid) for wall in building.walls for solid in wall.solids()])
    for door in building.doors:
        assert 0.30 <= door.width <= 1.20
        along = np.array([np.cos(door.yaw), np.sin(door.yaw)])
        reach = 0.5 * door.width
        gap = LineString([door.center - 0.99 * reach * along, door.center + 0.99 * reach * along])
        assert not walls.intersects(gap)
        wider = LineString(
            [door.center - (reach + 0.02) * along, door.center + (reach + 0.02) * along]
        )
        assert walls.intersection(wider).length == pytest.approx(0.04, abs=0.005)


@given(seed=SEEDS)
@settings(max_examples=10)
def test_every_room_is_reached_from_the_start_however_much_stands_about(seed: int) -> None:
    plan = random_plan(RandomWorld(seed=seed))
    rooms = int(plan.description.split()[1])
    building = building_of(RandomWorld(seed=seed))
    assert building.rooms == rooms
    assert set(range(rooms)) <= reached_rooms(plan, building)


@given(seed=SEEDS)
@settings(max_examples=5)
def test_nothing_stands_in_a_wall_or_in_another_thing(seed: int) -> None:
    plan = random_plan(RandomWorld(seed=seed, area=120.0))
    walls = unary_union([shape_of(solid) for wall in plan.walls for solid in wall.solids()])
    things = [
        shape_of(solid)
        for part in (*plan.boxes, *plan.cylinders, *plan.polygons)
        for solid in part.solids()
    ]
    # placed by the centres of 4 cm cells
    assert all(walls.intersection(thing).area <= 0.04 * thing.length for thing in things)


def test_the_same_seed_gives_the_same_bytes_and_another_seed_another_plan() -> None:
    first = plan_to_yaml(random_plan(RandomWorld(seed=3)))
    random_plan.cache_clear()
    assert plan_to_yaml(random_plan(RandomWorld(seed=3))) == first
    assert plan_to_yaml(random_plan(RandomWorld(seed=4))) != first


def test_a_world_is_drawn_by_its_name() -> None:
    plan = load_world("random:7,rooms=4,area=60,style=office")
    assert plan == random_plan(RandomWorld(seed=7, rooms=4, area=60.0, style="office"))
    assert plan.description == "office, 4 rooms, 60 m2, drawn from a seed"


def test_what_was_not_asked_for_varies_over_the_seeds() -> None:
    told = [random_plan(RandomWorld(seed=seed, area=60.0)).description for seed in range(12)]
    assert len({line.split(",")[0] for line in told}) == 3, "styles"
    assert len({line.split(",")[1] for line in told}) >= 3, "rooms"


def test_a_building_that_is_never_found_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("envs.plan_generator.draw_rooms", lambda *_: None)
    with pytest.raises(TestbedError, match=r"random_5: no such building .* fewer rooms"):
        random_plan(RandomWorld(seed=5))


def building_of(asked: RandomWorld) -> Building:
    """The building that a random plan was furnished from: the last one that was drawn."""
    buildings: list[Building] = []

    def note(*arguments: object) -> Building | None:
        building = draw_building(*arguments)  # type: ignore[arg-type]
        if building is not None:
            buildings.append(building)
        return building

    random_plan.cache_clear()
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("envs.plan_generator.draw_building", note)
        random_plan(asked)
    return buildings[-1]
