"""Turn a HouseExpo JSON file into a floor plan: one closed wall along the outline of its floor.

HouseExpo (Li et al. 2019, github.com/TeaganLi/HouseExpo) gives each floor as ``verts``, one ring
of corners [m] round the free space. The ring is open or repeats its first corner, and may touch
itself. The wall's thickness is centred on the ring, so the free space is narrower than the ring's
by ``HOUSE_WALL_THICKNESS / 2`` on every side.
"""

import json
import math
import reprlib
from pathlib import Path
from typing import Any

from envs.default_start import default_start
from envs.floor_plan import FloorPlan, Wall
from envs.floor_space import enclosed_cells
from envs.plan_raster import lattice_round, rasterize_solids
from mapping.errors import TestbedError

HOUSE_WALL_THICKNESS = 0.05
"""Thickness of the wall [m]: thin enough to keep doors and corridors nearly as wide as they are,
five cells of the 1 cm grid, so that no beam and no cell slips through."""

HOUSE_WALL_HEIGHT = 1.0
"""Height of the wall [m]: HouseExpo gives none; as ``Wall`` has it."""

_START_RESOLUTION = 0.025
"""Edge of the cells on which a start is looked for [m]: half the wall's thickness, so that the
raster has no holes."""


def read_house_expo(path: str | Path) -> FloorPlan:
    """The floor plan of a HouseExpo JSON file; the start is chosen by ``default_start``.

    Raises:
        TestbedError: The file cannot be read, or ``verts`` is no ring that encloses an area wide
            enough for the robot. The message names the file and the field.
    """
    path = Path(path)
    house = _load(path)
    ring = _ring(path, house.get("verts"))
    name = house.get("id") or path.stem
    try:
        wall = Wall(
            points=ring,
            closed=True,
            thickness=HOUSE_WALL_THICKNESS,
            height=HOUSE_WALL_HEIGHT,
        )
        return FloorPlan(
            name=str(name),
            description=_description(house.get("room_num")),
            start=_start(wall),
            walls=(wall,),
        )
    except TestbedError as error:
        raise TestbedError(f"{path}: verts: {error}") from None


def _load(path: Path) -> dict[str, Any]:
    """The file's JSON object, or one clear error."""
    try:
        house = json.loads(path.read_text(encoding="utf-8"))
    except FileNotFoundError:
        raise TestbedError(f"{path}: no such file; must be a HouseExpo JSON file") from None
    except json.JSONDecodeError as error:
        raise TestbedError(f"{path}: line {error.lineno}: not JSON ({error.msg})") from None
    except (OSError, ValueError, RecursionError) as error:
        raise TestbedError(f"{path}: cannot be read as JSON ({error})") from error
    if not isinstance(house, dict) or "verts" not in house:
        raise TestbedError(f"{path}: verts: missing; must be a HouseExpo JSON object")
    return house


def _ring(path: Path, verts: object) -> tuple[tuple[float, float], ...]:
    """The corners of the ring, each checked to be two numbers."""
    if not isinstance(verts, list):
        raise TestbedError(f"{path}: verts: {type(verts).__name__}; must be a list of [x, y] [m]")
    ring = []
    for i, vert in enumerate(verts):
        is_point = isinstance(vert, list) and len(vert) == 2
        if not is_point or any(isinstance(v, bool) or not isinstance(v, int | float) for v in vert):
            raise TestbedError(
                f"{path}: verts[{i}]: {reprlib.repr(vert)}; must be two numbers [x, y] [m]"
            )
        ring.append((_as_float(vert[0]), _as_float(vert[1])))
    return tuple(ring)


def _as_float(value: int | float) -> float:
    """The number as a float; an integer too large for one is infinite, which the wall refuses."""
    try:
        return float(value)
    except OverflowError:
        return math.inf


def _description(room_num: object) -> str:
    """What place this is, as far as the file tells."""
    return f"HouseExpo floor, {room_num} rooms" if isinstance(room_num, int) else "HouseExpo floor"


def _start(wall: Wall) -> tuple[float, float, float]:
    """A start in the widest place within the wall."""
    solids = wall.solids()
    origin, shape = lattice_round(solids, _START_RESOLUTION, margin=_START_RESOLUTION)
    solid = rasterize_solids(solids, resolution=_START_RESOLUTION, origin=origin, shape=shape)
    return default_start(enclosed_cells(solid), resolution=_START_RESOLUTION, origin=origin)
