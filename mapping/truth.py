"""Turns a true raster of a place into what a robot can reach there and its lidar can see of it.

Scores compare a map with this, not with the whole raster: no robot maps the inside of a wall, or
a room that it cannot look into.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy import ndimage

from mapping.burger import LIDAR_RANGE_MAX, ROBOT_RADIUS
from mapping.errors import TestbedError
from mapping.visibility import near_obstacle, see_from

Mask = NDArray[np.bool_]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class TruthMap:
    """A raster of the truth ``[row = y, col = x]``, row 0 at the origin."""

    resolution: float
    """Edge of a cell [m]."""
    origin: tuple[float, float]
    """Lower-left corner of cell (0, 0) in the world frame [m]."""
    occupied: Mask
    """Cells inside a wall or a thing."""
    reachable: Mask
    """Cells where the robot's centre can be."""
    visible_free: Mask
    """Free cells that the sensor can see from some reachable cell."""
    visible_surface: Mask
    """Occupied cells that share an edge with a visible free cell."""

    @property
    def shape(self) -> tuple[int, int]:
        """Rows and columns."""
        rows, columns = self.occupied.shape
        return rows, columns


def truth_map(
    occupied: NDArray[np.bool_],
    *,
    resolution: float,
    origin: tuple[float, float],
    start: ArrayLike | None,
    robot_radius: float = ROBOT_RADIUS,
    sensor_range: float = LIDAR_RANGE_MAX,
    unknown: NDArray[np.bool_] | None = None,
) -> TruthMap:
    """Find what a round robot can reach from its start and what its lidar can see from there.

    The robot's centre fits in a free cell whose centre is ``robot_radius`` or more away from
    every occupied cell's nearest edge; it reaches those connected by edges with the start's cell.
    A free cell is seen when a beam from the centre of a reachable cell crosses it within
    ``sensor_range``; the beams of a cell lie one cell apart at that range. The lidar is taken to
    stand at the robot's centre: what 3 cm to the side would show is below what the scores tell.

    Args:
        occupied: Whether a cell is wall ``(rows, columns)``.
        resolution: Edge of a cell [m].
        origin: Lower-left corner of cell (0, 0) [m].
        start: The robot's first position x, y [m] (more entries, as a yaw, are ignored); None
            takes every place where the robot fits.
        robot_radius: Radius of the robot [m].
        sensor_range: How far the sensor sees [m].
        unknown: Cells of which the truth knows nothing, when it is itself a map ``(rows,
            columns)``: they stop the robot and the beams, and are neither free nor wall.

    Raises:
        TestbedError: The start lies outside the raster, in a wall, or where the robot does not fit.
    """
    blocked = np.ascontiguousarray(occupied, dtype=np.bool_)
    if unknown is not None:
        blocked = blocked | unknown
    fits = ~(blocked | near_obstacle(blocked, robot_radius / resolution))
    reachable = _reachable(fits, blocked, resolution, origin, start)
    visible_free = see_from(reachable, blocked, sensor_range / resolution)
    surface = ndimage.binary_dilation(visible_free) & occupied
    return TruthMap(
        resolution=resolution,
        origin=origin,
        occupied=np.array(occupied, dtype=np.bool_),
        reachable=reachable,
        visible_free=visible_free,
        visible_surface=surface,
    )


def _reachable(
    fits: Mask,
    blocked: Mask,
    resolution: float,
    origin: tuple[float, float],
    start: ArrayLike | None,
) -> Mask:
    """The cells where the robot fits that share edges, one after another, with the start's."""
    if start is None:
        return fits
    x, y = (float(value) for value in np.asarray(start, dtype=np.float64)[:2])
    told = f"start: ({x:g}, {y:g}) m"
    if not (np.isfinite(x) and np.isfinite(y)):
        raise TestbedError(f"{told}; must be finite")
    row = int(np.floor((y - origin[1]) / resolution))
    column = int(np.floor((x - origin[0]) / resolution))
    rows, columns = fits.shape
    if not (0 <= row < rows and 0 <= column < columns):
        raise TestbedError(f"{told}; must lie inside the map")
    if blocked[row, column]:
        raise TestbedError(f"{told} lies inside a wall or a thing; must be free floor")
    if not fits[row, column]:
        raise TestbedError(f"{told} is too close to a wall; must leave the robot's radius free")
    labels, _ = ndimage.label(fits)
    return np.asarray(labels == labels[row, column])
