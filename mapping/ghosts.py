"""Finds what a map shows where nothing stands: people who have left, and other ghosts."""

import numpy as np
from scipy import ndimage
from scipy.spatial import KDTree

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
    on_floor = cells[inside, ::-1]
    on_floor = on_floor[truth.visible_free[on_floor[:, 0], on_floor[:, 1]]]
    # the solid cell nearest to a free one has a free neighbour
    edges = truth.occupied & ~ndimage.binary_erosion(truth.occupied, border_value=1)
    gaps, _ = KDTree(np.argwhere(edges)).query(on_floor)
    ghosts = (gaps - 0.5) * truth.resolution > FAR_FROM_SOLID
    return float(np.count_nonzero(ghosts)) * grid.resolution**2
