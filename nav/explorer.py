"""Explores until no frontier is worth the way, then drives home: the ``frontier`` navigator.

Each period: follow the path, under the safety layer's eye. Now and then, or when something calls
for it, look at the map again and decide anew. A robot that makes no headway recovers; a frontier
that cannot be had is given up with a reason, and tried again at the end, by another way if any.
"""

import math
from enum import Enum, auto

import numpy as np

from mapping.geometry import Pose, compose, inverse
from mapping.grid import OccupancyGrid
from mapping.messages import LaserScan, Twist
from nav.costmap import Costmap
from nav.decision import choose
from nav.driver import Driver
from nav.explorer_config import ExplorerConfig
from nav.given_up import GivenUp
from nav.loyalty import Loyalty
from nav.map_jump import shift_at
from nav.navigator import (
    COMPLETE,
    RUNNING,
    STUCK,
    UNREACHABLE_START,
    ChosenGoal,
    DroppedFrontier,
    Plan,
)
from nav.outlook import Outlook
from nav.place_memory import PlaceMemory
from nav.planner import CostField
from nav.pursuit import Pursuit
from nav.viewpoint import Viewpoint, gain_at

NOTHING_NEW = "its viewpoints showed nothing new"
NO_HEADWAY = "no headway on the way there"
NO_TIME_LEFT = "not visited before the run ended"
"""Why a frontier is given up."""

RIM = 4
"""What a viewpoint would show depends on so many cells more than the lidar is counted on to see:
on whether what it sees last is a hole in a wall."""


class Task(Enum):
    """What the explorer is at."""

    EXPLORE = auto()
    GO_HOME = auto()


