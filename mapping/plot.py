"""Turns maps into pictures: occupied black, free white, unknown blue, the path red."""

from pathlib import Path
from typing import TypeGuard

import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from numpy.typing import ArrayLike, NDArray

from mapping.cell_image import CellImage
from mapping.grid import FREE, OCCUPIED, UNKNOWN, OccupancyGrid
from mapping.io.atomic import write_atomically
from mapping.io.map_server import MapFile
from mapping.path_plot import draw_goals, draw_left_over, draw_path, path_handles
from mapping.truth import TruthMap

OCCUPIED_COLOUR, FREE_COLOUR, UNKNOWN_COLOUR = "#000000", "#ffffff", "#9ecae1"
"""Black, white and a light blue; with that below and those of ``path_plot`` they stay apart for
colour-blind eyes."""

TRUTH_COLOUR = "#e69f00"

MARGIN = 0.3
"""Unknown space shown around what is known [m]."""

LEGEND_ENTRY = 1.05
"""Width of an entry of the legend [inch]; it takes more rows where they do not fit in one."""

LONGEST_SIDE, LONGEST_OF_NARROW, NARROW_SIDE = 8.0, 12.0, 3.6
"""Longer side of a picture's map [inch]; that of a narrow one is longer, until its other side is as
long as the last."""

LEAST_WIDTH, LEAST_HEIGHT, DPI = 4.5, 2.25, 150
"""Room for the map and its legend [inch], and dots per inch."""

MAX_CELLS_DRAWN = 1200
"""Cells drawn along a side; beyond, blocks of cells are drawn as one, so no wall gets lost."""

POINTS_PER_INCH = 72.0

_Extent = tuple[float, float, float, float]


def draw_map(
    ax: Axes,
    grid: OccupancyGrid | MapFile,
    path: ArrayLike | None = None,
    truth: TruthMap | None = None,
    goals: ArrayLike | None = None,
    left_over: ArrayLike | None = None,
) -> None:
    """Draw a map into axes, in metres, cropped to what is known.

    Args:
        ax: The axes.
        grid: The map.
        path: Where the robot was ``(n, 2 or more)``: x, y [m]; a ring marks its start.
        truth: Its walls are outlined.
        goals: What the robot set out for ``(n, 2)`` [m], in order.
        left_over: Frontiers that it never saw behind ``(n, 2)`` [m].
    """
    states, extent = _known_states(grid)
    CellImage(ax, _colours(states), extent)
    if truth is not None:
        _outline(ax, truth)
    scale = POINTS_PER_INCH * _inches_per_metre(extent)
    if _some(path):
        draw_path(ax, np.asarray(path, dtype=np.float64)[:, :2], scale)
    if _some(goals):
        draw_goals(ax, np.asarray(goals, dtype=np.float64), scale)
    if _some(left_over):
        draw_left_over(ax, np.asarray(left_over, dtype=np.float64))
    ax.set_xlim(extent[0], extent[1])
    ax.set_ylim(extent[2], extent[3])
    ax.set_aspect("equal")
    ax.set_xlabel("x [m]")
    ax.set_ylabel("y [m]")


def save_map_picture(
    file: str | Path,
    grid: OccupancyGrid | MapFile,
    *,
    path: ArrayLike | None = None,
    truth: TruthMap | None = None,
    goals: ArrayLike | None = None,
    left_over: ArrayLike | None = None,
    title: str = "",
    scale: float = 1.0,
) -> None:
    """Save a picture of a map as png, without any display; the same map gives the same bytes.

    Args:
        file: Where to.
        grid: The map.
        path: Where the robot was ``(n, 2 or more)``: x, y [m].
        truth: Its walls are outlined.
        goals: What the robot set out for ``(n, 2)`` [m], in order.
        left_over: Frontiers that it never saw behind ``(n, 2)`` [m].
        title: A line above the map.
        scale: 2 makes the picture twice as large.

    Raises:
        TestbedError: The folder cannot be written.
    """
    _, extent = _known_states(grid)
    inches = _inches_per_metre(extent)
    width = max(inches * (extent[1] - extent[0]), LEAST_WIDTH) + 0.8
    height = max(inches * (extent[3] - extent[2]), LEAST_HEIGHT) + 1.2
    figure = Figure(figsize=(width, height), layout="constrained")
    canvas = FigureCanvasAgg(figure)
    ax = figure.subplots()
    draw_map(ax, grid, path, truth, goals, left_over)
    if title:
        figure.suptitle(title, fontsize=9, wrap=True)
    handles = _legend(truth is not None)
    if path is not None:
        handles += path_handles(goals=_some(goals), left_over=_some(left_over))
    figure.legend(
        handles=handles,
        loc="outside lower center",
        ncols=min(len(handles), int(width / LEGEND_ENTRY)),
        fontsize=8,
        frameon=False,
    )
    figure.set_dpi(DPI * scale)
    write_atomically(file, lambda out: canvas.print_png(out, metadata={"Software": None}))


