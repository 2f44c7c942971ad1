"""Turns a finished map into one whose walls stand where all its scans together say, to a cell.

Log odds tell what there is: whoever has left is gone. Where exactly a surface lies they tell badly,
as the last few readings, each some cells off, decide. Averaged over all scans, the signed distance
of a cell before the surface does it (Curless and Levoy 1996; for a lidar in the plane Daun et al.
2019): cells with a positive mean are free, and the wall begins where it turns negative. Readings
count by their inverse variance, so near ones decide where there are any.

The settings were chosen on runs in lim_room, corridor_loop, cluttered_office, empty_room,
turtlebot3_world and a hall with people, with the scans in their true places and as the mapper had
placed them.
"""

import numpy as np
from scipy import ndimage

from mapping.aimed_beams import AimedBeams
from mapping.grid import OccupancyGrid
from mapping.ogm import OgmConfig
from mapping.surface_band import TILE, SurfaceBand, band_along
from mapping.surface_distance_kernels import (
    COLUMNS,
    DX,
    DY,
    HIT,
    LENGTH,
    PAIR,
    SIGMA,
    X,
    Y,
    add_distances,
)

BAND = 3
"""Surfaces are looked for up to so many cells from those that log odds call occupied: drawn walls
were seldom farther off."""

REACH_CELLS, REACH_SIGMAS = 2.5, 1.0
"""A reading tells of cells within so many cells of it and so many standard deviations: the same to
both sides, so that its noise does not push the surface."""

WALL = 1.5
"""A wall is drawn so many cells thick: the least that leaves no gap between cells' corners, however
it lies. Deeper in, nothing was seen."""

SCANS = 2
"""So many scans must tell of a cell: one alone may have gone through a pane."""

SURE = 2.0
"""Where the mean's standard deviation is above so many cells, log odds are left as they are."""


class SurfaceRefinement:
    """Takes all scans of a finished map, then moves its surfaces to where they say."""

    def __init__(self, grid: OccupancyGrid, config: OgmConfig) -> None:
        """Look for surfaces along what a map calls occupied.

        Args:
            grid: The map; must stay as it is until ``write``.
            config: How it was drawn.
        """
        self._grid = grid
        self._config = config
        self._band: SurfaceBand = band_along(grid, BAND)

    def add(self, beams: AimedBeams) -> None:
        """Take one scan."""
        resolution = self._grid.resolution
        table = np.empty((len(beams.lengths), COLUMNS))
        table[:, [X, Y]] = (beams.origins - self._grid.origin) / resolution
        table[:, [DX, DY]] = beams.directions
        table[:, LENGTH] = beams.lengths / resolution
        table[:, SIGMA] = beams.sigmas / resolution
        table[:, HIT], table[:, PAIR] = beams.hits, beams.pairs
        band = self._band
        add_distances(
            band.cells,
            band.starts,
            TILE,
            band.tile_shape,
            band.sums,
            table,
            (REACH_CELLS, REACH_SIGMAS),
        )

    def write(self) -> None:
        """Move the map's surfaces.

        What log odds call occupied, but no surface is found near, stays if most scans saw through
        its place: it came late. If they saw it lie behind something, noise carried hits there.
        """
        grid, config = self._grid, self._config
        rows, columns = self._band.cells.T
        counts, weights, weighted = self._band.sums.T
        told = (counts >= SCANS) & (weights > 1.0 / SURE**2)
        means = weighted / np.where(told, weights, 1.0)
        is_wall = told & (means <= 0.0) & (means > -WALL)
        wall = np.zeros(grid.shape, dtype=np.bool_)
        wall[rows[is_wall], columns[is_wall]] = True
        explained = ndimage.maximum_filter(wall, size=2 * BAND + 1, mode="constant")
        values = grid.log_odds[rows, columns]
        unexplained = (values > grid.config.occupied_above) & ~explained[rows, columns]
        came_late = unexplained & (means > -WALL)
        values[told & ~came_late & (means <= -WALL)] = 0.0
        values[told & ~came_late & (means > 0.0)] = config.lowest
        values[is_wall] = config.highest
        grid.log_odds[rows, columns] = values
        grid.redraws += 1
