"""Read and write floor plans as YAML that a person can type.

::

    name: my_room
    description: one line, optional
    start: [0.5, 0.5, 0.0]        # x [m], y [m], yaw [rad]
    # or   {x: 0.5, y: 0.5, yaw_deg: 90}
    walls:
      - {points: [[0, 0], [4, 0], [4, 3], [0, 3]], closed: true, thickness: 0.1, height: 2.5}
    boxes:
      - {center: [1, 2], size: [1.2, 0.6], yaw_deg: 30, height: 0.75}
    cylinders:
      - {center: [3, 1], radius: 0.15, height: 0.5}
    polygons:
      - {vertices: [[2, 2], [3, 2], [2.5, 2.8]], height: 1.0}
    routes:
      there_and_back: [[3.5, 0.5], [0.5, 0.5]]

``name`` and ``start`` must stand, and one wall, box, cylinder or polygon at least. Of a part,
``points``, ``center``, ``size``, ``radius`` and ``vertices`` must stand; the rest has the defaults
of ``Wall``, ``Box``, ``Cylinder`` and ``Polygon``. Routes are places to drive through, by a name;
``burger explore --navigator waypoints`` takes it. Lengths are metres; ``yaw`` is in radians, and
``yaw_deg`` in degrees may stand in its place.
"""

import dataclasses
import math
import re
import reprlib
from collections.abc import Callable
from pathlib import Path
from typing import Any, NoReturn, TypeGuard

import yaml

from envs.floor_plan import Box, Cylinder, FloorPlan, Part, Point, Polygon, Route, Wall
from mapping.errors import TestbedError
from mapping.io.atomic import write_atomically

try:  # libyaml reads a plan of a thousand boxes ten times faster, where PyYAML was built with it
    from yaml import CSafeLoader as _SafeLoader
except ImportError:
    from yaml import SafeLoader as _SafeLoader  # type: ignore[assignment]


def read_plan(path: str | Path) -> FloorPlan:
    """The floor plan of a YAML file.

    Raises:
        TestbedError: The file cannot be read or is no floor plan; the message names the file and
            the line or the field, such as ``walls[2]: thickness``.
    """
    path = Path(path)
    fields = load_yaml(path)
    try:
        return plan_from_fields(fields)
    except TestbedError as error:
        raise TestbedError(f"{path}: {error}") from None


def write_plan(plan: FloorPlan, path: str | Path) -> None:
    """Write a floor plan as YAML, one part a line, whole or not at all.

    Reading the file gives an equal plan: every figure is written to its last bit.

    Raises:
        TestbedError: The file cannot be written.
    """
    write_atomically(path, lambda file: file.write(plan_to_yaml(plan).encode()))


def plan_to_yaml(plan: FloorPlan) -> str:
    """The text of a floor plan, one part a line."""
    lines = [f"name: {_flow(plan.name)}"]
    if plan.description:
        lines.append(f"description: {_flow(plan.description)}")
    lines.append(f"start: {_flow(list(plan.start))}  # x [m], y [m], yaw [rad]")
    for kind, parts in plan.kinds().items():
        if parts:
            lines.append(f"{kind}:")
            lines.extend(f"  - {_flow(_as_lists(dataclasses.asdict(part)))}" for part in parts)
    if plan.routes:
        lines.append("routes:")
        lines.extend(
            f"  {_flow(route.name)}: {_flow(_as_lists(route.points))}" for route in plan.routes
        )
    return "\n".join(lines) + "\n"


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
        routes=_routes(fields.get("routes")),
    )


def load_yaml(path: Path) -> dict[str, Any]:
    """The mapping in a YAML file.

    Raises:
        TestbedError: The file is missing, unreadable, no YAML, no mapping, or says a key twice.
    """
    try:
        fields = yaml.load(path.read_text(encoding="utf-8"), Loader=_Loader)
    except FileNotFoundError:
        raise TestbedError(f"{path}: no such file; must be a floor plan in YAML") from None
    except (OSError, UnicodeDecodeError) as error:
        raise TestbedError(f"{path}: cannot be read as text ({error})") from error
    except yaml.MarkedYAMLError as error:
        line = error.problem_mark.line + 1 if error.problem_mark else 1
        raise TestbedError(f"{path}: line {line}: not YAML ({error.problem})") from None
    except (yaml.YAMLError, ValueError, RecursionError) as error:
        raise TestbedError(f"{path}: not YAML ({' '.join(str(error).split())})") from None
    if not isinstance(fields, dict):
        raise TestbedError(f"{path}: no mapping of keys to values; must be a floor plan in YAML")
    return fields


class _Loader(_SafeLoader):
    """YAML 1.1 that refuses a key said twice, of which PyYAML would silently keep the last."""

    def construct_mapping(self, node: yaml.MappingNode, deep: bool = False) -> dict[Any, Any]:
        """The mapping of a node whose keys all differ."""
        seen: set[str] = set()
        for key, _ in node.value:
            if isinstance(key.value, str) and key.value in seen:
                raise yaml.constructor.ConstructorError(
                    problem=f"{key.value!r} stands twice", problem_mark=key.start_mark
                )
            seen.add(str(key.value))
        return super().construct_mapping(node, deep)


# YAML 1.1 takes 1e-2 for text; YAML 1.2, and everybody, for a number.
_Loader.add_implicit_resolver(
    "tag:yaml.org,2002:float",
    re.compile(r"[-+]?[0-9]+(\.[0-9]*)?[eE][-+]?[0-9]+$"),
    list("-+0123456789"),
)


def _parts(fields: dict[str, Any], kind: str) -> tuple[Any, ...]:
    """All walls, boxes, cylinders or polygons."""
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


def _part(kind: str, fields: object) -> Part:
    """One wall, box, cylinder or polygon."""
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


def _flow(value: object) -> str:
    """A value as YAML on one line."""
    text: str = yaml.safe_dump(
        value, default_flow_style=True, sort_keys=False, width=math.inf, allow_unicode=True
    )
    return text.removesuffix("\n").removesuffix("\n...")


def _as_lists(value: Any) -> Any:
    """The same value with lists for tuples, which YAML has not."""
    if isinstance(value, dict):
        return {key: _as_lists(entry) for key, entry in value.items()}
    return [_as_lists(entry) for entry in value] if isinstance(value, tuple) else value


_Readers = dict[str, Callable[[str, object], Any]]

_PARTS: dict[str, tuple[Callable[..., Part], _Readers, _Readers]] = {
    "walls": (
        Wall,
        {"points": _points},
        {"closed": _flag, "thickness": _number, "height": _number},
    ),
    "boxes": (Box, {"center": _point, "size": _point}, {"yaw": _number, "height": _number}),
    "cylinders": (Cylinder, {"center": _point, "radius": _number}, {"height": _number}),
    "polygons": (Polygon, {"vertices": _points}, {"height": _number}),
}
"""Of each kind of part: what makes it, how its needed keys are read, and its optional ones."""
