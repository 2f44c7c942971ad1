"""Turns a map into the thesis's pictures: in cells, the start heading up (fig. 4.3, 5.1, 5.2).

A map plotted while mapping goes on is that of ``OccGridMapp.snapshot``.
"""

from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from numpy.typing import ArrayLike, NDArray

from mapping.cell_image import CellImage
from mapping.geometry import inverse, transform_points
from mapping.grid import FREE, OCCUPIED, UNKNOWN, OccupancyGrid
from mapping.io.atomic import write_atomically
from mapping.path_plot import PATH_COLOUR
from mapping.plot import FREE_COLOUR, OCCUPIED_COLOUR, UNKNOWN_COLOUR

THESIS_START = (10.0, 10.0)
"""Where the start lies in the thesis's map frame, x' and y' [m] (4.3.4: "translated at point
(1000,1000)" of cells of 1 cm)."""

MARGIN = 0.3
"""Space shown around what is drawn [m]."""

LONGEST_SIDE, LEAST_SIDE, DPI = 9.0, 3.5, 150
"""Size of the map in a picture [inch], and dots per inch."""

MAX_CELLS_DRAWN = 1200
"""Cells drawn along a side; beyond, blocks of cells are drawn as one, so no wall gets lost."""

_Points = NDArray[np.float64]
_Box = tuple[int, int, int, int]


def thesis_cells(points: ArrayLike, start_pose_map: ArrayLike, resolution: float) -> _Points:
    """Points in the thesis's map frame, in cells: x' = -y, y' = x, moved by 10 m (4.3.4).

    Args:
        points: In the map frame ``(n, 2)``: x, y [m].
        start_pose_map: Where the robot started in that frame: x, y [m], yaw [rad].
        resolution: Edge of a cell [m].

    Returns:
        x', y' ``(n, 2)``, not rounded.
    """
    seen_from_start = transform_points(inverse(start_pose_map), points)
    turned = np.column_stack((-seen_from_start[:, 1], seen_from_start[:, 0]))
    return np.asarray((turned + THESIS_START) / resolution)


def draw_thesis_map(
    ax: Axes,
    grid: OccupancyGrid,
    *,
    start_pose_map: ArrayLike = (0.0, 0.0, 0.0),
    path: ArrayLike | None = None,
    obstacles_only: bool = True,
) -> None:
    """Draw a map into axes as the thesis does, cropped to what is drawn.

    Args:
        ax: The axes; they tell cells, of 1 cm with the thesis's resolution.
        grid: The map.
        start_pose_map: Where the robot started: x, y [m], yaw [rad].
        path: Where it was ``(n, 2 or more)``: x, y [m].
        obstacles_only: Only occupied cells are drawn (fig. 5.1); else free ones are white and
            unknown ones blue (fig. 5.2).
    """
    start = np.asarray(start_pose_map, dtype=np.float64)
    states = grid.states()
    box = _box(grid, states == OCCUPIED if obstacles_only else states != UNKNOWN, start)
    image, block = _image(grid, states, start, box, obstacles_only)
    left, bottom = box[0], box[2]
    right, top = left + image.shape[1] * block, bottom + image.shape[0] * block
    CellImage(ax, image, (float(left), float(right), float(bottom), float(top)))
    if path is not None and len(np.asarray(path)) > 0:
        way = thesis_cells(np.asarray(path)[:, :2], start, grid.resolution)
        ax.plot(way[:, 0], way[:, 1], "-", color=PATH_COLOUR, linewidth=1.0)
    ax.set_xlim(left, right)
    ax.set_ylim(bottom, top)
    ax.set_aspect("equal")
    unit = f"cells of {100.0 * grid.resolution:g} cm"
    ax.set_xlabel(f"x' [{unit}]")
    ax.set_ylabel(f"y' [{unit}]")


