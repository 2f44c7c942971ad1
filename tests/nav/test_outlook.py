"""What the robot could go and see when the frontiers that are left show nothing."""

import math

import numpy as np
import pytest

from nav.explorer import NO_HEADWAY, NOTHING_NEW
from nav.explorer_config import ExplorerConfig
from nav.given_up import GivenUp
from nav.outlook import NO_VIEW, NOT_WORTH_IT, Outlook
from nav.place_memory import PlaceMemory
from nav.planner import CostField
from nav.scan_points import ScanView
from nav.viewpoint import Viewpoint
from tests.nav.grids import costmap_of, room_with_slit

HERE = np.array([1.0, 1.05])


def grazing_view() -> ScanView:
    """A scan that meets the wall with the doorway on both sides of it, and nothing between."""
    y = np.array([*np.arange(0.16, 0.8, 0.1), *np.arange(1.32, 2.0, 0.1)])
    ranges = np.full(360, math.inf)
    ranges[: len(y)] = 1.0
    return ScanView(
        stamp=0.0,
        points=np.column_stack((np.full(len(y), 2.07), y)),
        beams=np.arange(len(y)),
        origin=HERE,
        bearing=0.0,
        increment=math.radians(1.0),
        ranges=ranges,
    )


def viewpoints(*, given_up_for: str | None) -> list[Viewpoint]:
    """Where to go when the doorway is taken for wall.

    The slit behind it was given up for a reason before, and gets another chance, if there is one.
    """
    config, grid = ExplorerConfig(), room_with_slit()
    costmap = costmap_of(grid)
    places = PlaceMemory(config.visited_places, config.former_walls)
    for _ in range(2):
        places.note_scan(costmap, HERE, grazing_view())
    places.mark(costmap, grid, HERE)
    field = CostField.around(costmap, HERE)
    outlook, given_up = Outlook(config), GivenUp()
    found = outlook.viewpoints(field, places, given_up, HERE)
    if given_up_for is None:
        return found
    given_up.give_up(outlook.frontiers[0], given_up_for)
    given_up.another_chance(2)
    return outlook.viewpoints(field, places, given_up, HERE)


@pytest.mark.parametrize("reason", [None, NO_VIEW, NOT_WORTH_IT])
def test_an_opening_beside_a_frontier_that_is_not_worth_a_look_is_looked_at(
    reason: str | None,
) -> None:
    found = viewpoints(given_up_for=reason)
    assert found
    assert all(1.0 < viewpoint.place[0] < 2.2 for viewpoint in found)


@pytest.mark.parametrize("reason", [NOTHING_NEW, NO_HEADWAY])
def test_an_opening_beside_a_frontier_that_was_tried_in_vain_is_not(reason: str) -> None:
    assert viewpoints(given_up_for=reason) == []
