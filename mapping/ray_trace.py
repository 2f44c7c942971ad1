"""Kernel of the thesis's mapper: beams drawn into log odds, cell by cell along their major axis."""

import numpy as np
from numba import njit
from numpy.typing import NDArray

NEAR_CELLS = 2
"""Traversed cells next to a hit that are cleared with less weight (thesis 4.3.5)."""


@njit(cache=True)
def trace_beams(
    log_odds: NDArray[np.float32],
    start: NDArray[np.float64],
    directions: NDArray[np.float64],
    lengths: NDArray[np.float64],
    hits: NDArray[np.bool_],
    occupied: np.float32,
    free: np.float32,
) -> None:
    """Update ``log_odds`` in place with the beams of one scan; cells outside are left out.

    A beam's cells are those on the line from the exact start to the centre of its end cell, one
    for each step along the axis that its direction is nearer to (thesis 4.3.5: Bresenham). The
    start's cell is the first. Of a beam that hit, the end cell gains ``occupied`` and the cells
    before it lose ``free``, the last NEAR_CELLS of them only ``occupied``; of a beam that did not,
    every cell, the end cell too, loses ``free``.

    Args:
        log_odds: The grid ``(rows, columns)``.
        start: Where the sensor is: x, y in cells from the grid's corner ``(2,)``.
        directions: Unit vectors x, y of the beams ``(n, 2)``.
        lengths: Lengths of the beams in cells ``(n,)``.
        hits: Whether a beam ends at an obstacle ``(n,)``.
        occupied: Log odds that one hit tells.
        free: Log odds, as a positive number, that one passing beam tells.
    """
    for beam in range(len(lengths)):
        end_x = start[0] + lengths[beam] * directions[beam, 0]
        end_y = start[1] + lengths[beam] * directions[beam, 1]
        along_x = abs(directions[beam, 0]) >= abs(directions[beam, 1])
        if along_x:
            _trace(log_odds.T, start[0], start[1], end_x, end_y, hits[beam], occupied, free)
        else:
            _trace(log_odds, start[1], start[0], end_y, end_x, hits[beam], occupied, free)


@njit(cache=True)
def _trace(
    cells: NDArray[np.float32],
    start_major: float,
    start_minor: float,
    end_major: float,
    end_minor: float,
    hit: bool,
    occupied: np.float32,
    free: np.float32,
) -> None:
    """Update the cells ``[major, minor]`` of one beam."""
    first, last = int(np.floor(start_major)), int(np.floor(end_major))
    last_minor = int(np.floor(end_minor))
    steps = abs(last - first)
    sign = 1 if last >= first else -1
    rise = (last_minor + 0.5 - start_minor) / (last + 0.5 - start_major) if steps > 0 else 0.0
    minor = start_minor + (first + 0.5 - start_major) * rise
    rise *= sign
    near = steps - NEAR_CELLS if hit else steps
    inside = _holds(cells, first, start_minor, minor) and _holds(cells, last, end_minor, end_minor)
    if inside:  # no step can leave the grid, so none is checked
        for step in range(near):
            cells[first + sign * step, int(minor + step * rise)] -= free
    for step in range(max(near, 0) if inside else 0, steps):
        major, column = first + sign * step, int(np.floor(minor + step * rise))
        if inside or _holds(cells, major, column, column):
            cells[major, column] -= free if step < near else occupied
    if inside or _holds(cells, last, last_minor, last_minor):
        cells[last, last_minor] += occupied if hit else -free


@njit(cache=True)
def _holds(cells: NDArray[np.float32], major: int, low: float, high: float) -> bool:
    """Whether a row of cells exists and holds two positions."""
    rows, columns = cells.shape
    return bool(0 <= major < rows and min(low, high) >= 0.0 and max(low, high) < columns)
