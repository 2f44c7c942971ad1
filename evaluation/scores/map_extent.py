"""Turns a map and the truth into the error of the map's length: what drift along a corridor does.

The length is that between the two end walls, along the longer axis of what is visible of the place.
Walls are told by their profile: how many wall cells lie at each position along that axis. An end
wall that stands across the axis is a peak in it. Each end of the truth's profile is slid over the
map's, and the shift where they agree best is how far that end of the map is off; the difference of
the two shifts, over the true length, is the error. A wall that is drawn thick, or turned a little,
is found by its middle.
"""

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

from mapping.coverage import ROUNDING
from mapping.grid import OccupancyGrid
from mapping.truth import TruthMap

END_DEPTH = 0.5
"""How much of the truth, from the outermost visible wall inwards, makes an end [m]."""

SEARCHED_SHARE, LEAST_SEARCHED = 0.05, 0.15
"""An end is looked for within so much of the true length, and within so much at least [m]; a map
that is off by more has no length that could be told."""

BLUR = 0.03
"""Standard deviation of the blur of both profiles [m]: the spread of the LDS-01's readings at
1 m (3.5 % of the range, ROBOTIS e-manual)."""

LEAST_AGREEMENT = 0.5
"""An end is found when the map has this share of its wall at least."""

_Profile = NDArray[np.float64]


def map_length_error(grid: OccupancyGrid, truth: TruthMap) -> float | None:
    """The relative error of the map's length, 0 or more; accurate to a cell.

    Args:
        grid: The map.
        truth: What it is a map of, in the same frame.

    Returns:
        None when the truth has no visible wall, or an end of it is not found in the map.
    """
    rows, columns = np.nonzero(truth.visible_surface)
    if len(rows) == 0:
        return None
    axis = 0 if np.ptp(columns) >= np.ptp(rows) else 1
    cells = columns if axis == 0 else rows
    length = float(np.ptp(cells) * truth.resolution)
    if length <= 2.0 * END_DEPTH:
        return None
    searched = max(SEARCHED_SHARE * length, LEAST_SEARCHED)
    margin = round((searched + END_DEPTH) / truth.resolution)
    true = _blurred(np.bincount(cells, minlength=truth.shape[1 - axis]), margin, truth.resolution)
    drawn = _blurred(_occupied(grid, truth, axis, margin), 0, truth.resolution)
    shifts = [
        _shift(true, drawn, end + margin, inwards, round(searched / truth.resolution), truth)
        for end, inwards in ((int(cells.min()), 1), (int(cells.max()), -1))
    ]
    if shifts[0] is None or shifts[1] is None:
        return None
    return float(abs(shifts[1] - shifts[0]) * truth.resolution / length)


def _blurred(counts: NDArray[np.int64], margin: int, resolution: float) -> _Profile:
    """A profile with a margin of nothing on both sides, blurred."""
    padded = np.pad(counts.astype(np.float64), margin)
    blurred: _Profile = ndimage.gaussian_filter1d(padded, BLUR / resolution, mode="constant")
    return blurred


def _occupied(grid: OccupancyGrid, truth: TruthMap, axis: int, margin: int) -> NDArray[np.int64]:
    """Occupied cells of the map at each position of the truth's lattice, and a margin around."""
    counts = np.count_nonzero(grid.log_odds > grid.config.occupied_above, axis=axis)
    centres = grid.origin[axis] + (np.arange(len(counts)) + 0.5) * grid.resolution
    places = np.floor((centres - truth.origin[axis]) / truth.resolution + ROUNDING).astype(int)
    places += margin
    size = truth.shape[1 - axis] + 2 * margin
    inside = (places >= 0) & (places < size)
    return np.bincount(places[inside], weights=counts[inside], minlength=size).astype(np.int64)


def _shift(
    true: _Profile, drawn: _Profile, end: int, inwards: int, searched: int, truth: TruthMap
) -> int | None:
    """How many cells an end of the truth lies off in the map; None when it is not there.

    What runs along the axis, such as side walls, is the same everywhere: the median of each
    profile around the end, which is taken off.
    """
    depth = round(END_DEPTH / truth.resolution)
    blur = round(3.0 * BLUR / truth.resolution)
    first, last = sorted((end - inwards * blur, end + inwards * depth))
    template = _above_median(true[first : last + 1])
    agreements = [
        float(template @ _above_median(drawn[first + by : last + 1 + by]))
        for by in range(-searched, searched + 1)
    ]
    best = int(np.argmax(agreements))
    if agreements[best] < LEAST_AGREEMENT * float(template @ template):
        return None
    return best - searched


def _above_median(profile: _Profile) -> _Profile:
    return np.maximum(profile - np.median(profile), 0.0)
