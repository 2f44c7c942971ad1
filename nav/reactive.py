"""Drive and avoid, without a map: straight on while it is open, else turn to the open side.

The level of the thesis's ``autonomous_nav``: it wanders and never knows when it is done.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mapping.geometry import Pose
from mapping.grid import OccupancyGrid
from mapping.messages import LaserScan, Twist
from nav.motion_limits import MotionLimits
from nav.navigator import RUNNING, ChosenGoal, DroppedFrontier, Plan


@dataclass(frozen=True, slots=True, kw_only=True)
class ReactiveConfig:
    """When to turn and how fast to go."""

    limits: MotionLimits = MotionLimits()
    stop_distance: float = 0.30
    """Clear way ahead below which the robot stops and turns [m from the lidar]."""
    slow_distance: float = 0.8
    """Clear way ahead below which it slows down [m from the lidar]."""
    slowest_share: float = 0.2
    """Share of the top speed that is driven where it is tight ahead."""
    corridor_half_width: float = 0.14
    """Returns ahead count when they lie this close to the line ahead [m]."""
    turn_speed: float = 1.0
    """[rad/s]."""
    clear_to_go: float = 0.5
    """Clear way ahead at which turning ends [m]."""


class Reactive:
    """Wanders by the newest scan alone; keeps only which way it is turning."""

    def __init__(self, config: ReactiveConfig | None = None) -> None:
        self.config = config or ReactiveConfig()
        self.plan = Plan()
        self.status = RUNNING
        self.dropped_frontiers: tuple[DroppedFrontier, ...] = ()
        self.goals: tuple[ChosenGoal, ...] = ()
        self.decisions = 0
        self._last = Twist()
        self._turning = 0.0

    def command(self, grid: OccupancyGrid, pose_map: Pose, scan: LaserScan | None) -> Twist:
        """Forward at a speed that suits the clear way ahead, or a turn towards the open side."""
        wanted = Twist() if scan is None else self._react(scan)
        self._last = self.config.limits.approach(wanted, self._last)
        return self._last

    def _react(self, scan: LaserScan) -> Twist:
        config = self.config
        points = _points_sensor(scan)
        ahead = points[(points[:, 0] > 0.0) & (np.abs(points[:, 1]) < config.corridor_half_width)]
        clear = float(ahead[:, 0].min()) if len(ahead) else scan.range_max
        if clear > config.clear_to_go or (self._turning == 0.0 and clear > config.stop_distance):
            self._turning = 0.0
            share = (clear - config.stop_distance) / (config.slow_distance - config.stop_distance)
            return Twist(
                linear_x=config.limits.max_linear * float(np.clip(share, config.slowest_share, 1.0))
            )
        if self._turning == 0.0:
            self._turning = 1.0 if _openness(points, 1.0) >= _openness(points, -1.0) else -1.0
        return Twist(angular_z=self._turning * config.turn_speed)


def _points_sensor(scan: LaserScan) -> NDArray[np.float64]:
    """End points ``(n, 2)`` of the beams that hit something, in the sensor frame [m]."""
    good = (scan.ranges >= scan.range_min) & (scan.ranges <= scan.range_max)
    ranges, angles = scan.ranges[good].astype(np.float64), scan.angles[good]
    return np.column_stack((ranges * np.cos(angles), ranges * np.sin(angles)))


def _openness(points: NDArray[np.float64], side: float) -> float:
    """Median distance of what lies ahead on one side (+1 left, -1 right); inf when nothing does."""
    on_side = points[(points[:, 0] > 0.0) & (side * points[:, 1] > 0.0)]
    return float(np.median(np.hypot(*on_side.T))) if len(on_side) else float(np.inf)
