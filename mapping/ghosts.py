"""Finds what a map shows where nothing stands: people who have left, and other ghosts."""

import numpy as np
from scipy import ndimage

from mapping.coverage import ROUNDING
from mapping.grid import OCCUPIED, OccupancyGrid
from mapping.truth import TruthMap

FAR_FROM_SOLID = 0.15
"""An occupied cell this far from everything that stands there [m] is no wall drawn out of place:
the noise of the datasheet at full range is 0.04 m, that of its worst case 0.18 m."""


def ghost_area(grid: OccupancyGrid, truth: TruthMap) -> float:
    """Area [m2] of the map's occupied cells that lie on free floor, far from any true solid.

    Counted are cells whose centre lies on a visible free cell of the truth and more than
    ``FAR_FROM_SOLID`` away from the nearest solid one, from centre to edge.
    """
    rows, columns = np.nonzero(grid.states() == OCCUPIED)
    centres = np.stack((columns, rows), axis=1) + 0.5
    places = (centres * grid.resolution + grid.origin - truth.origin) / truth.resolution
    cells = np.floor(places + ROUNDING).astype(np.int64)
    inside = np.all((cells >= 0) & (cells < truth.shape[::-1]), axis=1)
    at = cells[inside, 1], cells[inside, 0]
    away = (ndimage.distance_transform_edt(~truth.occupied) - 0.5) * truth.resolution
    ghosts = truth.visible_free[at] & (np.asarray(away)[at] > FAR_FROM_SOLID)
    return float(np.count_nonzero(ghosts)) * grid.resolution**2
