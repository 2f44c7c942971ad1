"""The manoeuvre's looks around: what is near, and how close a pose comes to it."""

import numpy as np
from numba import njit
from numpy.typing import NDArray

from nav.cell_window_kernels import cells_around
from nav.outline import Rectangle


@njit(cache=True)
def bucket_points(
    points: NDArray[np.float64], left: float, bottom: float, size: float, count: int
) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """Sort points into ``count`` x ``count`` square buckets, row by row; those outside are dropped.

    Returns:
        The points ``(m, 2)`` in the order of their buckets, and where each bucket begins
        ``(count * count + 1,)``.
    """
    buckets = np.full(len(points), -1, dtype=np.int64)
    begins = np.zeros(count * count + 1, dtype=np.int64)
    for k in range(len(points)):
        column = int(np.floor((points[k, 0] - left) / size))
        row = int(np.floor((points[k, 1] - bottom) / size))
        if 0 <= row < count and 0 <= column < count:
            buckets[k] = row * count + column
            begins[buckets[k] + 1] += 1
    for bucket in range(count * count):
        begins[bucket + 1] += begins[bucket]
    ends = begins.copy()
    ordered = np.empty((begins[-1], 2))
    for k in range(len(points)):
        if buckets[k] >= 0:
            place = ends[buckets[k]]
            ordered[place, 0], ordered[place, 1] = points[k, 0], points[k, 1]
            ends[buckets[k]] += 1
    return ordered, begins


@njit(cache=True)
def gaps_at(
    ordered: NDArray[np.float64],
    begins: NDArray[np.int64],
    buckets: tuple[float, float, float, int],
    x: float,
    y: float,
    yaw: float,
    outline: tuple[Rectangle, Rectangle],
) -> tuple[float, float]:
    """Distance [m] from the robot's outline, and from its axle, to the nearest point.

    Distances are right up to a bucket's size; what is farther comes out as that size or more.

    Args:
        ordered: The points as ``bucket_points`` sorts them.
        begins: Where each bucket begins.
        buckets: Left and bottom edge of the first bucket, their size [m], and how many a side has.
        x: Of the axle's middle [m].
        y: The same.
        yaw: Heading [rad].
        outline: The rectangles that the robot consists of.
    """
    left, bottom, size, count = buckets
    cos, sin = np.cos(yaw), np.sin(yaw)
    column, row = int(np.floor((x - left) / size)), int(np.floor((y - bottom) / size))
    to_outline = to_axle = size * size
    for i in range(max(row - 1, 0), min(row + 2, count)):
        first, last = max(column - 1, 0), min(column + 1, count - 1)
        if first > last:
            continue
        for k in range(begins[i * count + first], begins[i * count + last + 1]):
            dx, dy = ordered[k, 0] - x, ordered[k, 1] - y
            ahead, aside = cos * dx + sin * dy, abs(cos * dy - sin * dx)
            to_axle = min(to_axle, dx * dx + dy * dy)
            for front, back, side in outline:
                out_x = max(ahead - front, -back - ahead, 0.0)
                out_y = max(aside - side, 0.0)
                to_outline = min(to_outline, out_x * out_x + out_y * out_y)
    return np.sqrt(to_outline), np.sqrt(to_axle)


@njit(cache=True)
def occupied_near(
    log_odds: NDArray[np.float32],
    lattice: tuple[float, float, float],
    occupied_above: float,
    x: float,
    y: float,
    reach: float,
) -> NDArray[np.float64]:
    """Centres ``(n, 2)`` of occupied cells with a neighbour that is not, within a square [m].

    Args:
        log_odds: The map ``[row, col]``.
        lattice: Its origin x, y and its resolution [m].
        occupied_above: Log odds above which a cell is occupied.
        x: Middle of the square [m].
        y: The same.
        reach: Half its side [m].
    """
    left, bottom, resolution = lattice
    rows, columns = log_odds.shape
    first_row, end_row, first_column, end_column = cells_around(
        log_odds.shape, lattice, x, y, reach
    )
    points = np.empty(((end_row - first_row) * (end_column - first_column), 2))
    count = 0
    for i in range(first_row, end_row):
        for j in range(first_column, end_column):
            if log_odds[i, j] <= occupied_above:
                continue
            is_inside = 0 < i < rows - 1 and 0 < j < columns - 1
            is_inside = is_inside and log_odds[i - 1, j] > occupied_above
            is_inside = is_inside and log_odds[i + 1, j] > occupied_above
            is_inside = is_inside and log_odds[i, j - 1] > occupied_above
            if is_inside and log_odds[i, j + 1] > occupied_above:
                continue
            points[count, 0] = left + (j + 0.5) * resolution
            points[count, 1] = bottom + (i + 0.5) * resolution
            count += 1
    return points[:count]


@njit(cache=True)
def worth_minding(
    cells: NDArray[np.float64], points: NDArray[np.float64], apart: float
) -> NDArray[np.bool_]:
    """Which cells ``(n, 2)`` lie farther than ``apart`` [m] from every point ``(m, 2)``."""
    keep = np.ones(len(cells), dtype=np.bool_)
    for k in range(len(cells)):
        for i in range(len(points)):
            dx, dy = cells[k, 0] - points[i, 0], cells[k, 1] - points[i, 1]
            if dx * dx + dy * dy < apart * apart:
                keep[k] = False
                break
    return keep
