"""``burger world``: lists, draws and converts floor plans."""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from tyro.conf import Positional

from envs.floor_plan import FloorPlan
from envs.plan_picture import draw_plan
from envs.plan_yaml import write_plan
from envs.random_world import MAX_AREA, MAX_ROOMS, MIN_AREA, MIN_ROOMS, STYLES
from envs.worlds import built_in_worlds, load_world
from mapping.errors import TestbedError
from mapping.io.atomic import write_atomically
from scripts.arguments import parse

RANDOM_ABOUT = (
    f"a building drawn from the seed, {MIN_AREA:g} to {MAX_AREA:g} m2, {MIN_ROOMS} to {MAX_ROOMS} "
    f"rooms; after commas rooms=N, area=M2, style={'|'.join(STYLES)}"
)


@dataclass(frozen=True, kw_only=True)
class Show:
    """Draw a floor plan and the robot's start."""

    world: Annotated[str, Positional]
    """A built-in world by name, random:SEED, or a floor plan file."""
    out: Path | None = None
    """Picture to write; default NAME.png."""


@dataclass(frozen=True, kw_only=True)
class Convert:
    """Write any floor plan as the testbed's own YAML."""

    world: Annotated[str, Positional]
    """A built-in world by name, random:SEED, or a floor plan file."""
    out: Annotated[Path, Positional]
    """YAML file to write."""


@dataclass(frozen=True, kw_only=True)
class List:
    """List the built-in worlds."""


def run(arguments: list[str]) -> int:
    """Run the verb's own verb: list, show or convert."""
    actions: dict[str, Callable[[list[str]], None]] = {
        "list": _list,
        "show": _show,
        "convert": _convert,
    }
    if not arguments or arguments[0] in ("-h", "--help"):
        print(f"usage: burger world {{{','.join(actions)}}} ...   (each takes --help)")
        return 0 if arguments else 2
    action, *rest = arguments
    if action not in actions:
        raise TestbedError(f"{action!r} is unknown; must be one of {', '.join(actions)}")
    actions[action](rest)
    return 0


def _list(arguments: list[str]) -> None:
    parse(List, "world list", arguments)
    for name, about in built_in_worlds().items():
        print(f"{name:<20} {about}")
    print(f"{'random:SEED':<20} {RANDOM_ABOUT}")


def _show(arguments: list[str]) -> None:
    options = parse(Show, "world show", arguments)
    plan = load_world(options.world)
    out = options.out or Path(f"{plan.name}.png")
    _save_picture(plan, out)
    print(f"{plan.name}: {len(plan.solids())} solids, start {plan.start}; drawn in {out}")


def _convert(arguments: list[str]) -> None:
    options = parse(Convert, "world convert", arguments)
    plan = load_world(options.world)
    write_plan(plan, options.out)
    print(f"{plan.name}: {len(plan.solids())} solids, written to {options.out}")


def _save_picture(plan: FloorPlan, out: Path) -> None:
    left, right, bottom, top = plan.bounds
    width = 8.0
    height = 1.2 + width * min(max((top - bottom) / (right - left), 0.25), 4.0)
    figure = Figure(figsize=(width, height), layout="constrained")
    draw_plan(plan, figure.subplots())
    write_atomically(out, lambda file: FigureCanvasAgg(figure).print_png(file))
