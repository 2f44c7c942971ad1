"""Choose a start pose in a plan that names none: in the widest place of the largest floor."""

import math

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

from mapping.burger import ROBOT_RADIUS
from mapping.errors import TestbedError

_DIRECTIONS = 360
"""Directions tried for the heading, one a degree like the lidar's beams."""


def default_start(
    free: NDArray[np.bool_], *, resolution: float, origin: tuple[float, float]
) -> tuple[float, float, float]:
    """The middle of the widest place, facing the longest free line.

    Of the floors that the robot can drive on without leaving, the largest is taken, and there the
    cell farthest from everything that is not free: the pole of inaccessibility on the raster. Of
    equal cells the first in rows from the origin on is taken, of equal directions the first from
    +x counter-clockwise, so that the same raster always gives the same pose.

    Args:
        free: Cells ``[row = y, col = x]`` that may be driven on; what lies outside may not.
        resolution: Edge of a cell [m].
        origin: Lower-left corner of cell (0, 0) [m].

    Returns:
        x [m], y [m], yaw [rad] in (-pi, pi].

    Raises:
        TestbedError: No free place is wide enough for the robot.
    """
    walled = np.pad(free, 1)
    clearances = ndimage.distance_transform_edt(walled)[1:-1, 1:-1]
    # Measured from centre to centre; a cell's corner is up to half a diagonal nearer.
    clearances = (np.asarray(clearances) - math.sqrt(0.5)) * resolution
    labels, count = ndimage.label(clearances >= ROBOT_RADIUS)
    if count == 0:
        raise TestbedError(
            "start: none found; the widest free place has a clearance of "
            f"{max(float(clearances.max()), 0.0):.3f} m, and the robot needs {ROBOT_RADIUS} m"
        )
    largest = labels == 1 + np.argmax(np.bincount(labels.ravel())[1:])
    row, column = np.unravel_index(np.argmax(np.where(largest, clearances, 0.0)), free.shape)
    yaw = _longest_line(walled, int(row) + 1, int(column) + 1)
    x = origin[0] + (float(column) + 0.5) * resolution
    y = origin[1] + (float(row) + 0.5) * resolution
    return x, y, yaw


def _longest_line(free: NDArray[np.bool_], row: int, column: int) -> float:
    """Direction [rad] in which the line from a cell's centre stays on free cells longest.

    The raster's rim must not be free, so that every line ends.
    """
    yaws = np.arange(_DIRECTIONS) * (2.0 * math.pi / _DIRECTIONS)
    steps = np.arange(0.0, math.hypot(*free.shape), 0.5)  # half cells: no cell is jumped over
    rows = np.rint(row + np.outer(np.sin(yaws), steps)).astype(np.int64)
    columns = np.rint(column + np.outer(np.cos(yaws), steps)).astype(np.int64)
    np.clip(rows, 0, free.shape[0] - 1, out=rows)
    np.clip(columns, 0, free.shape[1] - 1, out=columns)
    yaw = float(yaws[np.argmax(np.argmin(free[rows, columns], axis=1))])
    return yaw if yaw <= math.pi else yaw - 2.0 * math.pi
