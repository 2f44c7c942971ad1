"""Draws single pieces of furniture: what stands on the floor, around the piece's own origin.

The origin is the middle of the back, where the piece stands to a wall; +y points into the room.
Sizes are those of shops' catalogues, rounded.
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from envs.floor_plan import Box, Cylinder, Point, Polygon

Thing = Box | Cylinder | Polygon

LEG_DIAMETER = (0.02, 0.05)
"""Thickness of the legs of tables and chairs [m]."""

TABLE_HEIGHT, SEAT_HEIGHT = 0.72, 0.45


@dataclass(frozen=True, slots=True, kw_only=True)
class Piece:
    """A piece of furniture, and the ground that no other piece may stand on."""

    things: tuple[Thing, ...]
    footprint: Box
    """Ground taken, that under a table's top included."""


Maker = Callable[[np.random.Generator], Piece]


def moved(thing: Thing, x: float, y: float, yaw: float) -> Thing:
    """The thing as it stands when its origin comes to (x, y) [m] and is turned by yaw [rad]."""
    cos, sin = math.cos(yaw), math.sin(yaw)

    def place(point: Point) -> Point:
        return x + cos * point[0] - sin * point[1], y + sin * point[0] + cos * point[1]

    if isinstance(thing, Polygon):
        return replace(thing, vertices=tuple(place(vertex) for vertex in thing.vertices))
    if isinstance(thing, Box):
        return replace(thing, center=place(thing.center), yaw=thing.yaw + yaw)
    return replace(thing, center=place(thing.center))


def block(width: tuple[float, float], depth: tuple[float, float], height: float) -> Maker:
    """A closed piece, such as a wardrobe, of a width and depth in these bounds [m]."""

    def make(rng: np.random.Generator) -> Piece:
        wide, deep = float(rng.uniform(*width)), float(rng.uniform(*depth))
        box = _box(wide, deep, height)
        return Piece(things=(box,), footprint=box)

    return make


def bin_of(radius: tuple[float, float], height: float) -> Maker:
    """A round thing, such as a bin, a plant's pot or a pillar, of a radius in these bounds [m]."""

    def make(rng: np.random.Generator) -> Piece:
        r = float(rng.uniform(*radius))
        thing = Cylinder(center=(0.0, r), radius=r, height=height)
        return Piece(things=(thing,), footprint=_box(2.0 * r, 2.0 * r, height))

    return make


def corner_sofa(rng: np.random.Generator) -> Piece:
    """A sofa with a chaise longue: an L."""
    wide, deep = float(rng.uniform(2.0, 2.8)), float(rng.uniform(0.85, 1.0))
    reach, chaise = float(rng.uniform(1.45, 1.75)), float(rng.uniform(0.8, 1.0))
    half = 0.5 * wide
    corners = [
        (-half, 0.0),
        (half, 0.0),
        (half, deep),
        (chaise - half, deep),
        (chaise - half, reach),
        (-half, reach),
    ]
    if rng.random() < 0.5:
        corners = [(-x, y) for x, y in corners]
    sofa = Polygon(vertices=tuple(corners), height=0.8)
    return Piece(things=(sofa,), footprint=_box(wide, reach, 0.8))


def armchair(rng: np.random.Generator) -> Piece:
    """An armchair, narrower at the back: a trapezium."""
    wide, back, deep = (float(rng.uniform(*each)) for each in ((0.7, 0.9), (0.5, 0.7), (0.7, 0.9)))
    corners = ((-0.5 * back, 0.0), (0.5 * back, 0.0), (0.5 * wide, deep), (-0.5 * wide, deep))
    return Piece(
        things=(Polygon(vertices=corners, height=0.8),), footprint=_box(max(wide, back), deep, 0.8)
    )


def kitchen_corner(rng: np.random.Generator) -> Piece:
    """Kitchen units round a corner: an L of 0.6 m deep counters."""
    wide, reach, deep = float(rng.uniform(1.8, 3.0)), float(rng.uniform(1.4, 2.2)), 0.6
    half = 0.5 * wide
    corners = [(-half, 0), (half, 0), (half, deep), (deep - half, deep)]
    corners += [(deep - half, reach), (-half, reach)]
    if rng.random() < 0.5:
        corners = [(-x, y) for x, y in corners]
    units = Polygon(vertices=tuple(corners), height=0.9)
    return Piece(things=(units,), footprint=_box(wide, reach, 0.9))


def low_table(rng: np.random.Generator) -> Piece:
    """A coffee table: four legs."""
    wide, deep = float(rng.uniform(0.8, 1.2)), float(rng.uniform(0.5, 0.7))
    return Piece(things=_legs(wide, deep, 0.4, rng), footprint=_box(wide, deep, 0.4))