class FrontierExplorer:
    """Frontier exploration on the mapper's grid."""

    def __init__(self, config: ExplorerConfig | None = None) -> None:
        self.config = config or ExplorerConfig()
        self.status = RUNNING
        self.goals: tuple[ChosenGoal, ...] = ()
        self.decisions = 0
        self._costmap = Costmap(self.config.costmap)
        self._driver = Driver(self.config.driver)
        self._given_up = GivenUp()
        self._outlook = Outlook(self.config)
        self._places = PlaceMemory(self.config.visited_places, self.config.former_walls)
        self._loyalty = Loyalty()
        self._task = Task.EXPLORE
        self._home: Pose | None = None
        self._target: Viewpoint | None = None
        self._goal: np.ndarray | None = None
        self._tries = 0
        self._pursuit = Pursuit()
        self._shift = 0.0
        self._decided_at = self._glanced_at = self._looked_at = -np.inf

    @property
    def plan(self) -> Plan:
        """The way ahead, the goal and the frontiers of the last decision."""
        middles = [frontier.middle for frontier in self._outlook.frontiers]
        return Plan(
            path=self._driver.path_ahead if self._goal is not None else np.zeros((0, 2)),
            goal=self._goal,
            frontiers=np.array(middles).reshape(-1, 2),
        )

    @property
    def dropped_frontiers(self) -> tuple[DroppedFrontier, ...]:
        """The frontiers of the last decision that were given up; of a run cut short, all."""
        return self._given_up.left_over(
            self._outlook.frontiers, NO_TIME_LEFT if self.status == RUNNING else None
        )

    def command(self, grid: OccupancyGrid, pose_map: Pose, scan: LaserScan | None) -> Twist:
        """The velocity for the next control period; zero once the status is final."""
        if self._home is None:
            self._home = pose_map.copy()
        driver = self._driver
        driver.see(grid, pose_map, scan)
        if driver.jump is not None:
            self._note_jump(driver.jump, pose_map)
        if driver.has_new_scan:
            self._places.note_scan(self._costmap, pose_map[:2], driver.newest_view)
        if self.status != RUNNING or driver.is_looking:
            return driver.stand()
        if driver.is_recovering:
            twist = driver.recover()
            if twist is not None:
                return twist
            self._forget_goal()
        if self._must_decide(grid, pose_map):
            self._decide(grid, pose_map)
        if self.status != RUNNING or self._goal is None:
            return driver.stand()
        if driver.gets_nowhere():
            self._start_recovery()
            return driver.stand()
        return driver.follow(self._costmap.clearance_at((float(pose_map[0]), float(pose_map[1]))))

    def _note_jump(self, jump: Pose, pose: Pose) -> None:
        """Plan anew on a map drawn anew, and forget what is no longer where it was.

        Home stays: it is where the map began. Frontiers that were given up stay so, or no end
        would be in sight; one that is wrongly taken for such a one has its second chance.
        """
        self._decided_at = -np.inf
        self._places.note_redraw()
        self._shift += shift_at(jump, compose(inverse(jump), pose))
        if self._shift > self.config.memory_shift:
            self._shift = 0.0
            self._places.forget()

    def _must_decide(self, grid: OccupancyGrid, pose: Pose) -> bool:
        """Whether the way on is in question."""
        if self._goal is None or self._has_arrived(grid, pose):
            return True
        if self.status != RUNNING:
            return False
        driver = self._driver
        return self._is_due(grid, pose) or (driver.has_new_scan and driver.path_is_blocked())

    def _has_arrived(self, grid: OccupancyGrid, pose: Pose) -> bool:
        """Whether the goal is reached; says what came of it."""
        if self._goal is None:
            return False
        gap = math.hypot(self._goal[0] - pose[0], self._goal[1] - pose[1])
        if self._task is Task.GO_HOME:
            if gap < self.config.home_tolerance:
                self._finish(COMPLETE)
            return False
        if gap >= self.config.arrived:
            return False
        self._judge_arrival(grid, pose)
        return True

    def _judge_arrival(self, grid: OccupancyGrid, pose: Pose) -> None:
        """Take note if the viewpoint shows nothing of what it promised."""
        target = self._target
        if target is None:
            return
        left = self._gain_left(grid, pose, target)
        if left > self.config.phantom_share * target.gain:
            self._given_up.disappoint(target, NOTHING_NEW)

    def _is_due(self, grid: OccupancyGrid, pose: Pose) -> bool:
        """Whether it is time to decide anew: long ago, or the goal has lost its worth."""
        now = self._driver.time
        if self._task is Task.GO_HOME:
            return now - self._decided_at > self.config.replan_home_every
        if now - self._decided_at > self.config.decide_every:
            return True
        if now - self._glanced_at < self.config.glance_every or self._target is None:
            return False
        self._glanced_at = now
        left = self._gain_left(grid, pose, self._target)
        return left < self.config.worth_left * self._target.gain

    def _gain_left(self, grid: OccupancyGrid, pose: Pose, target: Viewpoint) -> float:
        """What a viewpoint would show now [m2]."""
        around = self.config.viewpoint.gain_range + RIM * self._costmap.resolution
        self._costmap.glance(grid, pose[:2], self._changed_reach(), target.place, around)
        self._places.returns.mark(self._costmap)
        return gain_at(self._costmap, target.place, self.config.viewpoint)

    def _look(self, grid: OccupancyGrid, pose: Pose) -> None:
        self._costmap.refresh(grid, pose[:2], self._changed_reach())
        self._places.mark(self._costmap, grid, pose[:2])
        self._looked_at = self._driver.time

    def _changed_reach(self) -> float:
        """How far from the robot the map may have changed since the last look [m]."""
        since = self._driver.time - self._looked_at
        return self.config.mapped_reach + since * self._driver.max_speed

    def _decide(self, grid: OccupancyGrid, pose: Pose) -> None:
        """Look at the map and set out for the best viewpoint, or home when none is left."""
        self.decisions += 1
        self._decided_at = self._glanced_at = self._driver.time
        self._look(grid, pose)
        if self._task is Task.EXPLORE:
            target, field = self._best_viewpoint(pose)
            if target is None and self._is_cut_off(field):
                self._start_recovery(UNREACHABLE_START)
                return
            if target is None and self._given_up.another_chance(2):
                target, field = self._best_viewpoint(pose)
            if target is None and self._reopen(grid, pose) and self._given_up.another_chance(3):
                target, field = self._best_viewpoint(pose)
            if target is not None:
                self._set_out(field, target.place, target)
                return
            body = np.pi * self.config.costmap.lethal_clearance**2
            if field.reached_area < body:  # hemmed in, or seeing nothing at all
                self._finish(UNREACHABLE_START)
                return
            self._task = Task.GO_HOME
        self._go_home(grid, pose)

    def _reopen(self, grid: OccupancyGrid, pose: Pose) -> bool:
        """Plan through gaps that were too narrow once more; False if there is none."""
        if not self._places.gaps.reopen():
            return False
        self._costmap.refresh(grid)
        self._places.mark(self._costmap, grid, pose[:2])
        return True

    def _best_viewpoint(self, pose: Pose) -> tuple[Viewpoint | None, CostField]:
        """Where to go next, and the cost field from here."""
        config, loyalty = self.config, self._loyalty
        field = CostField.around(self._costmap, pose[:2])
        worth_now = self._outlook.viewpoints(field, self._places, self._given_up, pose[:2])
        course = self._driver.course
        best = choose(worth_now, field, course, self._target, config.decision, loyalty.times)
        loyalty.note(self._target, best, self._costmap.free_area)
        if best is None and not self._is_cut_off(field):
            self._outlook.note_left_over(self._given_up)
        return best, field

    def _is_cut_off(self, field: CostField) -> bool:
        """Whether next to nothing of the known floor is in reach: that says nothing of frontiers.

        A robot that stands where its map knows nothing, or among things that were drawn around it,
        looks again before it gives up what it cannot reach.
        """
        return field.reached_area < self.config.cut_off * field.costmap.free_area

    def _go_home(self, grid: OccupancyGrid, pose: Pose) -> None:
        assert self._home is not None
        field = CostField.around(self._costmap, pose[:2])
        place = field.nearest_reached(self._home[:2], self.config.home_within)
        if place is None and self._reopen(grid, pose):
            field = CostField.around(self._costmap, pose[:2])
            place = field.nearest_reached(self._home[:2], self.config.home_within)
        if place is not None:
            self._set_out(field, place, None)
        elif float(np.hypot(*(self._home - pose)[:2])) < 2.0 * self.config.home_tolerance:
            self._finish(COMPLETE)
        else:
            self._start_recovery(UNREACHABLE_START)

    def _set_out(self, field: CostField, goal: np.ndarray, target: Viewpoint | None) -> None:
        if self._goal is None or float(np.hypot(*(self._goal - goal))) > self.config.arrived:
            self._driver.restart_headway()
        now = self._driver.time
        if target is not None and self._pursuit.take_up(target, now, self._costmap.free_area):
            self.goals = (*self.goals, ChosenGoal.at(now, target.place, target.frontier.middle))
            self._tries = 0  # for one frontier, recoveries add up
        if target is not None and self._pursuit.is_in_vain(now):
            self._given_up.give_up(target.frontier, NO_HEADWAY)
            self._forget_goal()
            return
        self._goal, self._target = goal.copy(), target
        self._driver.set_path(field.path_to(goal))

    def _start_recovery(self, in_vain: str = STUCK) -> None:
        """Recover; after too many look for another way, and give the robot up after far too many.

        ``in_vain`` is the status when recovering has not helped.
        """
        self._tries += 1
        if not self._driver.may_recover():
            self._finish(in_vain)
            return
        if self._tries > self.config.recoveries_per_goal:
            self._places.gaps.close(self._driver.place_ahead)
            self._tries = 0
            if self._target is not None:
                self._given_up.give_up(self._target.frontier, NO_HEADWAY)
                self._target = None
        self._driver.begin_recovery()

    def _forget_goal(self) -> None:
        self._goal, self._target = None, None
        self._driver.restart_headway()

    def _finish(self, status: str) -> None:
        self.status = status
        self._goal = None
