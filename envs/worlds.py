"""Find a world by its name or its file and turn it into a floor plan."""

import difflib
from pathlib import Path

from assets import ROOT
from envs.floor_plan import FloorPlan
from envs.house_expo import read_house_expo
from envs.plan_generator import random_plan
from envs.plan_yaml import load_yaml, read_plan
from envs.random_world import is_random_world, parse_random_world
from envs.raster_plan import read_map_plan
from envs.text_maze import read_text_maze
from mapping.errors import TestbedError

WORLDS = Path(str(ROOT)) / "worlds"
"""Folder of the built-in worlds, one floor plan in YAML each."""

_ALLOWED = (
    "a built-in world, random:SEED or a file: floor plan .yaml, map_server .yaml, "
    "HouseExpo .json, text maze .txt"
)


def load_world(name_or_path: str | Path) -> FloorPlan:
    """The floor plan of a built-in world, of a file or drawn from a seed, as ``random:7``.

    A file is read by what it is: ``.yaml`` or ``.yml`` as a map_server map when it has the key
    ``image`` and as a floor plan otherwise, ``.json`` as HouseExpo, ``.txt`` as a text maze.
    A built-in name wins over a file of the same name; write ``./name`` for the file.

    Raises:
        TestbedError: There is no such world, or its file cannot be used.
    """
    if is_random_world(str(name_or_path)):
        return random_plan(parse_random_world(str(name_or_path)))
    if (WORLDS / f"{name_or_path}.yaml").is_file() and _is_name(name_or_path):
        return read_plan(WORLDS / f"{name_or_path}.yaml")
    path = Path(name_or_path)
    if not path.is_file():
        raise TestbedError(_no_such_world(name_or_path))
    suffix = path.suffix.lower()
    if suffix in (".yaml", ".yml"):
        return read_map_plan(path) if "image" in load_yaml(path) else read_plan(path)
    if suffix == ".json":
        return read_house_expo(path)
    if suffix == ".txt":
        return read_text_maze(path)
    raise TestbedError(f"world: {path}: unknown kind of file {suffix!r}; must be {_ALLOWED}")


def built_in_worlds() -> dict[str, str]:
    """The names of the built-in worlds, each with the line that describes it."""
    return {
        path.stem: str(load_yaml(path).get("description", ""))
        for path in sorted(WORLDS.glob("*.yaml"))
    }


def world_label(name_or_path: str | Path) -> str:
    """What to call a world in the name of a file: its own name, or its file's without the ending.

    Raises:
        TestbedError: If it asks for a random world in a way that cannot be read.
    """
    if is_random_world(str(name_or_path)):
        return parse_random_world(str(name_or_path)).name
    return Path(name_or_path).stem


def _is_name(name_or_path: str | Path) -> bool:
    """Whether this is a bare name, and not a path that only ends like one."""
    return str(name_or_path) == Path(name_or_path).name


def _no_such_world(name_or_path: str | Path) -> str:
    """The error for a name that is neither a built-in world nor a file."""
    names = [path.stem for path in sorted(WORLDS.glob("*.yaml"))]
    close = difflib.get_close_matches(str(name_or_path).lower(), names, n=1)
    hint = f"did you mean {close[0]}? " if close else ""
    what = "is a folder" if Path(name_or_path).is_dir() else "no such world or file"
    return (
        f"world: {str(name_or_path)!r}: {what}; {hint}"
        f"must be {_ALLOWED}; built in are {', '.join(names)}"
    )