def desk(rng: np.random.Generator) -> Piece:
    """A desk on legs, some with a drawer unit below, and a chair before it."""
    wide, deep = float(rng.uniform(1.2, 1.8)), float(rng.uniform(0.6, 0.8))
    things: list[Thing] = list(_legs(wide, deep, TABLE_HEIGHT, rng))
    if rng.random() < 0.5:
        side = math.copysign(0.5 * wide - 0.25, rng.random() - 0.5)
        things.append(Box(center=(side, 0.5 * deep), size=(0.4, min(deep - 0.1, 0.55)), height=0.6))
    x, y = float(rng.uniform(-0.2, 0.2)), deep + float(rng.uniform(0.1, 0.35))
    things += _office_chair(x, y, rng) if rng.random() < 0.5 else _chair(x, y, math.pi, rng)
    return Piece(things=tuple(things), footprint=_box(wide, deep + 0.7, TABLE_HEIGHT))


def dining_table(rng: np.random.Generator) -> Piece:
    """A table on legs with chairs along both sides, none of them quite in line."""
    seats = int(rng.integers(1, 4))
    wide, deep = 0.2 + 0.65 * seats + float(rng.uniform(0.0, 0.3)), float(rng.uniform(0.75, 1.0))
    pull = 0.45
    things: list[Thing] = [
        moved(leg, 0.0, pull, 0.0) for leg in _legs(wide, deep, TABLE_HEIGHT, rng)
    ]
    for seat in range(seats):
        x = (seat - 0.5 * (seats - 1)) * 0.65
        for y, yaw in ((pull, 0.0), (pull + deep, math.pi)):
            if rng.random() < 0.85:
                out = float(rng.uniform(0.1, 0.3)) * (1.0 if yaw else -1.0)
                things += _chair(x, y + out, yaw + float(rng.normal(0.0, 0.25)), rng)
    return Piece(things=tuple(things), footprint=_box(wide, deep + 2.0 * pull, TABLE_HEIGHT))


def round_table(rng: np.random.Generator) -> Piece:
    """A table on one column, with chairs round it."""
    r = float(rng.uniform(0.35, 0.6))
    reach = r + 0.45
    column = float(rng.uniform(0.04, 0.25))
    things: list[Thing] = [Cylinder(center=(0.0, reach), radius=column, height=TABLE_HEIGHT)]
    first = float(rng.uniform(0.0, 2.0 * math.pi))
    seats = int(rng.integers(2, 5))
    for seat in range(seats):
        angle = first + 2.0 * math.pi * seat / seats
        out = r + float(rng.uniform(0.1, 0.25))
        x, y = out * math.cos(angle), reach + out * math.sin(angle)
        things += _chair(x, y, angle + 0.5 * math.pi, rng)
    return Piece(things=tuple(things), footprint=_box(2.0 * reach, 2.0 * reach, TABLE_HEIGHT))


def lone_chair(rng: np.random.Generator) -> Piece:
    """A chair."""
    return Piece(things=tuple(_chair(0.0, 0.25, 0.0, rng)), footprint=_box(0.5, 0.5, SEAT_HEIGHT))


def screen(rng: np.random.Generator) -> Piece:
    """A thin partition that stands free in a room."""
    return block((1.0, 2.2), (0.04, 0.08), 1.8)(rng)


def _box(wide: float, deep: float, height: float) -> Box:
    """A box whose back's middle is the origin."""
    return Box(center=(0.0, 0.5 * deep), size=(wide, deep), height=height)


def _legs(
    wide: float, deep: float, height: float, rng: np.random.Generator
) -> tuple[Cylinder, ...]:
    """Four legs under the corners of a top whose back's middle is the origin."""
    r = 0.5 * float(rng.uniform(*LEG_DIAMETER))
    inset = r + 0.03
    x = 0.5 * wide - inset
    corners: Sequence[Point] = ((-x, inset), (x, inset), (x, deep - inset), (-x, deep - inset))
    return tuple(Cylinder(center=corner, radius=r, height=height) for corner in corners)


def _chair(x: float, y: float, yaw: float, rng: np.random.Generator) -> list[Thing]:
    """Four legs round (x, y)."""
    r = 0.5 * float(rng.uniform(LEG_DIAMETER[0], 0.035))
    half = 0.5 * float(rng.uniform(0.36, 0.44)) - r
    legs = [
        Cylinder(center=(u, v), radius=r, height=SEAT_HEIGHT)
        for u, v in ((-half, -half), (half, -half), (half, half), (-half, half))
    ]
    return [moved(leg, x, y, yaw) for leg in legs]


def _office_chair(x: float, y: float, rng: np.random.Generator) -> list[Thing]:
    """A swivel chair: a column and five castors round it; the arms between are left out."""
    first = float(rng.uniform(0.0, 2.0 * math.pi))
    castors: list[Thing] = [
        Cylinder(
            center=(x + 0.28 * math.cos(angle), y + 0.28 * math.sin(angle)),
            radius=0.025,
            height=0.25,
        )
        for angle in (first + 2.0 * math.pi * arm / 5.0 for arm in range(5))
    ]
    return [*castors, Cylinder(center=(x, y), radius=0.03, height=SEAT_HEIGHT)]
