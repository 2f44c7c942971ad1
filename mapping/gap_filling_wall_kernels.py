"""Kernels of gap filling: the ends of straight walls, and lines that draw them on over the unknown.

As in ``gap_filling_kernels``, neither the order of cells nor which way is up matters.
"""

import numpy as np
from numba import njit
from numpy.typing import NDArray

from mapping.gap_filling_hole_kernels import all_unknown, rim_of, steps_of_wall
from mapping.gap_filling_kernels import Lines, States
from mapping.grid import FREE, OCCUPIED, UNKNOWN

BESIDE = 0.75
"""A cell beside another is farther on, or less far, by less than this, in cells: cells that touch
across a direction of 45 degrees differ by 0.71."""


@njit(cache=True)
def wall_ends(
    states: States, reach: int, share: float, roughness: float, needed: int
) -> NDArray[np.float64]:
    """Where straight walls end: ``(n, 4)`` as row, column and the direction on, a unit vector.

    An occupied cell beside an unknown one is a wall's end if those within ``reach`` around it lie
    behind it, on average at least ``share`` of ``reach``, and scatter about their line by
    ``roughness`` cells at most. The line is that of least squares of distances (total least
    squares). In ``needed`` of ``reach`` steps back along it there must be a cell of the wall.
    """
    rows, columns = states.shape
    rim = rim_of(states)
    found = [(0.0, 0.0, 0.0, 0.0)]
    for row in range(rows):
        for column in range(columns):
            if not rim[row, column]:
                continue
            count, y, x, yy, xx, yx = 0, 0, 0, 0, 0, 0
            for other in range(max(row - reach, 0), min(row + reach + 1, rows)):
                for aside in range(max(column - reach, 0), min(column + reach + 1, columns)):
                    rise, run = other - row, aside - column
                    if states[other, aside] != OCCUPIED or rise**2 + run**2 > reach**2:
                        continue
                    count, y, x = count + 1, y + rise, x + run
                    yy, xx, yx = yy + rise * rise, xx + run * run, yx + rise * run
            if y * y + x * x < (share * reach * count) ** 2 or count < needed:
                continue
            rise, run, spread = _axis(yy * count - y * y, xx * count - x * x, yx * count - y * x)
            if spread > (roughness * count) ** 2:
                continue
            if rise * y + run * x > 0.0:
                rise, run = -rise, -run
            if steps_of_wall(states, row, column, -rise, -run, reach, 2.0 * roughness) >= needed:
                found.append((float(row), float(column), rise, run))
    return np.array(found)[1:]


@njit(cache=True)
def _axis(yy: float, xx: float, yx: float) -> tuple[float, float, float]:
    """The longer axis of a scatter, a unit vector, and the scatter across it."""
    root = np.sqrt(float(yy - xx) ** 2 + 4.0 * float(yx) ** 2)
    rise = (yy - xx) + root if yy >= xx else 2.0 * yx
    run = 2.0 * yx if yy >= xx else (xx - yy) + root
    length = np.hypot(rise, run)
    if length == 0.0:
        return 0.0, 0.0, np.inf
    return rise / length, run / length, (yy + xx - root) / 2.0


@njit(cache=True)
def extended(
    states: States, ends: NDArray[np.float64], reach: int, sure: int
) -> tuple[Lines, NDArray[np.int64]]:
    """Ends of walls drawn out over unknown cells, to the first occupied ones.

    Args:
        states: UNKNOWN, FREE or OCCUPIED.
        ends: Ends of walls ``(n, 4)``, of ``wall_ends``.
        reach: How many steps they are drawn out at most.
        sure: From so many steps on, their direction is not sure to a cell: what lies beside the way
            is met too.

    Returns:
        The lines to those that were met ``(m, 4)``, and for each end ``(n,)`` how many unknown
        cells follow it, or 0 where something was met.
    """
    rows, columns = states.shape
    found = [(0, 0, 0, 0)]
    room = np.zeros(len(ends), dtype=np.int64)
    for index in range(len(ends)):
        row, column = int(ends[index, 0]), int(ends[index, 1])
        for step in range(1, reach + 1):
            other = row + int(np.rint(step * ends[index, 2]))
            aside = column + int(np.rint(step * ends[index, 3]))
            if not (0 <= other < rows and 0 <= aside < columns) or states[other, aside] == FREE:
                break
            if states[other, aside] == OCCUPIED:
                room[index] = 0
                if all_unknown(states, row, column, other, aside):
                    found.append((row, column, other, aside))
                break
            if step >= sure and _meets_beside(states, ends[index], step, other, aside, found):
                room[index] = 0
                break
            room[index] = step
    return np.array(found, dtype=np.int64)[1:], room


@njit(cache=True)
def _meets_beside(
    states: States,
    end: NDArray[np.float64],
    step: int,
    row: int,
    column: int,
    found: list[tuple[int, int, int, int]],
) -> bool:
    """Whether lines lead to occupied cells beside the one so many steps on; adds those lines."""
    start_row, start_column = int(end[0]), int(end[1])
    before = len(found)
    for other in range(max(row - 1, 0), min(row + 2, states.shape[0])):
        for aside in range(max(column - 1, 0), min(column + 2, states.shape[1])):
            on = (other - start_row) * end[2] + (aside - start_column) * end[3]
            if states[other, aside] != OCCUPIED or abs(on - step) >= BESIDE:
                continue
            if all_unknown(states, start_row, start_column, other, aside):
                found.append((start_row, start_column, other, aside))
    return len(found) > before


@njit(cache=True)
def corners(
    states: States,
    ends: NDArray[np.float64],
    room: NDArray[np.int64],
    most_cosine: float,
) -> Lines:
    """Pairs of lines that draw two walls out to the corner where they meet, across unknown cells.

    Args:
        states: UNKNOWN, FREE or OCCUPIED.
        ends: Ends of walls ``(n, 4)``, of ``wall_ends``.
        room: How far each may be drawn out ``(n,)``, of ``extended``.
        most_cosine: Two walls make a corner if the cosine between their directions is at most this.

    Returns:
        Lines ``(2m, 4)`` that end in the corner's cell, two in turn for each corner.
    """
    found = [(0, 0, 0, 0)]
    for one in range(len(ends)):
        for two in range(one):
            if room[one] == 0 or room[two] == 0:
                continue
            down, across = ends[two, 0] - ends[one, 0], ends[two, 1] - ends[one, 1]
            if max(abs(down), abs(across)) > room[one] + room[two]:
                continue
            cosine = ends[one, 2] * ends[two, 2] + ends[one, 3] * ends[two, 3]
            sine = ends[one, 3] * ends[two, 2] - ends[one, 2] * ends[two, 3]
            if abs(cosine) > most_cosine:
                continue
            out_one = (across * ends[two, 2] - down * ends[two, 3]) / sine
            out_two = (across * ends[one, 2] - down * ends[one, 3]) / sine
            if not (0.0 < out_one <= room[one] and 0.0 < out_two <= room[two]):
                continue
            row = int(ends[one, 0]) + int(np.rint(out_one * ends[one, 2]))
            column = int(ends[one, 1]) + int(np.rint(out_one * ends[one, 3]))
            if states[row, column] != UNKNOWN:
                continue
            start, end = ends[one].astype(np.int64), ends[two].astype(np.int64)
            if all_unknown(states, start[0], start[1], row, column) and all_unknown(
                states, end[0], end[1], row, column
            ):
                found.append((start[0], start[1], row, column))
                found.append((end[0], end[1], row, column))
    return np.array(found, dtype=np.int64)[1:]
