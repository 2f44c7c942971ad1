"""A last look before moving: slows or stops a twist that the scan says would touch something.

It can only slow down or stop, never steer. What the lidar is too near to see (closer than
``range_min``) is taken from the map.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mapping.burger import LIDAR_POSE_BASE, LIDAR_RANGE_MIN
from mapping.geometry import Pose
from mapping.grid import OccupancyGrid
from mapping.messages import Twist
from nav.outline import BURGER_OUTLINE, Rectangle
from nav.safety_kernels import clear_share


@dataclass(frozen=True, slots=True, kw_only=True)
class SafetyConfig:
    """The robot's outline and how far ahead it is moved along a twist."""

    outline: tuple[Rectangle, Rectangle] = BURGER_OUTLINE
    """The robot's outline."""
    margin: float = 0.02
    """Distance kept from everything [m]: six times the lidar's noise close by."""
    horizon: float = 0.6
    """How long the twist is followed ahead [s]: two scans and a control period old at worst."""
    steps: int = 6
    """Poses looked at along the way."""
    view: float = 0.6
    """Points farther from the robot than this cannot be reached in the horizon [m]."""


class Safety:
    """Keeps the newest obstacle points and checks twists against them."""

    def __init__(self, config: SafetyConfig | None = None) -> None:
        self.config = config or SafetyConfig()

    def limit(
        self, twist: Twist, pose: Pose, scan_points: NDArray[np.float64], grid: OccupancyGrid
    ) -> Twist:
        """The twist scaled by the largest of 1, 3/4, 1/2, 1/4, 0 that keeps the margin.

        A robot that already stands closer than the margin may move as long as it gets no closer.

        Args:
            twist: What the navigator wants.
            pose: Pose of base_footprint in the map frame ``(3,)``.
            scan_points: End points of the newest scan in the map frame ``(n, 2)`` [m].
            grid: The map, for what is too near to be seen.
        """
        config = self.config
        share = clear_share(
            scan_points,
            pose,
            twist.linear_x,
            twist.angular_z,
            config.outline,
            config.margin,
            config.horizon,
            config.steps,
            config.view,
            (LIDAR_POSE_BASE[0], LIDAR_RANGE_MIN),
            grid.log_odds,
            (float(grid.origin[0]), float(grid.origin[1]), grid.resolution),
            grid.config.occupied_above,
        )
        return Twist(linear_x=share * twist.linear_x, angular_z=share * twist.angular_z)
