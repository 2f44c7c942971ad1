"""Keeps gap filling from closing passages: drops the lines that part places of the robot's."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

from mapping.gap_filling_kernels import Lines, Mask, States, draw_lines
from mapping.gap_filling_passage_kernels import closing_lines
from mapping.grid import FREE, OCCUPIED
from mapping.visibility import near_obstacle

ROBOT_WIDTH = 0.178
"""The Burger's width [m] (thesis 2.1.1 and 5.1): it goes through what is wider."""

SIDE_DEPTH = 0.2
"""A way across a line is looked at so far to both sides of it [m]: farther than the robot is wide,
so that it has wholly crossed the line."""

ROUNDING_CELLS = 0.5
"""A passage as wide as the robot may have its middle on the edge of two cells; the robot is taken
to be this much thinner, so that it still fits: rather one gap too many is left open."""

EIGHT = np.ones((3, 3), dtype=np.bool_)
"""A cell and its eight neighbours."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Floor:
    """Where the robot's centre fits on a map, as far as what is known goes."""

    radius: float
    """Radius that the robot is taken to have, in cells."""
    depth: float
    """``SIDE_DEPTH`` in cells."""
    occupied: Mask
    """What stands there."""
    fits: Mask
    """The robot fits here, if the unknown is open."""
    places: Mask
    """It is known to fit here: all that it would cover is free."""


def floor_of(states: States, resolution: float) -> Floor:
    """The floor of a map of states with cells of ``resolution`` [m]."""
    radius = max(0.5 * ROBOT_WIDTH / resolution - ROUNDING_CELLS, ROUNDING_CELLS)
    occupied = states == OCCUPIED
    return Floor(
        radius=radius,
        depth=SIDE_DEPTH / resolution,
        occupied=occupied,
        fits=_fits(occupied, radius),
        places=_fits(states != FREE, radius),
    )


def that_close_nothing(lines: Lines, floor: Floor, together: int = 1) -> Lines:
    """The lines ``(n, 4)`` that may be drawn, one with another, without closing a passage.

    Lines that each part two places known to be free go first; then, if those that are left part
    places together, all that pass where the robot now can no longer get through. Which are dropped
    depends neither on their order nor on which way is up.

    Args:
        lines: From cell to cell.
        floor: The map's.
        together: So many lines in turn stand and fall together.
    """
    closes = closing_lines(lines, floor.fits, floor.places, floor.radius, floor.depth)
    closes = closes.reshape(-1, together).any(axis=1)
    while not closes.all():
        drawn = lines.reshape(-1, together, 4)[~closes].reshape(-1, 4)
        lost = _lost_ways(drawn, floor)
        if not lost.any():
            return np.asarray(drawn)
        for index in np.flatnonzero(~closes):
            ways = np.zeros_like(lost)
            draw_lines(lines[index * together : (index + 1) * together], ways)
            closes[index] = bool(np.any(ways & lost))
    return lines[:0]


def _lost_ways(lines: Lines, floor: Floor) -> Mask:
    """Cells around which lines, drawn together, part places that were connected; else none."""
    drawn = floor.occupied.copy()
    draw_lines(lines, drawn)
    fits = floor.fits & _fits(drawn, floor.radius)
    before, _ = ndimage.label(floor.fits)
    after, pieces = ndimage.label(fits)
    places = floor.places & fits
    came_from = np.zeros(pieces + 1, dtype=np.int64)
    came_from[after[places]] = before[places]  # what is left of a piece lies in that piece
    parted = np.bincount(came_from)[came_from] > 1
    parted[came_from == 0] = False
    if not parted.any():
        return np.zeros_like(drawn)
    kept = np.where(parted[after], after, 0)
    was_whole = np.isin(before, came_from[parted])
    blobs, number = ndimage.label(was_whole & (kept == 0), EIGHT)
    boxes = ndimage.find_objects(blobs)
    parting = [
        blob
        for blob in range(1, number + 1)
        if _parts(np.asarray(blobs), blob, boxes[blob - 1], kept)
    ]
    return np.asarray(~_fits(np.isin(blobs, parting) & ~fits, floor.radius + 1.0))


def _parts(
    blobs: NDArray[np.signedinteger], blob: int, box: tuple[slice, ...], kept: NDArray[np.int64]
) -> bool:
    """Whether a blob of lost cells lies between two pieces, or more, of what is kept."""
    rows, columns = (slice(max(side.start - 1, 0), side.stop + 1) for side in box)
    beside = ndimage.binary_dilation(blobs[rows, columns] == blob, EIGHT)
    pieces = kept[rows, columns][np.asarray(beside)]
    return len(np.unique(pieces[pieces > 0])) > 1


def _fits(blocked: Mask, radius: float) -> NDArray[np.bool_]:
    """Cells whose centre is ``radius`` cells or more from the edge of every blocked cell."""
    return np.asarray(~(blocked | near_obstacle(blocked, radius)))
