"""Turns the fields of a YAML mapping into a floor plan, naming the field that is wrong."""

import math
import reprlib
from collections.abc import Callable
from typing import Any, NoReturn, TypeGuard

from envs.floor_plan import Box, Cylinder, FloorPlan, Pedestrian, Point, Polygon, Route, Wall
from mapping.errors import TestbedError


def plan_from_fields(fields: dict[str, Any]) -> FloorPlan:
    """The floor plan of a parsed YAML mapping.

    Raises:
        TestbedError: A key is unknown or missing, or its value is not what is allowed.
    """
    _check_keys(fields, needed=("name", "start"), allowed=("description", *_PARTS, "routes"))
    return FloorPlan(
        name=_text("name", fields["name"]),
        description=_text("description", fields.get("description", "")),
        start=_start(fields["start"]),
        walls=_parts(fields, "walls"),
        boxes=_parts(fields, "boxes"),
        cylinders=_parts(fields, "cylinders"),
        polygons=_parts(fields, "polygons"),
        pedestrians=_parts(fields, "pedestrians"),
        routes=_routes(fields.get("routes")),
    )


def _parts(fields: dict[str, Any], kind: str) -> tuple[Any, ...]:
    """All walls, boxes, cylinders, polygons or pedestrians."""
    listed = fields.get(kind)
    if listed is None:
        return ()
    if not isinstance(listed, list):
        _refuse(kind, listed, "a list")
    parts = []
    for i, part in enumerate(listed):
        try:
            parts.append(_part(kind, part))
        except TestbedError as error:
            raise TestbedError(f"{kind}[{i}]: {error}") from None
    return tuple(parts)


def _part(kind: str, fields: object) -> object:
    """One wall, box, cylinder, polygon or pedestrian."""
    make, needed, optional = _PARTS[kind]
    readers = needed | optional
    if not isinstance(fields, dict):
        raise TestbedError(f"{reprlib.repr(fields)}; must be keys and values: {', '.join(readers)}")
    degrees = ("yaw_deg",) if "yaw" in readers else ()
    _check_keys(fields, needed=tuple(needed), allowed=(*optional, *degrees))
    values = _with_radians(fields)
    return make(**{key: readers[key](key, value) for key, value in values.items()})


def _routes(value: object) -> tuple[Route, ...]:
    """All routes, of a mapping of names to points."""
    if value is None:
        return ()
    if not isinstance(value, dict):
        _refuse("routes", value, "names with lists of [x, y] [m]")
    routes = []
    for name, points in value.items():
        try:
            routes.append(Route(name=_text("name", name), points=_points("points", points)))
        except TestbedError as error:
            raise TestbedError(f"routes: {name}: {error}") from None
    return tuple(routes)


def _start(value: object) -> tuple[float, float, float]:
    """The start pose, of a list or of a mapping."""
    if isinstance(value, dict):
        try:
            _check_keys(value, needed=("x", "y"), allowed=("yaw", "yaw_deg"))
            pose = {key: _number(key, number) for key, number in _with_radians(value).items()}
        except TestbedError as error:
            raise TestbedError(f"start: {error}") from None
        return pose["x"], pose["y"], pose.get("yaw", 0.0)
    if not (isinstance(value, list) and len(value) == 3 and all(map(_is_number, value))):
        _refuse("start", value, "[x, y, yaw] in m and rad, or {x: , y: , yaw_deg: }")
    x, y, yaw = map(float, value)
    return x, y, yaw


def _with_radians(fields: dict[str, Any]) -> dict[str, Any]:
    """The same fields, ``yaw_deg`` turned into ``yaw``."""
    if "yaw_deg" not in fields:
        return fields
    if "yaw" in fields:
        raise TestbedError("yaw: stands beside yaw_deg; must be only one of them")
    yaw = math.radians(_number("yaw_deg", fields["yaw_deg"]))
    return {key: value for key, value in fields.items() if key != "yaw_deg"} | {"yaw": yaw}


def _check_keys(
    fields: dict[str, Any], *, needed: tuple[str, ...], allowed: tuple[str, ...]
) -> None:
    """Refuse a mapping with a key too many or too few."""
    for key in fields:
        if key not in needed + allowed:
            raise TestbedError(f"{key}: unknown key; must be one of {', '.join(needed + allowed)}")
    for key in needed:
        if key not in fields:
            raise TestbedError(f"{key}: missing; must stand")


def _number(field: str, value: object) -> float:
    if not _is_number(value):
        _refuse(field, value, "a number")
    return float(value)


def _flag(field: str, value: object) -> bool:
    if not isinstance(value, bool):
        _refuse(field, value, "true or false")
    return value


def _text(field: str, value: object) -> str:
    if not isinstance(value, str) or len(value.splitlines()) > 1:
        _refuse(field, value, "one line of text")
    return value.strip()


def _point(field: str, value: object) -> Point:
    if not (isinstance(value, list) and len(value) == 2 and all(map(_is_number, value))):
        _refuse(field, value, "two numbers [x, y] [m]")
    return float(value[0]), float(value[1])


def _points(field: str, value: object) -> tuple[Point, ...]:
    if not isinstance(value, list):
        _refuse(field, value, "a list of [x, y] [m]")
    return tuple(_point(f"{field}[{i}]", point) for i, point in enumerate(value))


def _is_number(value: object) -> TypeGuard[int | float]:
    """Whether a YAML value is a number that a float can hold."""
    if isinstance(value, bool) or not isinstance(value, int | float):
        return False
    return isinstance(value, float) or abs(value) < 2**53


def _refuse(field: str, value: object, allowed: str) -> NoReturn:
    """Raise the error of a wrong value; a long value is cut short."""
    raise TestbedError(f"{field}: {reprlib.repr(value)}; must be {allowed}")


_Readers = dict[str, Callable[[str, object], Any]]

_PARTS: dict[str, tuple[Callable[..., object], _Readers, _Readers]] = {
    "walls": (
        Wall,
        {"points": _points},
        {"closed": _flag, "thickness": _number, "height": _number},
    ),
    "boxes": (Box, {"center": _point, "size": _point}, {"yaw": _number, "height": _number}),
    "cylinders": (Cylinder, {"center": _point, "radius": _number}, {"height": _number}),
    "polygons": (Polygon, {"vertices": _points}, {"height": _number}),
    "pedestrians": (
        Pedestrian,
        {"waypoints": _points},
        {"speed": _number, "phase": _number, "there_and_back": _flag},
    ),
}
"""Of each kind of part: what makes it, how its needed keys are read, and its optional ones."""
