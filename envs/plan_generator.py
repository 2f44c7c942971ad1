"""Draws a floor plan of a building from a seed: rooms, doors, furniture, and a start for the robot.

A building is laid out (``room_layout``), built (``building``) and furnished (``furnishing``). One
in which the robot would not reach every room is drawn anew.
"""

from dataclasses import replace
from functools import lru_cache

import numpy as np
from scipy import ndimage

from envs.building import (
    MAX_WEDGE,
    TURNED_SHARE,
    WEDGE_SHARE,
    Building,
    build,
)
from envs.building_frame import frame_for
from envs.floor_plan import Box, Cylinder, FloorPlan, Point, Polygon, Wall
from envs.furnishing import furnish
from envs.furniture import Thing
from envs.plan_raster import lattice_round, rasterize_solids
from envs.random_world import (
    MAX_AREA,
    MAX_ROOMS,
    MIN_AREA,
    MIN_ROOM_AREA,
    MIN_ROOMS,
    MIN_STYLE_AREA,
    RandomWorld,
)
from envs.room_layout import draw_rooms
from mapping.burger import ROBOT_RADIUS
from mapping.errors import TestbedError

STYLE_SHARES = {"apartment": 0.45, "office": 0.33, "hall": 0.22}
"""How often each style is drawn."""

ROOM_AREA = (9.0, 30.0)
"""Area per room when neither is asked for [m2]."""

CLUTTER = (0.25, 1.3)
"""How full rooms are, drawn once a building; 1 = as is usual."""

MIN_OFFICE_ROOMS = 3
"""Rooms of an office, unless fewer are asked for: a corridor with one room is none."""

TRIES = 100
"""Buildings drawn before giving up; most seeds need one or two."""

RESOLUTION = 0.02
"""Edge of the cells by which it is checked that rooms are reached [m]."""

REACH_CLEARANCE = ROBOT_RADIUS + 0.02
"""What the robot keeps from everything on its way to every room [m]."""

START_CLEARANCE = 0.2
"""What the robot keeps from everything at its start [m]."""

REACHED_SHARE = 0.5
"""How much of a room's floor must be reached for the room to count as reached."""


@lru_cache(maxsize=8)
def random_plan(asked: RandomWorld) -> FloorPlan:
    """The floor plan that a seed and wishes give; the same ones give the same plan.

    Raises:
        TestbedError: If no such building was found, as with many rooms on little floor.
    """
    for rng in np.random.default_rng(asked.seed).spawn(TRIES):
        style, area, rooms = _program(asked, rng)
        building = draw_building(style, area, rooms, rng)
        if building is None:
            continue
        things = furnish(building, float(rng.uniform(*CLUTTER)), rng)
        if things is None:
            continue
        plan = _plan(asked, area, building, things, rng)
        if plan is not None:
            return plan
    raise TestbedError(
        f"{asked.name}: no such building found in {TRIES} tries; ask for fewer rooms or more area"
    )


def draw_building(style: str, area: float, rooms: int, rng: np.random.Generator) -> Building | None:
    """An empty building of a style, with an area [m2] and so many rooms; None: draw again."""
    labels = draw_rooms(style, area, rooms, rng)
    if labels is None:
        return None
    wedge = float(rng.uniform(-MAX_WEDGE, MAX_WEDGE)) if rng.random() < WEDGE_SHARE else 0.0
    yaw = float(rng.uniform(-np.pi, np.pi)) if rng.random() < TURNED_SHARE else 0.0
    return build(style, labels, frame_for(labels, area, wedge=wedge, yaw=yaw), rng)


