"""Turns a costmap into frontiers: connected borders between free and unknown (Yamauchi 1997)."""

import math
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from mapping.errors import TestbedError
from nav.costmap import Costmap
from nav.former_walls import FormerWalls
from nav.frontier_kernels import mark_frontier, take_pieces


@dataclass(frozen=True, slots=True, kw_only=True)
class FrontierConfig:
    """What counts as a frontier."""

    min_cells: int = 3
    """A frontier of fewer planning cells is left alone."""
    beside_walls: bool = False
    """Whether cells that touch something occupied count: a narrow door has hardly any others."""

    def __post_init__(self) -> None:
        """Refuse a figure that lets nothing count."""
        if self.min_cells < 1:
            raise TestbedError(f"frontier min_cells: {self.min_cells}; must be at least 1")


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Frontier:
    """A connected border between free and unknown."""

    cells: NDArray[np.int64]
    """Its planning cells ``(n, 2)`` as (row, column)."""
    middle: NDArray[np.float64]
    """Its cell nearest to its centroid, ``(2,)`` as (x, y) [m]."""
    size: float
    """Its length, counted as cells times their edge [m]."""

    def distance_to(self, place: NDArray[np.float64]) -> float:
        """How far its middle is from a place ``(2,)`` [m]."""
        return math.hypot(self.middle[0] - place[0], self.middle[1] - place[1])


def find_frontiers(
    costmap: Costmap, config: FrontierConfig, former_walls: FormerWalls | None = None
) -> list[Frontier]:
    """Every frontier of at least ``min_cells`` cells, in the order of their first cells.

    Args:
        costmap: Where to look.
        config: What counts.
        former_walls: Where walls were known to be; frontiers there are left out.
    """
    marked = mark_frontier(costmap.states, config.beside_walls)
    if former_walls is not None:
        former_walls.unmark(costmap, marked)
    cells_of_all, starts = take_pieces(marked)
    frontiers = []
    for begin, end in pairwise(starts.tolist()):
        if end - begin < config.min_cells:
            continue
        cells = cells_of_all[begin:end]
        nearest = np.argmin(((cells - cells.mean(axis=0)) ** 2).sum(axis=1))
        frontiers.append(
            Frontier(
                cells=cells,
                middle=costmap.cell_to_world(cells[nearest]),
                size=len(cells) * costmap.resolution,
            )
        )
    return frontiers