def save_thesis_map(
    file: str | Path,
    grid: OccupancyGrid,
    *,
    start_pose_map: ArrayLike = (0.0, 0.0, 0.0),
    path: ArrayLike | None = None,
    obstacles_only: bool = True,
    title: str = "",
) -> None:
    """Save the picture of ``draw_thesis_map`` as png; the same map gives the same bytes.

    Raises:
        TestbedError: The folder cannot be written.
    """
    figure = Figure(layout="constrained")
    canvas = FigureCanvasAgg(figure)
    ax = figure.subplots()
    draw_thesis_map(
        ax, grid, start_pose_map=start_pose_map, path=path, obstacles_only=obstacles_only
    )
    (left, right), (bottom, top) = ax.get_xlim(), ax.get_ylim()
    inches = LONGEST_SIDE / max(right - left, top - bottom)
    width, height = inches * (right - left), inches * (top - bottom)
    figure.set_size_inches(max(width, LEAST_SIDE) + 0.9, max(height, LEAST_SIDE) + 0.8)
    figure.set_dpi(DPI)
    if title:
        figure.suptitle(title, fontsize=9, wrap=True)
    write_atomically(file, lambda out: canvas.print_png(out, metadata={"Software": None}))


def _box(grid: OccupancyGrid, drawn: NDArray[np.bool_], start: _Points) -> _Box:
    """Left, right, bottom and top of what is drawn, with a margin, in the thesis's cells."""
    rows, columns = np.flatnonzero(drawn.any(axis=1)), np.flatnonzero(drawn.any(axis=0))
    corners = np.array([start[:2]])
    if rows.size > 0:
        ends = [(row, column) for row in rows[[0, -1]] for column in columns[[0, -1]]]
        corners = grid.cell_to_world(ends)
    places = thesis_cells(corners, start, grid.resolution)
    margin = MARGIN / grid.resolution
    low, high = np.floor(places.min(axis=0) - margin), np.ceil(places.max(axis=0) + margin)
    return int(low[0]), int(high[0]), int(low[1]), int(high[1])


def _image(
    grid: OccupancyGrid, states: NDArray[np.int8], start: _Points, box: _Box, obstacles_only: bool
) -> tuple[NDArray[np.uint8], int]:
    """An RGB image ``(rows, columns, 3)`` of a box, and how many cells its pixels are wide."""
    left, right, bottom, top = box
    block = -(-max(right - left, top - bottom) // MAX_CELLS_DRAWN)
    shape = -(-(top - bottom) // block), -(-(right - left) // block)
    image = np.empty((*shape, 3), dtype=np.uint8)
    image[:] = _rgb(FREE_COLOUR)
    if not obstacles_only:
        image[_states_at(grid, states, start, box, block, shape) != FREE] = _rgb(UNKNOWN_COLOUR)
    centres = grid.cell_to_world(np.argwhere(states == OCCUPIED))
    cells = thesis_cells(centres, start, grid.resolution)
    columns, rows = np.floor((cells - (left, bottom)) / block).astype(np.int64).T
    image[rows, columns] = _rgb(OCCUPIED_COLOUR)
    return image, block


def _states_at(
    grid: OccupancyGrid,
    states: NDArray[np.int8],
    start: _Points,
    box: _Box,
    block: int,
    shape: tuple[int, int],
) -> NDArray[np.int8]:
    """The state of the map's cell under the centre of each pixel; UNKNOWN outside the map."""
    rows, columns = np.indices(shape)
    x = (box[0] + (columns + 0.5) * block) * grid.resolution - THESIS_START[0]
    y = (box[2] + (rows + 0.5) * block) * grid.resolution - THESIS_START[1]
    seen_from_start = np.column_stack((y.ravel(), -x.ravel()))
    cells = grid.world_to_cell(transform_points(start, seen_from_start))
    inside = grid.contains(cells)
    cells[~inside] = 0
    found = np.where(inside, states[cells[..., 0], cells[..., 1]], UNKNOWN)
    return np.asarray(found.reshape(shape), dtype=np.int8)


def _rgb(colour: str) -> list[int]:
    return list(bytes.fromhex(colour[1:]))
