"""Turns the map in a run folder into the coverage of parts of the world."""

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

import numpy as np

from envs.truth import truth_of_plan
from envs.worlds import load_world
from evaluation.scenarios.scenario import Region
from mapping.compare import score_map
from mapping.io.map_server import read_map
from mapping.truth import Mask, TruthMap


def region_coverages(
    folder: Path, world: str, regions: Mapping[str, Region]
) -> dict[str, float | None]:
    """Of each region, the share of its visible free cells that the map calls free.

    A cell counts as inside when its centre is. A region that shows nothing free has None.

    Args:
        folder: A run folder.
        world: The world of the run.
        regions: The regions, by name.
    """
    if not regions:
        return {}
    map_file = read_map(folder / "map.yaml")
    truth = truth_of_plan(load_world(world), resolution=map_file.resolution)
    nothing = np.zeros_like(truth.visible_surface)
    return {
        name: score_map(
            map_file,
            replace(
                truth,
                visible_free=truth.visible_free & _inside(region, truth),
                visible_surface=nothing,  # no walls to score, which would take longer
            ),
        ).coverage
        for name, region in regions.items()
    }


def _inside(region: Region, truth: TruthMap) -> Mask:
    """The cells of the truth whose centres lie in a region."""
    rows, columns = truth.shape
    x = truth.origin[0] + (np.arange(columns) + 0.5) * truth.resolution
    y = truth.origin[1] + (np.arange(rows) + 0.5) * truth.resolution
    in_columns = (region.left <= x) & (x <= region.right)
    in_rows = (region.bottom <= y) & (y <= region.top)
    return in_rows[:, None] & in_columns
