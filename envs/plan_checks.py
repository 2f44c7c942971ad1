"""Checks of the figures that a floor plan's parts are made of, each refused in one line."""

import math

from envs.burger_constants import BASE_LINK_HEIGHT, LIDAR_POSITION
from envs.wall_line import SAME_POINT
from mapping.errors import TestbedError

Point = tuple[float, float]

LIDAR_PLANE_HEIGHT = BASE_LINK_HEIGHT + LIDAR_POSITION[2]
"""Height of the lidar's plane above the floor [m]."""

PITCH_MARGIN = 0.04
"""How much higher a beam may run at full range [m]: a robot that pitches by 0.6 degrees, as on
ROBOTIS's caster, lifts it by 3.5 m * tan(0.6 degrees) = 0.037 m."""

MIN_HEIGHT = LIDAR_PLANE_HEIGHT + PITCH_MARGIN
"""The lowest thing that the lidar is sure to see [m]; the robot would run into lower ones."""

MIN_SIZE = 0.001
"""The smallest thickness, side or radius [m]: what the LDS-01 resolves."""

MAX_COORDINATE = 1e4
"""The farthest a plan may reach from the origin [m]: no building does, a slip of units may."""


def check_points(field: str, points: tuple[Point, ...]) -> None:
    """Refuse coordinates that are no finite numbers within the largest plan."""
    for x, y in points:
        if not (abs(x) <= MAX_COORDINATE and abs(y) <= MAX_COORDINATE):  # NaN compares false
            raise TestbedError(
                f"{field}: ({x}, {y}) m; coordinates must be finite, "
                f"{MAX_COORDINATE:g} m from the origin at most"
            )


def check_finite(field: str, value: float, unit: str) -> None:
    """Refuse NaN and infinity."""
    if not math.isfinite(value):
        raise TestbedError(f"{field}: {value} {unit}; must be finite")


def check_size(field: str, value: float) -> None:
    """Refuse what is not positive, finite and large enough to be seen."""
    if not MIN_SIZE <= value <= MAX_COORDINATE:
        raise TestbedError(f"{field}: {value} m; must be from {MIN_SIZE} to {MAX_COORDINATE:g} m")


def check_height(height: float) -> None:
    """Refuse what the lidar could look over."""
    if not MIN_HEIGHT <= height <= MAX_COORDINATE:
        raise TestbedError(
            f"height: {height} m; must be at least {MIN_HEIGHT:.3f} m and finite: "
            f"the lidar sees nothing lower (its plane is at {LIDAR_PLANE_HEIGHT:.3f} m)"
        )


def count_distinct(points: tuple[Point, ...]) -> int:
    """How many points differ, by what a wall takes for one point; counts no farther than 3."""
    kept: list[Point] = []
    for point in points:
        if all(math.dist(point, other) >= SAME_POINT for other in kept):
            kept.append(point)
        if len(kept) == 3:
            break
    return len(kept)
