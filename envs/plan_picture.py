"""Draw a floor plan: its solids dark, its floor light, the robot where it starts."""

import math

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import PatchCollection
from matplotlib.colors import ListedColormap
from matplotlib.patches import Circle, Patch
from matplotlib.patches import Polygon as PolygonPatch

from envs.floor_plan import FloorPlan, Part, Polygon
from envs.floor_space import floor_space
from envs.pedestrians import HIP_WIDTH, positions_at
from envs.solids import Disc
from mapping.burger import ROBOT_RADIUS

FLOOR_RESOLUTION = 0.02
"""Edge of the cells by which the floor is found and its area told [m]."""

_WALL_COLOUR, _THING_COLOUR = "#20242b", "#6d7683"
_FLOOR_COLOUR, _GROUND_COLOUR = "#fbf7ec", "#d9dde3"
_ROBOT_COLOUR = "#d55e00"
"""Vermilion of the palette of Okabe and Ito (2008), which colour-blind readers can tell."""

_PEOPLE_COLOUR = "#0072b2"
"""Blue of the same palette."""

_ARROW_RADII = 4.0
"""Length of the arrow of the start pose, in robot radii."""


def draw_plan(plan: FloorPlan, ax: Axes) -> None:
    """Draw a floor plan into axes, in metres, with equal aspect.

    Walls and polygons are near black, furniture grey, the floor that the start is joined to light
    and everything else pale grey. Ways of people are dashed, with a dot where each is at time 0.
    The title tells the name, the floor's area and how many solids there are. The start is an arrow
    from a circle of the robot's own radius.
    """
    space = floor_space(plan, resolution=FLOOR_RESOLUTION)
    ax.set_facecolor(_GROUND_COLOUR)
    ax.imshow(
        np.ma.masked_equal(space.free, False),
        cmap=ListedColormap([_FLOOR_COLOUR]),
        extent=space.extent,
        origin="lower",
        interpolation="nearest",
        zorder=0,
    )
    _draw_solids(plan, ax)
    _draw_people(plan, ax)
    _draw_start(plan, ax)
    left, right, bottom, top = plan.bounds
    margin = 0.03 * max(right - left, top - bottom)
    ax.set_xlim(left - margin, right + margin)
    ax.set_ylim(bottom - margin, top + margin)
    ax.set_aspect("equal")
    ax.set_xlabel("x [m]")
    ax.set_ylabel("y [m]")
    floor = f"{space.area:.2f} m² of floor" if space.enclosed else "floor not enclosed"
    ax.set_title(f"{plan.name}: {floor}, {len(plan.solids())} solids", fontsize="medium")


def _draw_solids(plan: FloorPlan, ax: Axes) -> None:
    """Every solid as a patch."""
    patches: list[Patch] = []
    colours: list[str] = []
    for label, part in plan.parts():
        colour = _WALL_COLOUR if label.startswith(("walls", "polygons")) else _THING_COLOUR
        outlines = _outlines(part)
        patches.extend(outlines)
        colours.extend([colour] * len(outlines))
    # A line of the same colour closes the seams that antialiasing leaves between neighbours.
    ax.add_collection(
        PatchCollection(patches, facecolors=colours, edgecolors=colours, linewidths=0.7, zorder=2)
    )


def _outlines(part: Part) -> list[Patch]:
    """The outlines of a part: of a polygon as it was given, of the rest as solids."""
    if isinstance(part, Polygon):
        return [PolygonPatch(part.vertices, closed=True)]
    return [
        Circle((solid.center[0], solid.center[1]), solid.radius)
        if isinstance(solid, Disc)
        else PolygonPatch(solid.vertices, closed=True)
        for solid in part.solids()
    ]


def _draw_people(plan: FloorPlan, ax: Axes) -> None:
    """Everybody's round as a dashed line, and where they are at time 0."""
    for person in plan.pedestrians:
        ax.plot(*person.laid_out()[0].T, "--", color=_PEOPLE_COLOUR, linewidth=1.2, zorder=3)
    for person, (x, y) in zip(plan.pedestrians, positions_at(plan.pedestrians, 0.0), strict=True):
        ax.add_patch(Circle((x, y), HIP_WIDTH, color=_PEOPLE_COLOUR, zorder=3))
        beside, speed = (x + 1.5 * HIP_WIDTH, y), f"{person.speed:g} m/s"
        ax.annotate(speed, beside, color=_PEOPLE_COLOUR, fontsize="small", zorder=4)


def _draw_start(plan: FloorPlan, ax: Axes) -> None:
    """The start pose as an arrow from a circle of the robot's radius."""
    x, y, yaw = plan.start
    length = _ARROW_RADII * ROBOT_RADIUS
    ax.add_patch(Circle((x, y), ROBOT_RADIUS, color=_ROBOT_COLOUR, zorder=3))
    ax.annotate(
        "",
        xy=(x + length * math.cos(yaw), y + length * math.sin(yaw)),
        xytext=(x, y),
        arrowprops={"arrowstyle": "-|>", "color": _ROBOT_COLOUR, "linewidth": 1.5, "shrinkA": 0},
        zorder=4,
    )
