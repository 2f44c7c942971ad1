"""Tells whether a map that was written is read back, cell by cell, by others than the testbed.

This reader shares no code with ``mapping.io.map_server``: PyYAML, Pillow and the rules of ROS's
map_server, as its wiki has them (section 3, trinary), are all it knows. A mistake that writer and
reader of the testbed had in common would show here.
"""

from pathlib import Path

import numpy as np
import yaml
from numpy.typing import NDArray
from PIL import Image

from mapping.grid import FREE, OCCUPIED, UNKNOWN, OccupancyGrid

LATTICE_TOLERANCE = 1e-3
"""Part of a cell by which the file's cells may lie off the map's: rounding of the origin."""


def map_reloads(path: Path, grid: OccupancyGrid) -> bool:
    """Whether a map file says of every cell what the map says, and knows nothing more.

    Args:
        path: The yaml of a map_server map.
        grid: The map that it was written from.
    """
    try:
        states, origin, resolution = _read(path)
    except (OSError, ValueError, KeyError, TypeError, yaml.YAMLError):
        return False
    if not np.isclose(resolution, grid.resolution, rtol=1e-9, atol=0.0):
        return False
    shift = (origin - grid.origin) / grid.resolution
    if np.abs(shift - np.rint(shift)).max() > LATTICE_TOLERANCE:
        return False
    column, row = (int(cells) for cells in np.rint(shift))
    here, there = grid.states(), states
    rows = _overlap(row, here.shape[0], there.shape[0])
    columns = _overlap(column, here.shape[1], there.shape[1])
    shared_here, shared_there = here[rows[0], columns[0]], there[rows[1], columns[1]]
    return (
        np.array_equal(shared_here, shared_there)
        and _known(here) == _known(shared_here)
        and _known(there) == _known(shared_there)
    )


def _read(path: Path) -> tuple[NDArray[np.int8], NDArray[np.float64], float]:
    """States ``[row = y, col = x]``, origin ``(2,)`` [m] and resolution [m] of a map file."""
    fields = yaml.safe_load(path.read_text(encoding="utf-8"))
    with Image.open(path.parent / fields["image"]) as image:
        greys = np.asarray(image.convert("L"), dtype=np.uint8)[::-1]
    shades = np.arange(256) / 255.0
    occupancy = shades if fields["negate"] else 1.0 - shades
    meaning = np.full(256, UNKNOWN, dtype=np.int8)
    meaning[occupancy > fields["occupied_thresh"]] = OCCUPIED
    meaning[occupancy < fields["free_thresh"]] = FREE
    x, y, _ = fields["origin"]
    return meaning[greys], np.array([x, y], dtype=np.float64), float(fields["resolution"])


def _overlap(shift: int, here: int, there: int) -> tuple[slice, slice]:
    """The cells that two lines share, in the one's count and in that of the other.

    Args:
        shift: Where the other's first cell lies in the one.
        here: Cells of the one.
        there: Cells of the other.
    """
    first, last = max(shift, 0), max(min(shift + there, here), max(shift, 0))
    return slice(first, last), slice(first - shift, last - shift)


def _known(states: NDArray[np.int8]) -> int:
    return int(np.count_nonzero(states != UNKNOWN))
