"""What every navigator does: look at the map, the pose and the scan, and say how to move."""

from dataclasses import dataclass, field
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from mapping.geometry import Pose
from mapping.grid import OccupancyGrid
from mapping.messages import LaserScan, Twist

RUNNING = "running"
COMPLETE = "complete"
STUCK = "stuck"
UNREACHABLE_START = "unreachable_start"


@dataclass(frozen=True, slots=True, kw_only=True)
class DroppedFrontier:
    """A frontier that was given up for good."""

    x: float
    """Where it lies in the map frame [m]."""
    y: float
    size_m: float
    """Its length [m]."""
    reason: str


@dataclass(frozen=True, slots=True, kw_only=True)
class ChosenGoal:
    """A place that the robot set out for, in the map frame as it then was."""

    time: float
    """When, by the scans' stamps [s]."""
    x: float
    """Where it is [m]."""
    y: float
    frontier_x: float | None = None
    """Middle of the frontier that is to be seen from there [m]; None of a place without one."""
    frontier_y: float | None = None

    @classmethod
    def at(
        cls, time: float, place: NDArray[np.float64], frontier: NDArray[np.float64] | None = None
    ) -> "ChosenGoal":
        """The goal at a place ``(2,)``, chosen at a time [s] for a frontier's middle ``(2,)``."""
        x, y = place.tolist()
        if frontier is None:
            return cls(time=time, x=x, y=y)
        frontier_x, frontier_y = frontier.tolist()
        return cls(time=time, x=x, y=y, frontier_x=frontier_x, frontier_y=frontier_y)


@dataclass(frozen=True, slots=True, kw_only=True)
class Plan:
    """What a navigator has in mind, for drawing and for reports."""

    path: NDArray[np.float64] = field(default_factory=lambda: np.zeros((0, 2)))
    """The way it wants to drive ``(n, 2)`` in the map frame [m]; empty when it has none."""
    goal: NDArray[np.float64] | None = None
    """Where it wants to get ``(2,)``."""
    frontiers: NDArray[np.float64] = field(default_factory=lambda: np.zeros((0, 2)))
    """Middles of the frontiers it knows ``(n, 2)``."""


class Navigator(Protocol):
    """Drives on what sensors and mapper say; never sees the truth."""

    @property
    def status(self) -> str:
        """``running``, or why it stopped: ``complete``, ``stuck``, ``unreachable_start``."""

    @property
    def plan(self) -> Plan:
        """What it has in mind now."""

    @property
    def dropped_frontiers(self) -> tuple[DroppedFrontier, ...]:
        """Frontiers given up for good, with the reason."""

    @property
    def goals(self) -> tuple[ChosenGoal, ...]:
        """What it set out for until now, in order, without the way home; none of one that roams."""

    @property
    def decisions(self) -> int:
        """How often it has weighed where to go until now."""

    def command(self, grid: OccupancyGrid, pose_map: Pose, scan: LaserScan | None) -> Twist:
        """The velocity for the next control period.

        Args:
            grid: The map so far, in the map frame.
            pose_map: Newest pose of base_footprint in the map frame ``(3,)``.
            scan: Newest whole scan; the same one may come again. None before the first.
        """
