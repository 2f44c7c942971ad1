"""Turn an occupancy map, a map_server yaml with its image, into a floor plan of few long boxes."""

from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

from envs.default_start import default_start
from envs.floor_plan import Box, FloorPlan, Point
from envs.rectangles import rectangles
from mapping.errors import TestbedError
from mapping.grid import FREE, OCCUPIED, UNKNOWN
from mapping.io.map_server import read_map

MAP_WALL_HEIGHT = 1.0
"""Height given to what a map shows [m]: a map tells none, and the lidar sees only that it is
higher than its plane."""


def read_map_plan(path: str | Path) -> FloorPlan:
    """The floor plan of a map_server yaml and its image; the start is chosen by ``default_start``.

    Raises:
        TestbedError: The yaml or the image cannot be used, or the map has no free place wide
            enough for the robot. The message names the file.
    """
    path = Path(path)
    found = read_map(path)
    try:
        return plan_from_states(
            found.states, resolution=found.resolution, origin=found.origin, name=path.stem
        )
    except TestbedError as error:
        raise TestbedError(f"{path}: {error}") from None


def plan_from_states(
    states: NDArray[np.int8],
    *,
    resolution: float,
    origin: Point,
    name: str,
    start: tuple[float, float, float] | None = None,
) -> FloorPlan:
    """The floor plan of a map's cells.

    Occupied cells are solid, single ones too. Unknown cells that touch free ones, at an edge or a
    corner, are solid as well, and so are the cells just outside the map where free cells reach its
    rim: they are not known to be drivable, and without them the robot would leave the known floor.
    The unknown beyond that shell stays empty.

    Args:
        states: UNKNOWN, FREE or OCCUPIED ``[row = y, col = x]``, row 0 at the origin.
        resolution: Edge of a cell [m].
        origin: Lower-left corner of cell (0, 0) [m].
        name: Name of the plan.
        start: Start pose x [m], y [m], yaw [rad]; None chooses one by ``default_start``.
    """
    framed = np.pad(states, 1, constant_values=UNKNOWN)
    origin = (origin[0] - resolution, origin[1] - resolution)
    free = framed == FREE
    if not free.any():
        raise TestbedError("the map has zero free area; it needs free cells for the robot to be on")
    beside_free = ndimage.binary_dilation(free, np.ones((3, 3), dtype=np.bool_))
    solid = (framed == OCCUPIED) | (beside_free & ~free)
    return FloorPlan(
        name=name,
        start=start or default_start(free, resolution=resolution, origin=origin),
        boxes=cell_boxes(solid, resolution=resolution, origin=origin, height=MAP_WALL_HEIGHT),
    )


def cell_boxes(
    solid: NDArray[np.bool_], *, resolution: float, origin: Point, height: float
) -> tuple[Box, ...]:
    """Few upright boxes that fill exactly the solid cells ``[row = y, col = x]``."""
    left, bottom = origin
    return tuple(
        Box(
            center=(
                left + 0.5 * (first_column + last_column) * resolution,
                bottom + 0.5 * (first_row + last_row) * resolution,
            ),
            size=((last_column - first_column) * resolution, (last_row - first_row) * resolution),
            height=height,
        )
        for first_row, last_row, first_column, last_column in rectangles(solid).tolist()
    )
