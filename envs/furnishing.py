"""Furnishes the rooms of a building so that the robot still gets from every door to every other."""

import math
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

from envs.building import Building, Door
from envs.floor_plan import Box, Cylinder, Point
from envs.furniture import Thing, moved
from envs.plan_raster import lattice_round, rasterize_solids
from envs.room_contents import Place, kind_of_room, wanted_in
from envs.room_layout import HUB
from envs.solids import Solid
from mapping.burger import ROBOT_RADIUS

RESOLUTION = 0.04
"""Edge of the cells in which furniture is placed [m]."""

PASSAGE = ROBOT_RADIUS + 0.055
"""Half the width that ways through a room keep [m]: gaps of 0.32 m, wider than the narrowest
door."""

DOOR_DEPTH = 0.6
"""How far before a door nothing stands [m]."""

ANCHOR_DEPTH = 0.35
"""How far before a door a way through the room must begin [m]."""

LEAF_SHARE, LEAF_THICKNESS = 0.3, 0.04
"""How many doors have a leaf, which stands open, and its thickness [m]."""

LEAF_ANGLE = (1.6, 2.0)
"""How far leaves stand open [rad]: a little more than a right angle."""

POCKET = 0.05
"""The largest piece of floor that furniture may cut off from the rest [m2]."""

OPEN_SHARE = 0.4
"""How much of a room's passable floor furniture must leave."""

PLACES_TRIED = 8
"""Places tried for each piece before it is left out."""

Mask = NDArray[np.bool_]


@dataclass(slots=True, kw_only=True)
class RoomFloor:
    """The floor of one room as it fills, in cells ``[row, col]``."""

    origin: Point
    free: Mask
    """Cells where a piece may stand."""
    passable: Mask
    """Cells where the robot's middle may be."""
    least_passable: int
    """How many passable cells must remain."""
    anchors: tuple[tuple[int, int], ...]
    """A cell before each door; they stay joined."""
    sides: tuple[tuple[Point, Point, float], ...]
    """Walls round the room: ends, the room to the left, and thickness [m]."""


def furnish(building: Building, clutter: float, rng: np.random.Generator) -> list[Thing] | None:
    """Everything that stands in the rooms; None if a room is blocked before anything stands in it.

    Args:
        building: Walls and doors.
        clutter: How full the rooms are; 1 = as is usual, 0 = empty.
        rng: Where chance comes from.
    """
    solids = [solid for wall in building.walls for solid in wall.solids()]
    origin, shape = lattice_round(solids, RESOLUTION, margin=RESOLUTION)
    solid = rasterize_solids(solids, resolution=RESOLUTION, origin=origin, shape=shape)
    rows, columns = np.indices(shape)
    centers = np.column_stack((columns.ravel(), rows.ravel())) + 0.5
    rooms = building.room_at(centers * RESOLUTION + origin).reshape(shape)
    things: list[Thing] = []
    for room in range(building.rooms):
        floor = _room_floor(building, room, (rooms == room) & ~solid, origin)
        if floor is None:
            return None
        for door in building.doors:
            if door.rooms[0] == room and rng.random() < LEAF_SHARE * min(clutter, 1.0):
                leaf = _leaf(door, rng)
                things.extend(_accepted(floor, (leaf,), _inner(leaf)))
        for door in building.doors:
            if room in door.rooms:
                floor.free &= ~_cells_of(floor, [_threshold(door)])
        things.extend(_furniture(building, room, floor, clutter, rng))
    return things


def _room_floor(building: Building, room: int, inside: Mask, origin: Point) -> RoomFloor | None:
    """An empty room; None if the robot cannot get from each of its doors to each other."""
    if not inside.any():
        return None
    rows, columns = (np.flatnonzero(inside.any(axis=axis)) for axis in (1, 0))
    window = inside[rows[0] : rows[-1] + 1, columns[0] : columns[-1] + 1].copy()
    corner = (origin[0] + columns[0] * RESOLUTION, origin[1] + rows[0] * RESOLUTION)
    clearance = np.asarray(ndimage.distance_transform_edt(np.pad(window, 1)))[1:-1, 1:-1]
    passable = clearance * RESOLUTION >= PASSAGE
    floor = RoomFloor(
        origin=corner,
        free=window,
        passable=passable,
        least_passable=int(OPEN_SHARE * np.count_nonzero(passable)),
        anchors=tuple(
            _cell_of(corner, _before(door, room, ANCHOR_DEPTH))
            for door in building.doors
            if room in door.rooms
        ),
        sides=tuple((a, b, thick) for side, a, b, thick in building.sides if side == room),
    )
    return floor if _stays_joined(floor, passable) else None


