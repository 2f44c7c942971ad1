"""Kernels that measure how far before a surface the cells of a band lie, scan after scan.

Cells look for their reading, not readings for their cells, as in KinectFusion (Newcombe et al.
2011): so a scan measures each cell once, however dense its beams are there.
"""

import math

import numpy as np
from numba import njit
from numpy.typing import NDArray

from mapping.scan_polygon import AGREE, APART

X, Y, DX, DY, LENGTH, SIGMA, HIT, PAIR = range(8)
"""Columns of a table of beams, in cells: where each starts, its unit vector, its length and that
length's standard deviation, whether it met something there (1 or 0), and how it and the next go
together, of ``compare_neighbours``. Beams are in counter-clockwise order."""

COLUMNS = 8
"""How many there are."""

BINS = 1440
"""Directions that beams are looked up by: four for each beam of a lidar with one a degree."""

WIDEST_GAP = BINS // 8
"""Where beams failed between two, in a narrower gap than this, cells are looked up all the same:
seen from where another beam was shot they may lie beside the gap."""

STEPS = 24
"""A cell's beam is sought among so many to one side of the one looked up: beams start apart while
the robot moves. A Burger moves 2 cm in half a turn of its lidar, 10 beams at 12 cm."""

NEAR = 50.0
"""Nearer than so many cells a beam from elsewhere may come from any direction."""

NONE = -1


