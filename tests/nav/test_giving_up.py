"""A robot that gets nowhere gives the frontier up, says why, and is not stuck for it."""

import numpy as np

from nav.explorer import NO_HEADWAY, FrontierExplorer
from nav.navigator import COMPLETE, RUNNING
from tests.nav.grids import ROOM_WITH_UNKNOWN_EAST, grid_from_text

MOST_PERIODS = 3000


def test_recoveries_on_the_way_to_one_frontier_add_up_until_it_is_given_up() -> None:
    """The wheels turn in vain: whatever it commands, it stays where it began."""
    explorer, grid = FrontierExplorer(), grid_from_text(ROOM_WITH_UNKNOWN_EAST)
    pose = np.array([0.8, 1.0, 0.0])
    for _ in range(MOST_PERIODS):
        explorer.command(grid, pose, None)
        if explorer.status != RUNNING:
            break
    assert explorer.status == COMPLETE, "it stands where it began: at home"
    assert {dropped.reason for dropped in explorer.dropped_frontiers} == {NO_HEADWAY}
