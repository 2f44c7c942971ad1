"""Turns a costmap and a cost field into viewpoints worth driving to.

A frontier is a border between free and unknown cells (Yamauchi 1997). Its centroid often lies in
unknown or occupied cells, so the robot is never sent there: it is sent to a reachable place from
which the frontier can be seen, and what such a place is worth is what the lidar would newly see
from it, by ray casting (Gonzalez-Banos and Latombe 2002).
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

from mapping.burger import LIDAR_RANGE_MAX
from mapping.errors import TestbedError
from nav.costmap import Costmap
from nav.former_walls import FormerWalls
from nav.frontier_kernels import cheapest_view, expected_gain, mark_frontier
from nav.planner import CostField

EIGHT_CONNECTED = np.ones((3, 3), dtype=np.int8)


@dataclass(frozen=True, slots=True, kw_only=True)
class FrontierConfig:
    """What counts as a frontier, and how viewpoints for it are looked for."""

    min_cells: int = 3
    """A frontier of fewer planning cells is left alone."""
    min_gain: float = 0.03
    """A viewpoint that would newly show less than this is not worth the way [m2]."""
    view_distances: tuple[float, ...] = (0.5, 1.2, 2.0)
    """How far from a frontier its viewpoints may lie [m]."""
    view_clearance: float = 0.14
    """Least clearance of a viewpoint [m]: enough to turn on the spot."""
    gain_range: float = LIDAR_RANGE_MAX - 0.5
    """How far the lidar is counted on to see [m]; less than its limit, where beams are sparse."""
    gain_depth: float = 1.5
    """How far a beam is counted on to see into the unknown [m]: something may stand there."""
    gain_beams: int = 240
    """Beams cast to estimate what a viewpoint would show."""

    def __post_init__(self) -> None:
        """Refuse figures that find nothing."""
        if self.min_cells < 1 or self.gain_beams < 1 or not self.view_distances:
            raise TestbedError("frontier: min_cells, gain_beams and view_distances must be above 0")


@dataclass(frozen=True, slots=True, kw_only=True)
class Frontier:
    """A connected border between free and unknown."""

    cells: NDArray[np.int64]
    """Its planning cells ``(n, 2)`` as (row, column)."""
    middle: NDArray[np.float64]
    """Its cell nearest to its centroid, ``(2,)`` as (x, y) [m]."""
    size: float
    """Its length, counted as cells times their edge [m]."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Viewpoint:
    """A reachable place and what it would show."""

    place: NDArray[np.float64]
    """Where to stand, ``(2,)`` as (x, y) [m]."""
    frontier: Frontier
    gain: float
    """Area the lidar is expected to newly see from there [m2]."""
    cost: float
    """Cost of the way there [m, dearer near things]."""


def find_frontiers(
    costmap: Costmap, config: FrontierConfig, former_walls: FormerWalls | None = None
) -> list[Frontier]:
    """Every frontier of at least ``min_cells`` cells, in the order of their labels.

    Args:
        costmap: Where to look.
        config: What counts.
        former_walls: Where walls were known to be; frontiers there are left out.
    """
    marked = mark_frontier(costmap.states)
    if former_walls is not None:
        former_walls.unmark(costmap, marked)
    labels, _ = ndimage.label(marked, structure=EIGHT_CONNECTED)
    frontiers = []
    for index, box in enumerate(ndimage.find_objects(labels), start=1):
        cells = np.argwhere(labels[box] == index) + [box[0].start, box[1].start]
        if len(cells) < config.min_cells:
            continue
        nearest = np.argmin(np.sum((cells - cells.mean(axis=0)) ** 2, axis=1))
        frontiers.append(
            Frontier(
                cells=cells,
                middle=costmap.cell_to_world(cells[nearest]),
                size=len(cells) * costmap.resolution,
            )
        )
    return frontiers


def find_viewpoints(
    field: CostField, frontiers: Sequence[Frontier], config: FrontierConfig
) -> list[Viewpoint]:
    """For each frontier and view distance the cheapest place that sees it and would show enough.

    Frontiers that no known place sees, or whose places would show less than ``min_gain``, yield
    none.
    """
    viewpoints = []
    for frontier in frontiers:
        seen: set[tuple[int, int]] = set()
        for distance in config.view_distances:
            cell = _view_cell(field, frontier, distance, config)
            if cell is None or cell in seen:
                continue
            seen.add(cell)
            gain = _gain(field.costmap, cell, config)
            if gain >= config.min_gain:
                viewpoints.append(
                    Viewpoint(
                        place=field.costmap.cell_to_world(cell),
                        frontier=frontier,
                        gain=gain,
                        cost=float(field.cost_to_come[cell]),
                    )
                )
    return viewpoints


def gain_at(costmap: Costmap, place: NDArray[np.float64], config: FrontierConfig) -> float:
    """Area [m2] that the lidar is expected to newly see from a place (x, y); 0 outside the map."""
    row, column = (int(index) for index in costmap.world_to_cell(place))
    rows, columns = costmap.states.shape
    if not (0 <= row < rows and 0 <= column < columns):
        return 0.0
    return _gain(costmap, (row, column), config)


def _view_cell(
    field: CostField, frontier: Frontier, distance: float, config: FrontierConfig
) -> tuple[int, int] | None:
    costmap = field.costmap
    middle = costmap.world_to_cell(frontier.middle)
    row, column = cheapest_view(
        field.cost_to_come,
        costmap.states,
        costmap.clearance,
        int(middle[0]),
        int(middle[1]),
        distance / costmap.resolution,
        np.float32(config.view_clearance),
    )
    return None if row < 0 else (row, column)


def _gain(costmap: Costmap, cell: tuple[int, int], config: FrontierConfig) -> float:
    cells = expected_gain(
        costmap.states,
        cell[0],
        cell[1],
        config.gain_range / costmap.resolution,
        config.gain_depth / costmap.resolution,
        config.gain_beams,
    )
    return float(cells * costmap.resolution**2)
