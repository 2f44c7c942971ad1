"""Drives through given places in the map frame, one after another: the ``waypoints`` navigator.

The way to each is planned on the map so far and, where nothing is known yet, over the unknown; it
is planned anew as the map grows. A robot that makes no headway recovers, and after too many
recoveries in a row it is stuck.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from mapping.burger import LIDAR_RANGE_MAX
from mapping.errors import TestbedError
from mapping.geometry import Pose
from mapping.grid import OccupancyGrid
from mapping.messages import LaserScan, Twist
from nav.costmap import Costmap, CostmapConfig
from nav.driver import Driver
from nav.driver_config import DriverConfig
from nav.navigator import COMPLETE, RUNNING, STUCK, ChosenGoal, DroppedFrontier, Plan
from nav.planner import CostField
from nav.route import checked_route
from nav.unknown_ground import with_unknown_ground


@dataclass(frozen=True, slots=True, kw_only=True)
class WaypointsConfig:
    """The parts that drive, and what counts as there."""

    costmap: CostmapConfig = CostmapConfig()
    driver: DriverConfig = DriverConfig()
    passed: float = 0.20
    """Distance to a waypoint at which it is passed [m]."""
    arrived: float = 0.08
    """Distance to the last waypoint at which it is reached [m]."""
    near_enough: float = 0.35
    """A waypoint that something stands on, or that drift has moved into a wall, is made for this
    near [m]."""
    plan_every: float = 2.0
    """Longest time between two plans [s]: the lidar sees 3.5 m, the robot drives 0.4 m."""
    mapped_reach: float = LIDAR_RANGE_MAX + 0.3
    """How far from itself the robot may change the map [m], as the explorer has it."""

    def __post_init__(self) -> None:
        """Refuse distances at which nothing is reached."""
        for name in ("passed", "arrived", "near_enough", "plan_every"):
            if not getattr(self, name) > 0.0:
                raise TestbedError(f"waypoints {name}: {getattr(self, name)}; must be above 0")


class Waypoints:
    """A tour through places, in order."""

    def __init__(self, places: ArrayLike, config: WaypointsConfig | None = None) -> None:
        self.config = config or WaypointsConfig()
        self.status = RUNNING
        self.dropped_frontiers: tuple[DroppedFrontier, ...] = ()
        self.goals: tuple[ChosenGoal, ...] = ()
        self.decisions = 0
        self._places = checked_route(places)
        self._next = 0
        self._costmap = Costmap(self.config.costmap)
        self._driver = Driver(self.config.driver)
        self._goal: NDArray[np.float64] | None = None
        self._planned_at = self._looked_at = -np.inf

    @property
    def plan(self) -> Plan:
        """The way ahead and the place that it leads to."""
        if self._goal is None:
            return Plan()
        return Plan(path=self._driver.path_ahead, goal=self._goal)

    def command(self, grid: OccupancyGrid, pose_map: Pose, scan: LaserScan | None) -> Twist:
        """The velocity for the next control period; zero once the status is final."""
        driver = self._driver
        driver.see(grid, pose_map, scan)
        if self.status != RUNNING or driver.is_looking:
            return driver.stand()
        if driver.is_recovering:
            twist = driver.recover()
            if twist is not None:
                return twist
            self._planned_at = -np.inf
        self._pass_waypoints(pose_map)
        if self.status == RUNNING and self._must_plan():
            self._make_plan(grid, pose_map)
        if self.status != RUNNING or driver.is_recovering or self._goal is None:
            return driver.stand()
        if driver.gets_nowhere():
            self._start_recovery()
            return driver.stand()
        place = (float(pose_map[0]), float(pose_map[1]))
        return driver.follow(self._costmap.clearance_at(place))

    def _pass_waypoints(self, pose: Pose) -> None:
        """Go on to the next waypoint when this one is reached, or complete the tour."""
        if self._goal is None:
            return
        is_last = self._next == len(self._places) - 1
        gap = float(np.hypot(*(self._goal - pose[:2])))
        if gap > (self.config.arrived if is_last else self.config.passed):
            return
        if float(np.hypot(*(self._goal - self._places[self._next]))) > self.config.near_enough:
            return  # only a step towards it, as far as a way was known
        self._next += 1
        self._goal = None
        self._driver.restart_headway()
        if is_last:
            self.status = COMPLETE

    def _must_plan(self) -> bool:
        driver = self._driver
        return (
            self._goal is None
            or driver.jump is not None
            or driver.time - self._planned_at > self.config.plan_every
            or (driver.has_new_scan and driver.path_is_blocked())
        )

    def _make_plan(self, grid: OccupancyGrid, pose: Pose) -> None:
        """Look at the map and plan the way to the next waypoint, or as near as one leads."""
        config, driver = self.config, self._driver
        reach = config.mapped_reach + (driver.time - self._looked_at) * driver.max_speed
        self._costmap.refresh(grid, pose[:2], reach)
        self._planned_at = self._looked_at = driver.time
        place = self._places[self._next]
        if len(self.goals) == self._next:
            self.goals = (*self.goals, ChosenGoal.at(driver.time, place))
        ground = with_unknown_ground(self._costmap, np.array([place, pose[:2]]))
        field = CostField.around(ground, pose[:2])
        goal = place if field.reaches(place) else _nearest_reached(field, place)
        is_in_sight = bool(np.all(ground.world_to_cell(place) < ground.states.shape))
        is_in_sight = is_in_sight and bool(np.all(ground.world_to_cell(place) >= 0))
        if is_in_sight and float(np.hypot(*(goal - place))) > config.near_enough:
            self._start_recovery()
            return
        self._goal = goal
        driver.set_path(field.path_to(goal))

    def _start_recovery(self) -> None:
        if self._driver.may_recover():
            self._driver.begin_recovery()
        else:
            self.status, self._goal = STUCK, None


def _nearest_reached(field: CostField, place: NDArray[np.float64]) -> NDArray[np.float64]:
    """The place ``(2,)`` nearest to another that a way leads to; the start of the field if none."""
    reached = field.costmap.cell_to_world(np.argwhere(np.isfinite(field.cost_to_come)))
    return np.asarray(reached[np.argmin(np.hypot(*(reached - place).T))])