def _inches_per_metre(extent: _Extent) -> float:
    """How large a map is drawn."""
    shorter, longer = sorted((extent[1] - extent[0], extent[3] - extent[2]))
    side = min(max(LONGEST_SIDE, NARROW_SIDE * longer / shorter), LONGEST_OF_NARROW)
    return side / longer


def _some(places: ArrayLike | None) -> TypeGuard[ArrayLike]:
    """Whether there are any."""
    return places is not None and len(np.asarray(places)) > 0


def _known_states(grid: OccupancyGrid | MapFile) -> tuple[NDArray[np.int8], _Extent]:
    """The known part with a margin, pooled so that it is not too fine; its edges [m]."""
    states = grid.states() if isinstance(grid, OccupancyGrid) else grid.states
    known = states != UNKNOWN
    rows, columns = np.flatnonzero(known.any(axis=1)), np.flatnonzero(known.any(axis=0))
    if rows.size == 0:
        rows = columns = np.zeros(1, dtype=np.intp)
    margin = int(np.ceil(MARGIN / grid.resolution))
    part = states[rows[0] : rows[-1] + 1, columns[0] : columns[-1] + 1]
    pooled, block = _pooled(np.pad(part, margin, constant_values=UNKNOWN))
    left = float(grid.origin[0]) + (float(columns[0]) - margin) * grid.resolution
    bottom = float(grid.origin[1]) + (float(rows[0]) - margin) * grid.resolution
    right = left + pooled.shape[1] * block * grid.resolution
    top = bottom + pooled.shape[0] * block * grid.resolution
    return pooled, (left, right, bottom, top)


def _pooled(states: NDArray[np.int8]) -> tuple[NDArray[np.int8], int]:
    """Blocks of cells as one, occupied if one of them is, else free if one is; their edge."""
    block = -(-max(states.shape) // MAX_CELLS_DRAWN)
    rows, columns = (-(-side // block) for side in states.shape)
    padding = ((0, rows * block - states.shape[0]), (0, columns * block - states.shape[1]))
    padded = np.pad(states, padding, constant_values=UNKNOWN)
    pooled: NDArray[np.int8] = padded.reshape(rows, block, columns, block).max(axis=(1, 3))
    return pooled, block


def _colours(states: NDArray[np.int8]) -> NDArray[np.uint8]:
    """An RGB image ``(rows, columns, 3)`` of states."""
    image = np.empty((*states.shape, 3), dtype=np.uint8)
    for state, colour in (
        (UNKNOWN, UNKNOWN_COLOUR),
        (FREE, FREE_COLOUR),
        (OCCUPIED, OCCUPIED_COLOUR),
    ):
        image[states == state] = list(bytes.fromhex(colour[1:]))
    return image


def _outline(ax: Axes, truth: TruthMap) -> None:
    """Draw the edges of the truth's walls as thin lines, along the edges of its cells."""
    walls, block = truth.occupied, -(-max(truth.shape) // MAX_CELLS_DRAWN)
    walls = walls[block // 2 :: block, block // 2 :: block]
    step = block * truth.resolution
    x = truth.origin[0] + (block // 2 + 0.5) * truth.resolution + np.arange(walls.shape[1]) * step
    y = truth.origin[1] + (block // 2 + 0.5) * truth.resolution + np.arange(walls.shape[0]) * step
    if walls.any() and not walls.all() and min(walls.shape) > 1:
        ax.contour(x, y, walls, levels=[0.5], colors=TRUTH_COLOUR, linewidths=0.8)


def _legend(with_truth: bool) -> list[Patch | Line2D]:
    handles: list[Patch | Line2D] = [
        Patch(facecolor=OCCUPIED_COLOUR, edgecolor="grey", label="occupied"),
        Patch(facecolor=FREE_COLOUR, edgecolor="grey", label="free"),
        Patch(facecolor=UNKNOWN_COLOUR, edgecolor="grey", label="unknown"),
    ]
    if with_truth:
        handles.append(Line2D([], [], color=TRUTH_COLOUR, label="truth"))
    return handles