def _before(door: Door, room: int, depth: float) -> Point:
    """The point before a door's middle, in one of its rooms, so far from the wall's face [m]."""
    side = 1.0 if door.rooms[0] == room else -1.0
    away = side * (depth + 0.5 * door.thickness)
    return (
        door.center[0] - away * math.sin(door.yaw),
        door.center[1] + away * math.cos(door.yaw),
    )


def _cell_of(corner: Point, point: Point) -> tuple[int, int]:
    return (
        math.floor((point[1] - corner[1]) / RESOLUTION),
        math.floor((point[0] - corner[0]) / RESOLUTION),
    )


def _stays_joined(floor: RoomFloor, passable: Mask) -> bool:
    """Whether every anchor is passable, all are joined, and nothing of note is cut off."""
    pieces, count = ndimage.label(passable)
    names = set()
    for row, column in floor.anchors:
        if not (0 <= row < passable.shape[0] and 0 <= column < passable.shape[1]):
            return False
        names.add(int(pieces[row, column]))
    if len(names) != 1 or 0 in names:
        return False
    sizes = np.bincount(pieces.ravel(), minlength=count + 1)
    sizes[[0, names.pop()]] = 0
    return bool(sizes.max() * RESOLUTION**2 <= POCKET)


def _leaf(door: Door, rng: np.random.Generator) -> Box:
    """A door's leaf, hinged at one side, open into its first room."""
    hinge_side = 1.0 if rng.random() < 0.5 else -1.0
    angle = float(rng.uniform(*LEAF_ANGLE))
    # from the hinge, which is at the jamb on the wall's face, away from the opening
    direction = door.yaw + (math.pi - angle) if hinge_side > 0.0 else door.yaw + angle
    at = hinge_side * (0.5 * door.width + LEAF_THICKNESS)
    up = 0.5 * door.thickness + 0.01
    reach = 0.5 * door.width
    cos, sin = math.cos(door.yaw), math.sin(door.yaw)
    x = door.center[0] + at * cos - up * sin + reach * math.cos(direction)
    y = door.center[1] + at * sin + up * cos + reach * math.sin(direction)
    return Box(center=(x, y), size=(door.width, LEAF_THICKNESS), yaw=direction, height=2.0)


def _inner(leaf: Box) -> Box:
    """The ground that a leaf needs: without its end at the hinge, which touches the wall."""
    shift = 0.05
    x = leaf.center[0] + shift * math.cos(leaf.yaw)
    y = leaf.center[1] + shift * math.sin(leaf.yaw)
    return replace(leaf, center=(x, y), size=(max(leaf.size[0] - 2.0 * shift, 0.1), 0.06))


def _threshold(door: Door) -> Solid:
    """The ground on both sides of a door where nothing stands."""
    size = (door.width + 0.1, 2.0 * DOOR_DEPTH + door.thickness)
    return Box(center=door.center, size=size, yaw=door.yaw).solids()[0]


def _furniture(
    building: Building, room: int, floor: RoomFloor, clutter: float, rng: np.random.Generator
) -> list[Thing]:
    """The pieces that found a place in a room."""
    area = float(np.count_nonzero(floor.free)) * RESOLUTION**2
    width = 2.0 * RESOLUTION * float(ndimage.distance_transform_cdt(np.pad(floor.free, 1)).max())
    kind = kind_of_room(building.style, area, width, is_hub=room == HUB, rng=rng)
    things: list[Thing] = []
    for wanted in wanted_in(kind, area, clutter, rng):
        piece = wanted.maker(rng)
        for _ in range(PLACES_TRIED):
            x, y, yaw = _place(floor, wanted.place, piece.footprint, rng)
            footprint = moved(piece.footprint, x, y, yaw)
            placed = tuple(moved(thing, x, y, yaw) for thing in piece.things)
            accepted = _accepted(floor, placed, footprint)
            if accepted:
                things.extend(accepted)
                break
    return things


