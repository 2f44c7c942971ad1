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
    pedestrians:
      - {waypoints: [[0.6, 1.4], [2.4, 1.4], [1.6, 0.6]], speed: 0.9, phase: 0.5}
    routes:
      there_and_back: [[3.5, 0.5], [0.5, 0.5]]

``name`` and ``start`` must stand, and one wall, box, cylinder or polygon at least. Of a part,
``points``, ``center``, ``size``, ``radius`` and ``vertices`` must stand; the rest has the defaults
of ``Wall``, ``Box``, ``Cylinder`` and ``Polygon``. Pedestrians walk round their waypoints for
ever, or with ``there_and_back: true`` to the last one and back, at ``speed`` [m/s]; ``phase`` is
the share of the round that lies behind them at time 0. Routes are places to drive through, by a
name; ``burger explore --navigator waypoints`` takes it. Lengths are metres; ``yaw`` is in radians,
and ``yaw_deg`` in degrees may stand in its place.
"""

import dataclasses
import math
from pathlib import Path
from typing import Any

import yaml

from envs.floor_plan import FloorPlan
from envs.plan_fields import plan_from_fields
from envs.yaml_file import load_yaml
from mapping.errors import TestbedError
from mapping.io.atomic import write_atomically

__all__ = ["load_yaml", "plan_from_fields", "plan_to_yaml", "read_plan", "write_plan"]


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
    if plan.pedestrians:
        lines.append("pedestrians:")
        lines.extend(
            f"  - {_flow(_as_lists(dataclasses.asdict(person)))}" for person in plan.pedestrians
        )
    if plan.routes:
        lines.append("routes:")
        lines.extend(
            f"  {_flow(route.name)}: {_flow(_as_lists(route.points))}" for route in plan.routes
        )
    return "\n".join(lines) + "\n"


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
