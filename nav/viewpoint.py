"""Turns frontiers into viewpoints worth driving to.

A frontier's centroid often lies in unknown or occupied cells, so the robot is never sent there: it
is sent to a reachable place from which the frontier can be seen, and what such a place is worth is
what the lidar would newly see from it, by ray casting (Gonzalez-Banos and Latombe 2002).
"""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mapping.burger import LIDAR_RANGE_MAX
from mapping.errors import TestbedError
from nav.costmap import Costmap
from nav.frontier import Frontier
from nav.planner import CostField
from nav.viewpoint_kernels import cheapest_view, expected_gain, view_square_on


@dataclass(frozen=True, slots=True, kw_only=True)
class ViewpointConfig:
    """Where viewpoints are looked for, and what makes them worth the way."""

    min_gain: float = 0.03
    """A viewpoint that would newly show less than this is not worth going to [m2]."""
    min_share_per_metre: float = 0.0006
    """Nor is one that would show less than this share of the known floor more for every metre of
    the way [1/m]: 10 m of way for 0.6 % of the map."""
    always_worth: float = 1.0
    """One that would show this much is worth any way [m2]: behind it may lie a room."""
    view_distances: tuple[float, ...] = (0.3, 0.5, 1.0)
    """How far from a frontier its viewpoints may lie [m]."""
    view_clearance: float = 0.14
    """Least clearance of a viewpoint [m]: enough to turn on the spot."""
    gain_range: float = LIDAR_RANGE_MAX - 0.5
    """How far the lidar is counted on to see [m]; less than its limit, where beams are sparse."""
    gain_depth: float = 1.5
    """How far a beam is counted on to see into the unknown [m]: something may stand there."""
    gain_beams: int = 240
    """Beams cast to estimate what a viewpoint would show."""
    through_holes: bool = False
    """Whether a beam is counted on to see through holes in walls as narrow as a planning cell."""
    square_on: float = 0.0
    """A frontier is looked at square on as well, from up to so far [m]: along a wall hardly
    anything shows of what lies behind a hole in it. 0 for no such look."""
    part_spacing: float = 0.3
    """How far apart the parts of a frontier are that are looked at where nothing sees its middle
    [m]."""
    keep_beyond: float = 6.0
    """The viewpoints of a frontier this far from the robot are kept from the last time [m]."""

    def __post_init__(self) -> None:
        """Refuse figures that find nothing."""
        if self.gain_beams < 1 or not self.view_distances:
            raise TestbedError("viewpoint: gain_beams and view_distances must not be empty")
        if not self.square_on >= 0.0:
            raise TestbedError(f"viewpoint: square_on must not be below 0 m, not {self.square_on}")


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Viewpoint:
    """A reachable place and what it would show."""

    place: NDArray[np.float64]
    """Where to stand, ``(2,)`` as (x, y) [m]."""
    frontier: Frontier
    gain: float
    """Area the lidar is expected to newly see from there [m2]."""
    cost: float
    """Cost of the way there [m, dearer near things]."""
    rival: float = 0.0
    """The most that another place promised to show of the same frontier [m2]."""

    def is_near(self, other: "Viewpoint") -> bool:
        """Whether both show the same frontier, which may have grown or shrunk in between."""
        return self.frontier.distance_to(other.frontier.middle) < SAME_FRONTIER


SAME_FRONTIER = 0.6
"""Frontiers whose middles lie this close to each other count as the same one [m]."""

NOWHERE = (-1, -1)
"""The cell of no view."""

KEY_RESOLUTION = 0.01
"""Middles of frontiers are told apart to this [m]; planning cells are never finer."""

_Places = list[tuple[NDArray[np.float64], float]]


