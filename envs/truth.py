"""Turn a floor plan into the truth that maps of it are scored against."""

from numpy.typing import ArrayLike

from envs.floor_plan import FloorPlan
from envs.plan_raster import lattice_for, rasterize
from mapping.burger import LIDAR_RANGE_MAX, ROBOT_RADIUS
from mapping.truth import TruthMap, truth_map

TRUTH_MARGIN = 0.1
"""Free cells kept round the plan [m], so that a map's walls that stand a little off still fall on
the raster."""


def truth_of_plan(
    plan: FloorPlan,
    *,
    resolution: float,
    robot_radius: float = ROBOT_RADIUS,
    sensor_range: float = LIDAR_RANGE_MAX,
    margin: float = TRUTH_MARGIN,
    start: ArrayLike | None = None,
) -> TruthMap:
    """What of a plan the robot can reach from its start, and its lidar see from there.

    Args:
        plan: The floor plan.
        resolution: Edge of a cell [m]; cell edges lie on whole multiples of it.
        robot_radius: Radius of the robot [m].
        sensor_range: How far the lidar sees [m].
        margin: Width of the frame round the plan's bounds [m].
        start: Where the robot begins, x, y [m] and more; None for the plan's start.

    Raises:
        TestbedError: The resolution is no positive number, the raster would be too large, or on
            cells of this size the robot does not fit at its start.
    """
    origin, shape = lattice_for(plan, resolution, margin)
    return truth_map(
        rasterize(plan, resolution=resolution, origin=origin, shape=shape),
        resolution=resolution,
        origin=origin,
        start=plan.start if start is None else start,
        robot_radius=robot_radius,
        sensor_range=sensor_range,
    )
