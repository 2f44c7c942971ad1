"""Turns a map whose walls have holes into one whose walls are closed, as far as it is safe.

Two rules. The thesis's (5.1, fig. 5.3 and 5.5) joins occupied cells by lines, whatever lies
between. The better one, which the thesis asks for (5.3), draws walls on along their own direction:
across a hole to the same wall's other part, up to what they meet, or out to the corner where two of
them meet. It changes unknown cells only, so it draws nothing where beams passed. Neither closes a
passage: places where the robot is known to fit, and can go between, stay connected.

The better rule's lengths were chosen on maps of lim_room and lim_hallway, so that what it draws
lies on true walls; ``docs/mapping.md`` has the figures.
"""

from typing import Literal

import numpy as np

from mapping.errors import TestbedError
from mapping.gap_filling_hole_kernels import narrow_holes
from mapping.gap_filling_kernels import (
    Lines,
    Mask,
    States,
    draw_lines,
    gaps_along_rows,
    near_lines,
)
from mapping.gap_filling_passages import floor_of, that_close_nothing
from mapping.gap_filling_wall_kernels import corners, extended, wall_ends
from mapping.grid import OCCUPIED, UNKNOWN, OccupancyGrid

GapFilling = Literal["none", "thesis", "better"]

NEAR_REACH = 0.05
"""The thesis's 10 x 10 cm around a cell: so far to every side [m] (5.1)."""

AXIS_REACH = 0.5
"""Along rows and columns the thesis joins cells up to this far apart [m] (5.1). The better rule
draws walls on as far: a narrower opening is no door."""

HOLE_REACH = 0.18
"""A narrow hole of a straight wall is at most so wide [m]: hardly wider than the robot, and more
than ``SUPPORT``, within which the end of a wall cannot be told from what follows."""

SUPPORT, SUPPORT_SHARE = 0.15, 2.0 / 3.0
"""Behind a hole the wall must go on for so long [m], with an occupied cell in this share of the
steps: what is shorter, or made of specks, has no direction."""

HOLE_WIDTH = 0.015
"""At a narrow hole each of these cells lies within this of the line across it [m]."""

END_SHARE, END_ROUGHNESS = 0.3, 0.015
"""Within ``SUPPORT`` of the end of a wall, occupied cells lie on average this share of that behind
it (0.5 for a thin wall, 0 in the middle of one), and scatter about their line by this [m]: a
corner and a heap of far readings scatter by more."""

MOST_CORNER_COSINE = 0.7
"""Walls at 45 degrees or more to one another make a corner."""

FILLED_ABOVE = 1.0
"""A filled cell has this much more log odds than it takes to be occupied."""

RULES = ("none", "thesis", "better")


def check_rule(rule: str) -> None:
    """Refuse what is no rule.

    Raises:
        TestbedError: It is none of RULES.
    """
    if rule not in RULES:
        raise TestbedError(f"gap_filling: {rule!r}; must be one of {', '.join(RULES)}")


def with_gaps_filled(grid: OccupancyGrid, rule: GapFilling) -> OccupancyGrid:
    """A copy of a map with its gaps filled; the map itself for the rule ``none``.

    Raises:
        TestbedError: There is no such rule.
    """
    if rule == "none":
        return grid
    filled = fill_gaps(grid.states(), grid.resolution, rule)
    copy = grid.copy()
    copy.log_odds[filled] = np.float32(grid.config.occupied_above + FILLED_ABOVE)
    return copy


def fill_gaps(states: States, resolution: float, rule: GapFilling) -> Mask:
    """The cells that a rule fills ``(rows, columns)``; none of them is occupied yet.

    The thesis's rule is applied once: lines join what was seen, not what was drawn. The better one
    is applied until nothing changes, so that filling what it filled changes nothing.

    Args:
        states: UNKNOWN, FREE or OCCUPIED ``(rows, columns)``.
        resolution: Edge of a cell [m].
        rule: ``none``, ``thesis`` or ``better``.

    Raises:
        TestbedError: There is no such rule.
    """
    check_rule(rule)
    filled = np.zeros(states.shape, dtype=np.bool_)
    rows, columns = _known_part(states)
    part = np.ascontiguousarray(states[rows, columns])
    if rule == "none" or not np.any(part == OCCUPIED):
        return filled
    now = part.copy()
    draw = _draw_as_thesis if rule == "thesis" else _draw_walls_on
    while draw(now, resolution) and rule == "better":
        pass
    filled[rows, columns] = now != part
    return filled


def _known_part(states: States) -> tuple[slice, slice]:
    """The rows and columns of a map that hold all it knows."""
    known = states != UNKNOWN
    rows, columns = np.flatnonzero(known.any(axis=1)), np.flatnonzero(known.any(axis=0))
    if rows.size == 0:
        return slice(0), slice(0)
    return slice(rows[0], rows[-1] + 1), slice(columns[0], columns[-1] + 1)


def _draw_as_thesis(states: States, resolution: float) -> bool:
    """Draw the thesis's lines into a map; whether there were any."""
    occupied = states == OCCUPIED
    near, reach = round(NEAR_REACH / resolution), round(AXIS_REACH / resolution)
    along_rows = gaps_along_rows(occupied, reach)
    along_columns = gaps_along_rows(np.ascontiguousarray(occupied.T), reach)[:, [1, 0, 3, 2]]
    along = np.concatenate((along_rows, along_columns))
    lines = (near_lines(occupied, near), that_close_nothing(along, floor_of(states, resolution)))
    return _draw(states, np.concatenate(lines))


def _draw_walls_on(states: States, resolution: float) -> bool:
    """Draw walls on over unknown cells of a map; whether there was anything to draw."""
    reach = round(AXIS_REACH / resolution)
    support = max(round(SUPPORT / resolution), 1)
    needed = max(round(SUPPORT_SHARE * support), 1)
    holes = narrow_holes(
        states, round(HOLE_REACH / resolution), support, HOLE_WIDTH / resolution, needed
    )
    ends = wall_ends(states, support, END_SHARE, max(END_ROUGHNESS / resolution, 0.5), needed)
    met, room = extended(states, ends, reach, support)
    meeting = corners(states, ends, room, MOST_CORNER_COSINE)
    floor = floor_of(states, resolution)
    single = that_close_nothing(np.concatenate((holes, met)), floor)
    drawn = _draw(states, single)
    floor = floor_of(states, resolution)
    paired = that_close_nothing(meeting, floor, together=2)
    states[paired[:, 2], paired[:, 3]] = OCCUPIED
    return _draw(states, paired) or drawn or len(paired) > 0


def _draw(states: States, lines: Lines) -> bool:
    """Draw lines into a map; whether that changed it."""
    drawn = np.zeros(states.shape, dtype=np.bool_)
    draw_lines(lines, drawn)
    drawn &= states != OCCUPIED
    states[drawn] = OCCUPIED
    return bool(drawn.any())
