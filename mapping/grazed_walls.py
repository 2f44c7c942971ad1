"""Closes walls that were only seen at a grazing angle, in a finished map.

Along such a wall a centimetre behind its face is a hand's breadth behind a reading, too far for the
reading to tell of it, and what is free goes over into what is unknown without a wall between them.
But readings ended there, and one that did so at the edge of the unknown met what hides it.
"""

import numpy as np
from numba import njit
from numpy.typing import NDArray

from mapping.aimed_beams import AimedBeams
from mapping.grid import OccupancyGrid
from mapping.ogm import BEHIND_CELLS, OgmConfig


class GrazedWalls:
    """Takes all scans of a finished map, then draws what they met at the edge of the unknown."""

    def __init__(self, grid: OccupancyGrid) -> None:
        """Take scans of a map that stays as large as it is until ``write``."""
        self._grid = grid
        self._is_end = np.zeros(grid.shape, dtype=np.bool_)

    def add(self, beams: AimedBeams) -> None:
        """Take one scan."""
        reach = beams.lengths + BEHIND_CELLS * self._grid.resolution
        ends = (beams.origins + reach[:, None] * beams.directions)[beams.hits]
        cells = self._grid.world_to_cell(ends)
        cells = cells[self._grid.contains(cells)]
        self._is_end[cells[:, 0], cells[:, 1]] = True

    def write(self, config: OgmConfig) -> None:
        """Draw unknown cells as wall that share an edge with a free one, and a corner with an end.

        Args:
            config: How the map was drawn.
        """
        grid = self._grid
        close_at(
            grid.log_odds,
            np.argwhere(self._is_end),
            grid.config.free_below,
            grid.config.occupied_above,
            config.highest,
        )


@njit(cache=True)
def close_at(
    log_odds: NDArray[np.float32],
    ends: NDArray[np.int64],
    free_below: float,
    occupied_above: float,
    wall: float,
) -> None:
    """Let unknown cells around ends ``(n, 2)`` as (row, column) be wall, if beside free ones."""
    rows, columns = log_odds.shape
    for k in range(len(ends)):
        for row in range(max(ends[k, 0] - 1, 0), min(ends[k, 0] + 2, rows)):
            for column in range(max(ends[k, 1] - 1, 0), min(ends[k, 1] + 2, columns)):
                if not free_below <= log_odds[row, column] <= occupied_above:
                    continue
                beside_free = (
                    (row > 0 and log_odds[row - 1, column] < free_below)
                    or (row < rows - 1 and log_odds[row + 1, column] < free_below)
                    or (column > 0 and log_odds[row, column - 1] < free_below)
                    or (column < columns - 1 and log_odds[row, column + 1] < free_below)
                )
                if beside_free:
                    log_odds[row, column] = wall
