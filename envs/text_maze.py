"""Turn a text maze into a floor plan: what the text shows from above is what the robot meets.

Lines of ``key: value`` come first, then the maze, the top line being the far side (largest y)::

    name: two_rooms
    cell: 0.5
    #########
    #S..#...#
    #.......#
    #########

``#`` is a block of wall; ``.`` and blank are floor; ``S`` or ``>`` is the start facing +x, ``^``
facing +y, ``<`` facing -x, ``v`` facing -y. Without a start the widest place is taken. Keys:
``cell``, the edge of a block [m]; ``height`` of the walls [m]; ``name``; ``description``. The
lower-left corner of the text lies at (0, 0); lines that are shorter than others end in floor.
"""

import math
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from envs.default_start import default_start
from envs.floor_plan import FloorPlan
from envs.floor_space import enclosed_cells
from envs.raster_plan import cell_boxes
from mapping.errors import TestbedError

DEFAULT_CELL = 0.5
"""Edge of a block [m] when the text gives none: a corridor the robot passes with room to spare."""

DEFAULT_HEIGHT = 1.0
"""Height of the walls [m] when the text gives none, as ``Wall`` has it."""

MAX_SIDE = 1000
"""The most lines and columns of a maze; a larger plan is a map."""

_WALL, _FLOOR = "#", ". "
_HEADINGS = {"S": 0.0, ">": 0.0, "^": 0.5 * math.pi, "<": math.pi, "v": -0.5 * math.pi}
_KEYS = ("cell", "height", "name", "description")

_FINE = 8
"""Parts of a cell's edge on the raster on which a missing start is looked for."""


def read_text_maze(path: str | Path) -> FloorPlan:
    """The floor plan of a text file; its name is the file's unless the text gives one.

    Raises:
        TestbedError: The file cannot be read or is no maze; the message names file, line, column.
    """
    path = Path(path)
    try:
        text = path.read_text(encoding="utf-8")
    except FileNotFoundError:
        raise TestbedError(f"{path}: no such file; must be a text maze") from None
    except (OSError, UnicodeDecodeError) as error:
        raise TestbedError(f"{path}: cannot be read as text ({error})") from error
    try:
        return plan_from_text(text, name=path.stem)
    except TestbedError as error:
        raise TestbedError(f"{path}: {error}") from None


def plan_from_text(text: str, *, name: str = "maze") -> FloorPlan:
    """The floor plan of a maze as text; see the module for its signs.

    Raises:
        TestbedError: A sign, key or figure that is not allowed, named by line and column.
    """
    lines = text.expandtabs().splitlines()
    header, first = _read_header(lines)
    cell = _positive(header, "cell", DEFAULT_CELL)
    height = _positive(header, "height", DEFAULT_HEIGHT)
    blocks, start_cell = _read_blocks(lines, first)
    if start_cell is None:
        start = _chosen_start(blocks, cell)
    else:
        row, column, yaw = start_cell
        start = ((column + 0.5) * cell, (row + 0.5) * cell, yaw)
    return FloorPlan(
        name=header.get("name", (name, 0))[0],
        description=header.get("description", ("", 0))[0],
        start=start,
        boxes=cell_boxes(blocks, resolution=cell, origin=(0.0, 0.0), height=height),
    )


def _read_header(lines: list[str]) -> tuple[dict[str, tuple[str, int]], int]:
    """The values of the keys with their line numbers, and the index of the maze's first line."""
    header: dict[str, tuple[str, int]] = {}
    for i, line in enumerate(lines):
        if ":" not in line:
            if line.strip():
                return header, i
            continue
        key, value = (part.strip() for part in line.split(":", 1))
        if key not in _KEYS:
            raise TestbedError(
                f"line {i + 1}: unknown key {key!r}; must be one of {', '.join(_KEYS)}"
            )
        if key in header:
            raise TestbedError(f"line {i + 1}: {key} is given twice; must stand once")
        header[key] = (value, i + 1)
    raise TestbedError("the maze has zero area; it needs lines of '#' and '.'")


def _positive(header: dict[str, tuple[str, int]], key: str, default: float) -> float:
    """A figure of the header [m], or the default."""
    if key not in header:
        return default
    value, line = header[key]
    try:
        number = float(value)
    except ValueError:
        number = math.nan
    if not (math.isfinite(number) and number > 0.0):
        raise TestbedError(f"line {line}: {key}: {value!r}; must be a finite number above 0 [m]")
    return number


def _read_blocks(
    lines: list[str], first: int
) -> tuple[NDArray[np.bool_], tuple[int, int, float] | None]:
    """Wall blocks ``[row = y, col = x]``, row 0 the last line; the start's row, column and yaw."""
    rows = [line.rstrip() for line in lines[first:]]
    while rows and not rows[-1]:
        rows.pop()
    blocks = np.zeros((len(rows), max(map(len, rows))), dtype=np.bool_)
    if max(blocks.shape) > MAX_SIDE:
        raise TestbedError(
            f"the maze has {blocks.shape[0]} lines of {blocks.shape[1]} signs; "
            f"must be {MAX_SIDE} at most"
        )
    start: tuple[int, int, float] | None = None
    for i, line in enumerate(rows):
        row = len(rows) - 1 - i
        for column, sign in enumerate(line):
            where = f"line {first + i + 1}, column {column + 1}"
            if sign == _WALL:
                blocks[row, column] = True
            elif sign in _HEADINGS:
                if start is not None:
                    raise TestbedError(f"{where}: {sign!r} is a second start; must be only one")
                start = (row, column, _HEADINGS[sign])
            elif sign not in _FLOOR:
                raise TestbedError(f"{where}: {sign!r}; must be one of '#', '.', ' ', 'S', '><^v'")
    return blocks, start


def _chosen_start(blocks: NDArray[np.bool_], cell: float) -> tuple[float, float, float]:
    """A start in the widest floor that walls enclose, or in the widest floor if none do."""
    fine = np.kron(blocks, np.ones((_FINE, _FINE), dtype=np.bool_))
    free = enclosed_cells(fine)
    return default_start(free if free.any() else ~fine, resolution=cell / _FINE, origin=(0.0, 0.0))