class ViewpointFinder:
    """Finds viewpoints; keeps those of far frontiers, around which nothing can have changed."""

    def __init__(self, config: ViewpointConfig | None = None) -> None:
        self.config = config or ViewpointConfig()
        self._kept: dict[tuple[int, int, int], _Places] = {}

    def find(
        self,
        field: CostField,
        frontiers: Sequence[Frontier],
        visited: NDArray[np.bool_],
        robot: NDArray[np.float64],
    ) -> list[Viewpoint]:
        """For each frontier the places that see it and are worth the way.

        Frontiers that no known place sees, or whose places would show too little, yield none.

        Args:
            field: What it costs to come to each place.
            frontiers: What is to be seen.
            visited: Cells ``[row, col]`` that show nothing new: the robot has looked from there.
            robot: Where the robot is ``(2,)`` [m].
        """
        kept, self._kept = self._kept, {}
        viewpoints = []
        per_metre = self.config.min_share_per_metre * field.costmap.free_area
        for frontier in frontiers:
            key = self._key(frontier)
            is_far = frontier.distance_to(robot) > self.config.keep_beyond
            places = kept.get(key) if is_far else None
            if places is None:
                places = self._places(field, frontier, visited, per_metre)
            self._kept[key] = places
            viewpoints += self._worthwhile(field, frontier, places, per_metre)
        return viewpoints

    def has_view(self, frontier: Frontier) -> bool:
        """Whether the last search knew any place that sees a frontier, worth the way or not."""
        return bool(self._kept.get(self._key(frontier)))

    def _key(self, frontier: Frontier) -> tuple[int, int, int]:
        """Tells a frontier from others and from itself grown; holds when the map grows."""
        x, y = np.round(frontier.middle / KEY_RESOLUTION).astype(int).tolist()
        return x, y, len(frontier.cells)

    def _places(
        self,
        field: CostField,
        frontier: Frontier,
        visited: NDArray[np.bool_],
        per_metre: float,
    ) -> _Places:
        """Places that see a frontier, and what each would show [m2].

        Those that see its middle; if none does that is worth the way, those that see another part
        of it as well, until one is. Of each part the cheapest from each distance, and one square
        on if that is asked for.
        """
        costmap, config = field.costmap, self.config
        found: _Places = []
        for part in _parts(costmap, frontier, config.part_spacing):
            cells = {
                _view_cell(field, part, visited, distance, config)
                for distance in config.view_distances
            }
            cells.add(_cell_square_on(field, frontier, part, visited, config))
            cells.discard(NOWHERE)
            places = [
                (costmap.cell_to_world(cell), _gain(costmap, cell, config))
                for cell in sorted(cells)
            ]
            found += places
            if self._worthwhile(field, frontier, places, per_metre):
                break
        return found

    def _worthwhile(
        self, field: CostField, frontier: Frontier, places: _Places, per_metre: float
    ) -> list[Viewpoint]:
        """The places whose gain pays for their way, at ``per_metre`` [m2/m]."""
        config = self.config
        viewpoints = []
        for place, gain in places:
            cost = field.cost_at(place)
            enough = min(config.min_gain + per_metre * cost, config.always_worth)
            if math.isfinite(cost) and gain >= enough:
                rival = max((other for at, other in places if at is not place), default=0.0)
                viewpoints.append(
                    Viewpoint(place=place, frontier=frontier, gain=gain, cost=cost, rival=rival)
                )
        return viewpoints


def gain_at(costmap: Costmap, place: NDArray[np.float64], config: ViewpointConfig) -> float:
    """Area [m2] that the lidar is expected to newly see from a place (x, y); 0 outside the map."""
    row, column = (int(index) for index in costmap.world_to_cell(place))
    rows, columns = costmap.states.shape
    if not (0 <= row < rows and 0 <= column < columns):
        return 0.0
    return _gain(costmap, (row, column), config)


def _parts(costmap: Costmap, frontier: Frontier, spacing: float) -> Iterator[tuple[int, int]]:
    """Cells of a frontier, its middle first, so far from each other [m]."""
    left = frontier.cells
    row, column = costmap.world_to_cell(frontier.middle).tolist()
    while True:
        yield row, column
        left = left[np.hypot(left[:, 0] - row, left[:, 1] - column) * costmap.resolution > spacing]
        if len(left) == 0:
            return
        row, column = left[0].tolist()


def _view_cell(
    field: CostField,
    part: tuple[int, int],
    visited: NDArray[np.bool_],
    distance: float,
    config: ViewpointConfig,
) -> tuple[int, int]:
    """The cheapest cell that sees another from within a distance; NOWHERE if there is none."""
    costmap = field.costmap
    row, column = cheapest_view(
        field.cost_to_come,
        costmap.states,
        costmap.clearance,
        visited,
        part[0],
        part[1],
        distance / costmap.resolution,
        np.float32(config.view_clearance),
    )
    return int(row), int(column)


def _cell_square_on(
    field: CostField,
    frontier: Frontier,
    part: tuple[int, int],
    visited: NDArray[np.bool_],
    config: ViewpointConfig,
) -> tuple[int, int]:
    """The cell that sees a part of a frontier square on; NOWHERE if there is none."""
    costmap = field.costmap
    row, column = view_square_on(
        field.cost_to_come,
        costmap.states,
        costmap.clearance,
        visited,
        frontier.cells,
        part[0],
        part[1],
        config.square_on / costmap.resolution,
        np.float32(config.view_clearance),
    )
    return int(row), int(column)


def _gain(costmap: Costmap, cell: tuple[int, int], config: ViewpointConfig) -> float:
    cells = expected_gain(
        costmap.states,
        cell[0],
        cell[1],
        config.gain_range / costmap.resolution,
        config.gain_depth / costmap.resolution,
        config.gain_beams,
        config.through_holes,
    )
    return float(cells * costmap.resolution**2)
