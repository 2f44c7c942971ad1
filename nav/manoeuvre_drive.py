"""Drives a planned manoeuvre leg by leg, slowly, and plans anew where it does not come out so."""

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mapping.geometry import Pose
from mapping.grid import OccupancyGrid
from mapping.messages import Twist
from nav.manoeuvre import NO_PLACES, Leg, ManoeuvreConfig, plan_manoeuvre
from nav.manoeuvre_kernels import NO_MOVE
from nav.safety import SafetyConfig


@dataclass(frozen=True, slots=True, kw_only=True)
class ManoeuvreDriveConfig:
    """How a manoeuvre is driven, and when it is planned anew."""

    plan: ManoeuvreConfig = ManoeuvreConfig()
    speed: float = 0.06
    """[m/s]."""
    turn_speed: float = 0.6
    """[rad/s]."""
    slowest: float = 0.02
    """Speed at the end of a straight leg [m/s]."""
    slowest_turn: float = 0.1
    """Turn rate at the end of a turn [rad/s]."""
    near_enough: float = 0.004
    """A straight leg ends this far before its end [m]: two periods at the slowest speed."""
    turned_enough: float = 0.02
    """A turn ends this far before its end [rad]."""
    hold_gain: float = 1.0
    """Turn rate per error of the heading on a straight leg [1/s]."""
    off_the_way: float = 0.03
    """The robot is off the way when it is so far beside a leg or beyond its end [m]."""
    patience: float = 1.5
    """Time without headway after which it is planned anew [s]."""
    most_plans: int = 8
    """Plans of one manoeuvre after which it is over."""


class ManoeuvreDrive:
    """One manoeuvre at a time: begun, commanded each period, over when ``command`` gives None."""

    def __init__(
        self, config: ManoeuvreDriveConfig | None = None, safety: SafetyConfig | None = None
    ) -> None:
        self.config = config or ManoeuvreDriveConfig()
        self._safety = safety or SafetyConfig()
        self._legs: list[Leg] = []
        self._plans = 0
        self._left, self._waited = math.inf, 0.0
        self._ends: list[tuple[float, float]] = []
        self._avoided = self._wanted = self._begin = NO_PLACES

    @property
    def active(self) -> bool:
        """Whether a manoeuvre is going on."""
        return bool(self._legs)

    def begin(
        self,
        pose: Pose,
        points: NDArray[np.float64],
        grid: OccupancyGrid,
        *,
        elsewhere: bool = False,
        onward: NDArray[np.float64] = NO_PLACES,
    ) -> bool:
        """Plan a way out; False if none is needed or found.

        Args:
            pose: As the others, for ``plan_manoeuvre``.
            points: The same.
            grid: The same.
            elsewhere: Whether the last manoeuvres did not help: their ends are then avoided, unless
                there is room nowhere else. A pocket can widen again at its end.
            onward: Places on the way that the robot was to go ``(k, 2)`` [m]: room near one of them
                is better than any other.
        """
        self._ends = self._ends if elsewhere else []
        self._avoided, self._wanted = np.array(self._ends).reshape(-1, 2), onward
        self._begin = pose[None, :2].copy()
        self._plans = 0
        self._plan(pose, points, grid)
        if self._legs:
            self._ends.append((self._legs[-1].x, self._legs[-1].y))
        return self.active

    def command(
        self, pose: Pose, points: NDArray[np.float64], grid: OccupancyGrid, period: float
    ) -> Twist | None:
        """The twist for the next period [s], or None when there is no more to drive."""
        if self._legs and self._is_off(pose, period):
            in_vain = self._waited > self.config.patience
            barred = self._legs[0].kind if in_vain else NO_MOVE
            self._plan(pose, points, grid, barred)
        while self._legs and self._left_of(self._legs[0], pose) <= self._enough(self._legs[0]):
            self._next_leg()
        if not self._legs:
            return None
        leg, config = self._legs[0], self.config
        left = self._left_of(leg, pose)
        # no faster than the way left allows: the safety layer looks ahead beyond the leg's end
        pace = left / self._safety.horizon
        if leg.turns:
            return Twist(angular_z=leg.way * _clamp(pace, config.slowest_turn, config.turn_speed))
        error = math.remainder(leg.yaw - float(pose[2]), 2.0 * math.pi)
        return Twist(
            linear_x=leg.way * _clamp(pace, config.slowest, config.speed),
            angular_z=config.hold_gain * error,
        )

    def _is_off(self, pose: Pose, period: float) -> bool:
        """Whether the robot has left the way, or for too long got no farther along it."""
        leg, config = self._legs[0], self.config
        dx, dy = leg.x - float(pose[0]), leg.y - float(pose[1])
        if leg.turns:
            beside, headway = math.hypot(dx, dy), config.turned_enough
        else:
            beside = abs(math.cos(leg.yaw) * dy - math.sin(leg.yaw) * dx)
            headway = config.near_enough
        left = self._left_of(leg, pose)
        if left < self._left - headway:
            self._left, self._waited = left, 0.0
        else:
            self._waited += period
        return beside > config.off_the_way or self._waited > config.patience

    def _plan(
        self,
        pose: Pose,
        points: NDArray[np.float64],
        grid: OccupancyGrid,
        barred: int = NO_MOVE,
    ) -> None:
        """Plan on along the robot's way if there were one, else elsewhere, else anywhere."""
        self._next_leg()
        self._legs = []
        self._plans += 1
        if self._plans > self.config.most_plans:
            return
        if len(self._wanted):
            onward = {"wanted": self._wanted, "avoided": self._begin}
            self._legs = self._planned(pose, points, grid, **onward, barred=barred)
            self._wanted = self._wanted if self._legs else NO_PLACES
        if not self._legs and len(self._avoided):
            self._legs = self._planned(pose, points, grid, avoided=self._avoided, barred=barred)
            self._avoided = self._avoided if self._legs else NO_PLACES
        if not self._legs:
            self._legs = self._planned(pose, points, grid, barred=barred)

    def _planned(
        self, pose: Pose, points: NDArray[np.float64], grid: OccupancyGrid, **how: Any
    ) -> list[Leg]:
        return list(plan_manoeuvre(pose, points, grid, self.config.plan, self._safety, **how))

    def _next_leg(self) -> None:
        self._legs = self._legs[1:]
        self._left, self._waited = math.inf, 0.0

    def _enough(self, leg: Leg) -> float:
        return self.config.turned_enough if leg.turns else self.config.near_enough

    def _left_of(self, leg: Leg, pose: Pose) -> float:
        """How far it is to the end of a leg [rad or m]; below 0 beyond it."""
        if leg.turns:
            left = leg.way * (leg.yaw - float(pose[2]))
            # turns are less than a circle: what looks like nearly one more is a little too far
            return math.remainder(left - 0.5 * math.pi, 2.0 * math.pi) + 0.5 * math.pi
        along = math.cos(leg.yaw) * (leg.x - float(pose[0]))
        along += math.sin(leg.yaw) * (leg.y - float(pose[1]))
        return leg.way * along


def _clamp(value: float, low: float, high: float) -> float:
    return min(max(value, low), high)
