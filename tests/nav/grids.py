"""Small occupancy grids for the navigation tests, drawn as text."""

import numpy as np
from numpy.typing import NDArray

from mapping.grid import GridConfig, OccupancyGrid
from nav.costmap import Costmap, CostmapConfig

ROOM_WITH_UNKNOWN_EAST = "\n".join(
    ["#" * 41 + "?" * 39] + ["#" + "." * 40 + "?" * 39] * 40 + ["#" * 41 + "?" * 39]
)
"""A room of 2 x 2 m with walls on three sides and the unknown on the fourth."""

LOG_ODDS = {"#": 5.0, ".": -5.0, "?": 0.0}


def grid_from_text(picture: str, resolution: float = 0.05) -> OccupancyGrid:
    """A grid from rows of # (occupied), . (free) and ? (unknown); the top row is the largest y."""
    rows = [line.strip() for line in picture.strip().splitlines()][::-1]
    return grid_from_log_odds(np.array([[LOG_ODDS[c] for c in row] for row in rows]), resolution)


def grid_from_log_odds(log_odds: NDArray[np.float64], resolution: float) -> OccupancyGrid:
    """A grid of fixed size with its origin at (0, 0)."""
    rows, columns = log_odds.shape
    grid = OccupancyGrid(
        GridConfig(
            resolution=resolution, origin=(0.0, 0.0), rows=rows, columns=columns, grows=False
        )
    )
    grid.log_odds[:] = log_odds
    return grid


def room_with_slit() -> OccupancyGrid:
    """A room of 2 x 2 m; of what its doorway in the east, 0.5 m wide, leads to, a slit is known."""
    log_odds = np.zeros((42, 102))
    log_odds[:, :42] = 5.0
    log_odds[1:41, 1:41] = -5.0
    log_odds[16:25, 41] = -5.0
    log_odds[25, 42:102] = -5.0
    return grid_from_log_odds(log_odds, 0.05)


def random_grid(seed: int, rows: int = 60, columns: int = 80, fine: int = 1) -> OccupancyGrid:
    """A grid with a free middle, unknown patches and some occupied blocks."""
    rng = np.random.default_rng(seed)
    log_odds = np.full((rows * fine, columns * fine), -5.0)
    for value, count in ((0.0, 4), (5.0, 8)):
        for _ in range(count):
            height, width = rng.integers(1, 12 * fine, size=2)
            row, column = rng.integers(0, rows * fine), rng.integers(0, columns * fine)
            log_odds[row : row + height, column : column + width] = value
    return grid_from_log_odds(log_odds, 0.05 / fine)


def costmap_of(grid: OccupancyGrid, config: CostmapConfig | None = None) -> Costmap:
    """A costmap that has taken over the whole grid."""
    costmap = Costmap(config)
    costmap.refresh(grid)
    return costmap
