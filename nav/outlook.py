"""Turns what the robot knows into all that it could go and see next.

First the frontiers, the small ones put off; then these; and then, when nothing else is left, what
was taken for wall from afar and may be a narrow door: at a grazing angle, 3 m away, the lidar's
beams meet a wall farther apart than the robot is wide, and one between two of them goes unseen.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from nav.costmap import Costmap
from nav.explorer_config import ExplorerConfig
from nav.frontier import Frontier, find_frontiers
from nav.frontier_kernels import any_near
from nav.given_up import GivenUp
from nav.place_memory import PlaceMemory
from nav.planner import CostField
from nav.put_off import PutOff
from nav.viewpoint import Viewpoint, ViewpointFinder, gain_at

NO_VIEW = "no place in reach that was not tried sees it"
NOT_WORTH_IT = "too little to see for the way there"
"""Why a frontier is given up."""

BESIDE = 2
"""An opening within so many cells of a frontier is a part of it, if that can be looked at."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class _Search:
    """Frontiers that were looked for views of, on which costmap, and by whom."""

    frontiers: list[Frontier]
    costmap: Costmap
    finder: ViewpointFinder


class Outlook:
    """Finds frontiers and openings, and the places that show them."""

    def __init__(self, config: ExplorerConfig) -> None:
        self._config = config
        self._finder = ViewpointFinder(config.viewpoint)
        self._opening_finder = ViewpointFinder(config.opening_view)
        self._put_off = PutOff(config.put_off)
        self._searches: list[_Search] = []
        self.frontiers: list[Frontier] = []
        """All of the last look, those that were given up among them."""

    def viewpoints(
        self,
        field: CostField,
        places: PlaceMemory,
        given_up: GivenUp,
        robot: NDArray[np.float64],
    ) -> list[Viewpoint]:
        """Where it is worth going now, any number of places for a frontier.

        Args:
            field: What it costs to come to each place, on the costmap with all that is remembered.
            places: What is remembered of places.
            given_up: Frontiers that are left alone.
            robot: Where the robot is ``(2,)`` [m].
        """
        costmap, config = field.costmap, self._config
        visited = places.visited.on(costmap)
        self.frontiers = find_frontiers(costmap, config.frontier, places.former_walls)
        self._searches = [
            _Search(
                frontiers=[item for item in self.frontiers if not given_up.holds(item)],
                costmap=costmap,
                finder=self._finder,
            )
        ]
        found = self._finder.find(field, self._searches[0].frontiers, visited, robot)
        now = self._put_off.worth_now(found, costmap.free_area)
        if not self._put_off.is_over:
            return given_up.not_in_vain(now)
        fresh = costmap.without_marks()
        places.mark_sure(fresh)
        openings = find_frontiers(fresh, config.opening, places.former_walls)
        openings = _apart_from(self._looked_at(given_up, now), openings, fresh)
        self.frontiers += openings
        open_ones = [item for item in openings if not given_up.holds(item)]
        self._searches.append(
            _Search(frontiers=open_ones, costmap=fresh, finder=self._opening_finder)
        )
        field = replace(field, costmap=fresh)
        through = self._opening_finder.find(field, open_ones, visited, robot)
        return given_up.not_in_vain(now + through)

    def _looked_at(self, given_up: GivenUp, worth: Sequence[Viewpoint]) -> list[Frontier]:
        """The frontiers that are worth a look as they are, or were until they were given up."""
        worthwhile = {id(viewpoint.frontier) for viewpoint in worth}
        return [
            item
            for item in self.frontiers
            if id(item) in worthwhile or given_up.reason(item) not in (None, NO_VIEW, NOT_WORTH_IT)
        ]

    def note_left_over(self, given_up: GivenUp) -> None:
        """Record every frontier that hides something, and why the robot does not go there."""
        for search in self._searches:
            config = search.finder.config
            for frontier in search.frontiers:
                if gain_at(search.costmap, frontier.middle, config) >= config.min_gain:
                    seen = search.finder.has_view(frontier)
                    given_up.give_up(frontier, NOT_WORTH_IT if seen else NO_VIEW)


def _apart_from(
    frontiers: Sequence[Frontier], openings: Sequence[Frontier], costmap: Costmap
) -> list[Frontier]:
    """The openings that lie beside none of the frontiers."""
    taken = np.zeros(costmap.states.shape, dtype=np.bool_)
    for frontier in frontiers:
        taken[frontier.cells[:, 0], frontier.cells[:, 1]] = True
    return [item for item in openings if not any_near(taken, item.cells, BESIDE)]
