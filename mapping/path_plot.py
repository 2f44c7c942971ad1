"""Draws a robot's way into a map: its path with arrows, its goals numbered, what it left over."""

import math
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.lines import Line2D
from numpy.typing import NDArray

PATH_COLOUR = "#d7191c"
GOAL_COLOUR, LEFT_OVER_COLOUR = "#0072b2", "#7b3294"
"""Blue of the palette of Okabe and Ito (2008), and a purple: apart from each other, from the red
path and from the orange truth for colour-blind eyes."""

START_SIZE, GOAL_SIZE, DOT_SIZE, CROSS_SIZE = 6.0, 8.5, 3.5, 7.0
"""Diameters of the marks [points]."""

NUMBER_SIZE = 5.5
"""Font size of the numbers in the goals' marks [points]."""

ARROW_EVERY, MOST_ARROWS = 40.0, 60
"""Way between two arrows on the page [points], and how many there are at most."""

MOST_NUMBERS = 40
"""At most so many goals have a number; the others are dots."""

Places = NDArray[np.float64]
Point = tuple[float, float]


def draw_path(ax: Axes, positions: Places, scale: float) -> None:
    """Draw a path, with arrows that show which way it goes and a ring where it starts.

    Args:
        ax: The axes, in metres.
        positions: Where the robot was ``(n, 2)`` [m], n >= 1.
        scale: Points of the page per metre.
    """
    ax.plot(*positions.T, color=PATH_COLOUR, linewidth=1.0, zorder=2)
    for tail, head in _arrows(positions, scale):
        style: dict[str, Any] = {
            "arrowstyle": "-|>",
            "color": PATH_COLOUR,
            "linewidth": 0,
            "mutation_scale": 8,
        }
        ax.annotate("", xy=head, xytext=tail, arrowprops={**style, "shrinkA": 0, "shrinkB": 0})
    ring: dict[str, Any] = {"markerfacecolor": "white", "markeredgewidth": 1.5, "zorder": 5}
    ax.plot(*positions[0], "o", color=PATH_COLOUR, markersize=START_SIZE, **ring)


def draw_goals(ax: Axes, goals: Places, scale: float) -> None:
    """Mark goals ``(n, 2)`` [m] with their numbers, from 1 on; where it gets crowded with dots.

    Args:
        ax: The axes, in metres.
        goals: Where they are, in order.
        scale: Points of the page per metre.
    """
    numbered = _spread_out(goals, GOAL_SIZE / scale)
    dots = np.delete(goals, numbered, axis=0)
    ax.plot(*dots.T, "o", color=GOAL_COLOUR, markersize=DOT_SIZE, markeredgewidth=0, zorder=3)
    for index in numbered:
        x, y = goals[index]
        rim: dict[str, Any] = {"markeredgecolor": "white", "markeredgewidth": 0.5, "zorder": 4}
        ax.plot(x, y, "o", color=GOAL_COLOUR, markersize=GOAL_SIZE, **rim)
        ax.annotate(
            str(index + 1),
            (x, y),
            color="white",
            fontsize=NUMBER_SIZE,
            ha="center",
            va="center_baseline",
            zorder=4,
            annotation_clip=True,
        )


def draw_left_over(ax: Axes, places: Places) -> None:
    """Mark the middles of frontiers that were left over ``(n, 2)`` [m] with crosses."""
    ax.plot(*places.T, "x", color="white", markersize=CROSS_SIZE, markeredgewidth=3.0, zorder=5)
    mark: dict[str, Any] = {"markersize": CROSS_SIZE, "markeredgewidth": 1.5, "zorder": 6}
    ax.plot(*places.T, "x", color=LEFT_OVER_COLOUR, **mark)


def path_handles(*, goals: bool, left_over: bool) -> list[Line2D]:
    """What a legend shows of a path, of goals if there are any and of frontiers left over."""
    ring: dict[str, Any] = {"marker": "o", "markerfacecolor": "white", "markersize": START_SIZE}
    handles = [
        Line2D([], [], color=PATH_COLOUR, label="path"),
        Line2D([], [], color=PATH_COLOUR, linestyle="", label="start", **ring),
    ]
    if goals:
        dot: dict[str, Any] = {"marker": "o", "markersize": GOAL_SIZE, "linestyle": ""}
        handles.append(Line2D([], [], color=GOAL_COLOUR, label="goals in order", **dot))
    if left_over:
        cross: dict[str, Any] = {
            "marker": "x",
            "markersize": CROSS_SIZE,
            "markeredgewidth": 1.5,
            "linestyle": "",
        }
        handles.append(Line2D([], [], color=LEFT_OVER_COLOUR, label="frontier left over", **cross))
    return handles


def _arrows(positions: Places, scale: float) -> list[tuple[Point, Point]]:
    """Short stretches of a path, evenly spread: from where to where an arrow points."""
    steps = np.hypot(*np.diff(positions, axis=0).T)
    moved = np.concatenate(([True], steps > 0.0))
    way, places = np.cumsum(np.concatenate(([0.0], steps)))[moved], positions[moved]
    count = min(int(way[-1] * scale / ARROW_EVERY), MOST_ARROWS)
    heads = (np.arange(count) + 0.5) * way[-1] / max(count, 1)
    tails = heads - 1.0 / scale
    ends = [np.interp(at, way, each).tolist() for at in (tails, heads) for each in places.T]
    return [((x, y), (to_x, to_y)) for x, y, to_x, to_y in zip(*ends, strict=True)]


def _spread_out(places: Places, apart: float) -> list[int]:
    """Which of ``places`` ``(n, 2)`` to keep, MOST_NUMBERS at most, so that none lie too near."""
    while True:
        kept: list[int] = []
        for index, place in enumerate(places):
            if all(math.dist(place, places[other]) >= apart for other in kept):
                kept.append(index)
        if len(kept) <= MOST_NUMBERS:
            return kept
        apart *= 1.25
