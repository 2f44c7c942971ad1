"""Coverage of a part of the world, from the map that a run left behind."""

from pathlib import Path

import numpy as np
import pytest

from envs.plan_yaml import write_plan
from evaluation.kernels.warm_up import TINY_ROOM
from evaluation.scenarios.region_coverage import region_coverages
from evaluation.scenarios.scenario import Region
from mapping.grid import FREE, GridConfig, OccupancyGrid
from mapping.io.map_server import write_map

WEST = Region(left=0.0, bottom=0.0, right=1.0, top=3.0)
EAST = Region(left=3.0, bottom=0.0, right=4.0, top=3.0)
MIDDLE = Region(left=0.5, bottom=0.5, right=1.5, top=1.0)
OUTSIDE = Region(left=8.0, bottom=0.0, right=9.0, top=3.0)


def test_of_each_region_what_the_map_calls_free_counts(tmp_path: Path) -> None:
    write_plan(TINY_ROOM, tmp_path / "tiny.yaml")
    grid = OccupancyGrid(GridConfig(resolution=0.05, origin=(0.0, 0.0), rows=60, columns=80))
    grid.log_odds[:, :20] = -9.0  # x up to 1 m
    grid.log_odds[10:20, 10:20] = 9.0  # all but the half of MIDDLE that lies beyond x = 1
    write_map(tmp_path / "map.yaml", grid)
    regions = {"west": WEST, "east": EAST, "middle": MIDDLE, "outside": OUTSIDE}
    coverages = region_coverages(tmp_path, str(tmp_path / "tiny.yaml"), regions)
    assert np.count_nonzero(grid.states() == FREE) == 20 * 60 - 100
    # A wall is 0.1 m thick and centred on its line: 0.05 m, one cell, of it stands in the room.
    assert coverages["west"] == pytest.approx((19 * 58 - 100) / (19 * 58))
    assert coverages["east"] == 0.0
    assert coverages["middle"] == 0.0
    assert coverages["outside"] is None
