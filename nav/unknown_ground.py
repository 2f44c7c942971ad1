"""Turns a costmap into one that also leads over what is unknown, and beyond the map's edge.

A robot that was told where to go may set out before it knows a way: what turns out to be a wall is
planned around when it is seen.
"""

import numpy as np
from numpy.typing import NDArray

from mapping.grid import UNKNOWN
from nav.costmap import Costmap

UNKNOWN_COST = 2.0
"""Cost per metre of the unknown: a known way up to twice as long is preferred to it."""

FARTHEST_BEYOND = 30.0
"""Of the unknown beyond the map's edge, so much is planned on at most [m]: a place farther off is
made for bit by bit."""

MARGIN = 1.0
"""Room around places beyond the edge [m], for the way around what stands there."""


def with_unknown_ground(costmap: Costmap, places: NDArray[np.float64]) -> Costmap:
    """A costmap that covers places ``(n, 2)`` [m] too and may be crossed where it is unknown.

    The unknown costs ``UNKNOWN_COST`` a metre and more near known things, as free space does.
    """
    rows, columns = costmap.states.shape
    low = costmap.world_to_cell(places.min(axis=0) - MARGIN)
    high = costmap.world_to_cell(places.max(axis=0) + MARGIN)
    most = int(FARTHEST_BEYOND / costmap.resolution)
    below, before = (int(cells) for cells in np.clip(-low, 0, most))
    above, after = (int(cells) for cells in np.clip(high - (rows - 1, columns - 1), 0, most))
    edges = ((below, above), (before, after))
    wider = Costmap(costmap.config)
    wider.resolution = costmap.resolution
    wider.origin = costmap.origin - np.array([before, below]) * costmap.resolution
    wider.states = np.pad(costmap.states, edges, constant_values=UNKNOWN)
    wider.clearance = np.pad(
        costmap.clearance, edges, constant_values=np.float32(costmap.config.inflation)
    )
    wider.cost = np.pad(costmap.cost, edges, constant_values=np.float32(np.inf))
    config = costmap.config
    open_ground = (wider.states == UNKNOWN) & (wider.clearance >= config.lethal_clearance)
    near = (config.inflation - wider.clearance[open_ground]) / (
        config.inflation - config.lethal_clearance
    )
    wider.cost[open_ground] = UNKNOWN_COST + config.closeness_cost * np.maximum(near, 0.0) ** 2
    return wider