def _program(asked: RandomWorld, rng: np.random.Generator) -> tuple[str, float, int]:
    """Style, area [m2] and number of rooms: what was asked for, and the rest by chance."""
    least_area = MIN_AREA if asked.style is None else MIN_STYLE_AREA[asked.style]
    if asked.rooms is not None:
        least_area = max(least_area, ROOM_AREA[0] * asked.rooms)
    drawn_area = float(np.exp(rng.uniform(np.log(least_area), np.log(MAX_AREA))))
    area = drawn_area if asked.area is None else asked.area
    drawn_rooms = int(np.clip(round(area / rng.uniform(*ROOM_AREA)), MIN_ROOMS, MAX_ROOMS))
    rooms = drawn_rooms if asked.rooms is None else asked.rooms
    styles = [
        style
        for style in STYLE_SHARES
        if area >= max(MIN_STYLE_AREA[style], rooms * MIN_ROOM_AREA[style])
        and (style != "office" or rooms >= MIN_OFFICE_ROOMS)
    ]
    shares = np.array([STYLE_SHARES[style] for style in styles])
    drawn_style = str(rng.choice(styles, p=shares / shares.sum()))
    return drawn_style if asked.style is None else asked.style, area, rooms


def _plan(
    asked: RandomWorld,
    area: float,
    building: Building,
    things: list[Thing],
    rng: np.random.Generator,
) -> FloorPlan | None:
    """The floor plan, with a start from which every room is reached; None if there is none."""
    walls = tuple(_rounded_wall(wall) for wall in building.walls)
    tidied = [_rounded(thing) for thing in things]
    start = _start(building, walls, tidied, rng)
    if start is None:
        return None
    return FloorPlan(
        name=asked.name,
        start=start,
        walls=walls,
        boxes=tuple(thing for thing in tidied if isinstance(thing, Box)),
        cylinders=tuple(thing for thing in tidied if isinstance(thing, Cylinder)),
        polygons=tuple(thing for thing in tidied if isinstance(thing, Polygon)),
        description=f"{building.style}, {building.rooms} rooms, {area:.0f} m2, drawn from a seed",
    )


def _start(
    building: Building, walls: tuple[Wall, ...], things: list[Thing], rng: np.random.Generator
) -> tuple[float, float, float] | None:
    """A pose anywhere on the floor from which the robot gets into every room."""
    solids = [solid for part in (*walls, *things) for solid in part.solids()]
    origin, shape = lattice_round(solids, RESOLUTION, margin=RESOLUTION)
    solid = rasterize_solids(solids, resolution=RESOLUTION, origin=origin, shape=shape)
    clearance = np.asarray(ndimage.distance_transform_edt(~solid)) * RESOLUTION
    rows, columns = np.nonzero(clearance >= REACH_CLEARANCE)
    points = (np.column_stack((columns, rows)) + 0.5) * RESOLUTION + origin
    rooms = building.room_at(points)
    pieces = np.asarray(ndimage.label(clearance >= REACH_CLEARANCE)[0])[rows, columns]
    reached = pieces == np.argmax(np.bincount(pieces[rooms >= 0]))
    for room in range(building.rooms):
        if np.count_nonzero(reached & (rooms == room)) < REACHED_SHARE * np.sum(rooms == room):
            return None
    roomy = np.flatnonzero(reached & (clearance[rows, columns] >= START_CLEARANCE))
    if len(roomy) == 0:
        return None
    x, y = _rounded_point(tuple(points[rng.choice(roomy)].tolist()))
    return x, y, round(float(rng.uniform(-np.pi, np.pi)), 3)


def _rounded_point(point: Point) -> Point:
    """To the millimetre, as a person would write a plan."""
    return round(float(point[0]), 3), round(float(point[1]), 3)


def _rounded_wall(wall: Wall) -> Wall:
    points = tuple(_rounded_point(point) for point in wall.points)
    return replace(wall, points=points, thickness=round(wall.thickness, 3))


def _rounded(thing: Thing) -> Thing:
    if isinstance(thing, Polygon):
        return replace(thing, vertices=tuple(_rounded_point(each) for each in thing.vertices))
    if isinstance(thing, Cylinder):
        return replace(thing, center=_rounded_point(thing.center), radius=round(thing.radius, 3))
    return replace(
        thing,
        center=_rounded_point(thing.center),
        size=_rounded_point(thing.size),
        yaw=round(thing.yaw, 4),
    )
