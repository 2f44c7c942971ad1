"""``burger world``: lists, draws and converts floor plans."""

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
from envs.worlds import built_in_worlds, load_world, world_label
from mapping.io.atomic import write_atomically
from scripts.arguments import parse, run_action

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
    return run_action("world", {"list": _list, "show": _show, "convert": _convert}, arguments)


def _list(arguments: list[str]) -> int:
    parse(List, "world list", arguments)
    for name, about in built_in_worlds().items():
        print(f"{name:<20} {about}")
    print(f"{'random:SEED':<20} {RANDOM_ABOUT}")
    return 0


def _show(arguments: list[str]) -> int:
    options = parse(Show, "world show", arguments)
    plan = load_world(options.world)
    out = options.out or Path(f"{world_label(options.world)}.png")
    _save_picture(plan, out)
    print(f"{plan.name}: {len(plan.solids())} solids, start {plan.start}; drawn in {out}")
    return 0


def _convert(arguments: list[str]) -> int:
    options = parse(Convert, "world convert", arguments)
    plan = load_world(options.world)
    write_plan(plan, options.out)
    print(f"{plan.name}: {len(plan.solids())} solids, written to {options.out}")
    return 0


def _save_picture(plan: FloorPlan, out: Path) -> None:
    left, right, bottom, top = plan.bounds
    width = 8.0
    height = 1.2 + width * min(max((top - bottom) / (right - left), 0.25), 4.0)
    figure = Figure(figsize=(width, height), layout="constrained")
    draw_plan(plan, figure.subplots())
    write_atomically(out, lambda file: FigureCanvasAgg(figure).print_png(file))
