"""Turns viewpoints into the one to drive to next, by the rules that others use: one step ahead.

They are here to be compared with. All share the viewpoints, the paths and the driving of the
explorer, so that a comparison tells of the rule alone.
"""

from collections.abc import Callable, Sequence

import numpy as np

from mapping.geometry import Pose
from nav.planner import CostField
from nav.viewpoint import Viewpoint

POTENTIAL_SCALE, GAIN_SCALE = 3.0, 1.0
"""Weights of distance and size in explore_lite's cost: those of its explore.launch."""

SHORTEST_WAY = 0.05
"""No way counts as shorter [m]: a cell of the planning grid."""

Rule = Callable[[Sequence[Viewpoint], CostField, Pose], Viewpoint | None]


def nearest(viewpoints: Sequence[Viewpoint], field: CostField, pose: Pose) -> Viewpoint | None:
    """The viewpoint that is cheapest to come to (Yamauchi 1997); None of none."""
    return min(viewpoints, key=lambda viewpoint: viewpoint.cost, default=None)


def explore_lite(viewpoints: Sequence[Viewpoint], field: CostField, pose: Pose) -> Viewpoint | None:
    """The cheapest view of the frontier that explore_lite would choose; None of none.

    Its cost of a frontier (``FrontierSearch::frontierCost``) is the straight distance to the
    nearest of its cells [m] times POTENTIAL_SCALE, less its number of cells times GAIN_SCALE, both
    times the edge of a cell. It drives to the frontier's centroid, which often cannot be reached;
    here it gets a viewpoint.
    """

    def cost(viewpoint: Viewpoint) -> float:
        cells = viewpoint.frontier.cells
        offsets = field.costmap.cell_to_world(cells) - pose[:2]
        distance = float(np.hypot(offsets[:, 0], offsets[:, 1]).min())
        return POTENTIAL_SCALE * distance - GAIN_SCALE * len(cells)

    return min(viewpoints, key=lambda each: (cost(each), each.cost), default=None)


def gain_per_cost(
    viewpoints: Sequence[Viewpoint], field: CostField, pose: Pose
) -> Viewpoint | None:
    """The viewpoint that shows most per metre of its way; None of none."""
    return max(viewpoints, key=lambda each: each.gain / max(each.cost, SHORTEST_WAY), default=None)


GREEDY_RULES: dict[str, Rule] = {
    "nearest": nearest,
    "explore_lite": explore_lite,
    "gain_cost": gain_per_cost,
}