def _place(
    floor: RoomFloor, place: Place, footprint: Box, rng: np.random.Generator
) -> tuple[float, float, float]:
    """Where a piece's origin may come to stand, and how turned: x [m], y [m], yaw [rad]."""
    lengths = np.array([math.dist(a, b) for a, b, _ in floor.sides])
    side = int(rng.choice(len(lengths), p=lengths / lengths.sum()))
    (x0, y0), (x1, y1), thickness = floor.sides[side]
    yaw = math.atan2(y1 - y0, x1 - x0)
    if place == "wall":
        half = 0.5 * footprint.size[0]
        # pieces stand in corners as often as elsewhere
        along = float(np.clip(rng.uniform(-0.3, 1.3), 0.0, 1.0)) * (lengths[side] - 2.0 * half)
        along += half + (0.5 * thickness + 0.03) * (1.0 if along < 0.5 * lengths[side] else -1.0)
        out = 0.5 * thickness + float(rng.uniform(0.01, 0.05))
        cos, sin = math.cos(yaw), math.sin(yaw)
        skew = float(rng.normal(0.0, 0.08)) if rng.random() < 0.15 else 0.0
        out += half * abs(math.sin(skew))
        return x0 + along * cos - out * sin, y0 + along * sin + out * cos, yaw + skew
    cells = np.flatnonzero(floor.free)
    if len(cells) == 0:
        return x0, y0, yaw
    row, column = divmod(int(rng.choice(cells)), floor.free.shape[1])
    yaw += float(rng.uniform(-math.pi, math.pi)) if rng.random() < 0.4 else 0.0
    x = floor.origin[0] + (column + 0.5) * RESOLUTION
    y = floor.origin[1] + (row + 0.5) * RESOLUTION
    back = 0.5 * footprint.size[1]
    return x + back * math.sin(yaw), y - back * math.cos(yaw), yaw


def _accepted(floor: RoomFloor, things: tuple[Thing, ...], footprint: Thing) -> tuple[Thing, ...]:
    """The things, noted on the floor, if there is room for them and a way past; else none."""
    (ground,) = footprint.solids()
    rows, columns = floor.free.shape
    left, bottom = floor.origin
    right, top = left + columns * RESOLUTION, bottom + rows * RESOLUTION
    x, y = np.asarray(ground.vertices).T  # type: ignore[union-attr]  # a box is a prism
    if x.min() < left or x.max() > right or y.min() < bottom or y.max() > top:
        return ()
    taken = _cells_of(floor, [ground])
    if np.any(taken & ~floor.free):
        return ()
    solid = _cells_of(floor, [part for thing in things for part in _coarse(thing).solids()])
    distance = np.asarray(ndimage.distance_transform_edt(~solid)) * RESOLUTION
    passable = floor.passable & (distance >= PASSAGE)
    if np.count_nonzero(passable) < floor.least_passable or not _stays_joined(floor, passable):
        return ()
    floor.passable = passable
    floor.free &= ~taken & ~solid
    return things


def _coarse(thing: Thing) -> Thing:
    """A thing thick enough to hold the centre of a cell wherever it stands."""
    least = 1.5 * RESOLUTION
    if isinstance(thing, Cylinder):
        return replace(thing, radius=max(thing.radius, 0.5 * least))
    if isinstance(thing, Box):
        return replace(thing, size=(max(thing.size[0], least), max(thing.size[1], least)))
    return thing


def _cells_of(floor: RoomFloor, solids: list[Solid]) -> Mask:
    """The cells of a room's floor that solids cover."""
    return rasterize_solids(
        solids, resolution=RESOLUTION, origin=floor.origin, shape=floor.free.shape
    )