@njit(cache=True)
def add_distances(
    cells: NDArray[np.int32],
    starts: NDArray[np.int64],
    tile: int,
    tile_shape: tuple[int, int],
    sums: NDArray[np.float32],
    beams: NDArray[np.float64],
    reach: tuple[float, float],
) -> None:
    """Add what one scan tells of the cells around it.

    A cell lies between two beams. If they saw one surface, the reading in the cell's direction is
    interpolated, exactly so on a straight wall; else the nearer beam tells. Its length less the
    cell's distance is how far the cell lies before the surface. That counts by the reading's
    inverse variance, and no more than the reading's reach. A cell farther behind than that is not
    seen, and a beam without a return tells nothing but that all until there is free.

    Args:
        cells: The band's cells ``(m, 2)`` as (row, column), tile by tile.
        starts: Where each tile's cells begin ``(tiles + 1,)``, row by row of tiles.
        tile: Edge of a tile in cells.
        tile_shape: Rows and columns of tiles.
        sums: How many scans told, and the sums of their weights and of weights times distances
            [cells] ``(m, 3)``; added to.
        beams: The scan ``(n, COLUMNS)``, n >= 1.
        reach: A reading tells of cells within so many cells of it, plus so many of its standard
            deviations.
    """
    table = beams_by_direction(beams)
    told = _told_of(beams, reach)
    farthest = told.max()
    middle_x, middle_y = beams[len(beams) // 2, X], beams[len(beams) // 2, Y]
    bottom = max(math.floor((middle_y - farthest) / tile), 0)
    top = min(math.floor((middle_y + farthest) / tile) + 1, tile_shape[0])
    left = max(math.floor((middle_x - farthest) / tile), 0)
    right = min(math.floor((middle_x + farthest) / tile) + 1, tile_shape[1])
    for tile_row in range(bottom, top):
        if left >= right:
            break
        first = starts[tile_row * tile_shape[1] + left]
        for k in range(first, starts[tile_row * tile_shape[1] + right]):
            x, y = cells[k, 1] + 0.5, cells[k, 0] + 0.5
            dx, dy = x - middle_x, y - middle_y
            away = dx * dx + dy * dy
            if away > NEAR * NEAR and away > told[_bin(dx, dy)] ** 2:
                continue  # most cells of a building lie behind what the scan saw
            i = beam_before(x, y, beams, table)
            if i == NONE:
                continue
            before, sigma, is_hit = distance_before(x, y, i, beams)
            bound = reach[0] + reach[1] * sigma
            if before >= bound or (is_hit and before >= -bound):
                weight = 1.0 / (sigma * sigma)
                sums[k, 0] += 1.0
                sums[k, 1] += weight
                sums[k, 2] += weight * min(before, bound)


@njit(cache=True)
def beams_by_direction(beams: NDArray[np.float64]) -> NDArray[np.int32]:
    """For each of BINS directions the beam before it ``(BINS,)``, NONE where a lidar does not look.

    Args:
        beams: The scan ``(n, COLUMNS)``.
    """
    table = np.full(BINS, NONE, dtype=np.int32)
    for i in range(len(beams)):
        after = i + 1 if i + 1 < len(beams) else 0
        k, last = _bin(beams[i, DX], beams[i, DY]), _bin(beams[after, DX], beams[after, DY])
        if beams[i, PAIR] != APART or (last - k) % BINS < WIDEST_GAP:
            table[k] = i
            while k != last:
                k = k + 1 if k + 1 < BINS else 0
                table[k] = i
    return table


@njit(cache=True)
def _told_of(beams: NDArray[np.float64], reach: tuple[float, float]) -> NDArray[np.float64]:
    """How far from where the middle beam starts a scan tells of cells, at most ``(BINS,)``.

    For cells farther away than ``NEAR``, in each direction; 0 where the lidar does not look. Beams
    start apart, so one of a direction beside it may be a cell's.
    """
    middle = len(beams) // 2
    apart = 0.0
    for i in range(len(beams)):
        dx, dy = beams[i, X] - beams[middle, X], beams[i, Y] - beams[middle, Y]
        apart = max(apart, math.hypot(dx, dy))
    own = np.zeros(BINS)
    for i in range(len(beams)):
        after = i + 1 if i + 1 < len(beams) else 0
        k, last = _bin(beams[i, DX], beams[i, DY]), _bin(beams[after, DX], beams[after, DY])
        sigma = max(beams[i, SIGMA], beams[after, SIGMA])
        bound = max(beams[i, LENGTH], beams[after, LENGTH]) + reach[0] + reach[1] * sigma + apart
        own[k] = max(own[k], bound)
        if beams[i, PAIR] != APART or (last - k) % BINS < WIDEST_GAP:
            while k != last:
                k = k + 1 if k + 1 < BINS else 0
                own[k] = max(own[k], bound)
    turned = math.asin(min(apart / NEAR, 1.0))  # a bin is a radian's 1 / (BINS / 4), or wider
    beside = min(int(turned * BINS / 4) + 2, BINS // 2)
    told = own.copy()
    for shift in range(1, beside + 1):
        for k in range(BINS):
            told[k] = max(told[k], max(own[k - shift], own[k + shift - BINS]))
    return told


@njit(cache=True)
def beam_before(x: float, y: float, beams: NDArray[np.float64], table: NDArray[np.int32]) -> int:
    """The beam that has a point on its left, or on it, and the next beam on its right; or NONE.

    Args:
        x: The point, in cells.
        y: The same.
        beams: The scan ``(n, COLUMNS)``.
        table: Its beams by direction.
    """
    middle = len(beams) // 2
    i = table[_bin(x - beams[middle, X], y - beams[middle, Y])]
    if i == NONE:
        return NONE
    for _ in range(STEPS):
        after = i + 1 if i + 1 < len(beams) else 0
        if _left_of(x, y, i, beams) < 0.0:
            i = i - 1 if i > 0 else len(beams) - 1
        elif _left_of(x, y, after, beams) >= 0.0:
            i = after
        else:
            return int(i)
    return NONE


@njit(cache=True)
def distance_before(
    x: float, y: float, i: int, beams: NDArray[np.float64]
) -> tuple[float, float, bool]:
    """How far before what was seen a point lies, between beam ``i`` and the next.

    Returns:
        The distance along a beam through the point, the standard deviation of the reading that it
        goes by, and whether that reading met something; ``-inf`` where there is no such beam.
    """
    j = i + 1 if i + 1 < len(beams) else 0
    along_i = beams[i, DX] * (x - beams[i, X]) + beams[i, DY] * (y - beams[i, Y])
    along_j = beams[j, DX] * (x - beams[j, X]) + beams[j, DY] * (y - beams[j, Y])
    if beams[i, PAIR] == APART or along_i <= 0.0 or along_j <= 0.0:
        return -math.inf, 1.0, False
    left, right = _left_of(x, y, i, beams), -_left_of(x, y, j, beams)
    share = left / (left + right)
    if beams[i, PAIR] == AGREE:
        length = 1.0 / ((1.0 - share) / beams[i, LENGTH] + share / beams[j, LENGTH])
        sigma = (1.0 - share) * beams[i, SIGMA] + share * beams[j, SIGMA]
        along = (1.0 - share) * along_i + share * along_j
        return length - along, sigma, beams[i, HIT] != 0.0
    if share < 0.5:
        return beams[i, LENGTH] - along_i, beams[i, SIGMA], beams[i, HIT] != 0.0
    return beams[j, LENGTH] - along_j, beams[j, SIGMA], beams[j, HIT] != 0.0


@njit(cache=True)
def _left_of(x: float, y: float, i: int, beams: NDArray[np.float64]) -> float:
    """How far left of a beam a point lies."""
    return float(beams[i, DX] * (y - beams[i, Y]) - beams[i, DY] * (x - beams[i, X]))


@njit(cache=True)
def _bin(dx: float, dy: float) -> int:
    """The bin of a direction: counter-clockwise, evenly spaced on a diamond, which needs no arc."""
    size = abs(dx) + abs(dy)
    if size == 0.0:
        return 0
    quarter = 1.0 - dx / size if dy >= 0.0 else 3.0 + dx / size
    return min(int(quarter * (BINS // 4)), BINS - 1)
