"""Drives along a path: follows it, keeps off things, notices when it gets nowhere and recovers.

Where to go and by what way is for others to say. Each period begins with ``see``; then come
``recover``, ``follow`` or ``stand``, each of which gives the twist for it.
"""

import math

import numpy as np
from numpy.typing import NDArray

from mapping.geometry import Pose
from mapping.grid import OccupancyGrid
from mapping.messages import LaserScan, Twist
from nav.driver_config import DriverConfig
from nav.headway import Headway
from nav.map_jump import MapJump
from nav.movers import Movers
from nav.path_follower import PathFollower
from nav.path_kernels import SEARCHED_POINTS, is_near
from nav.recovery import Recovery
from nav.safety import Safety
from nav.scan_points import ScanPoints, ScanView
from nav.yielding import Yielding

POINTS_AHEAD = 3
"""Points of the path, 5 cm apart, from the robot to where it looks for what stops it."""


class Driver:
    """The parts that turn a path into twists, and what they remember."""

    def __init__(self, config: DriverConfig | None = None) -> None:
        self.config = config or DriverConfig()
        self.period = self.config.follower.limits.period
        self.max_speed = self.config.follower.limits.max_linear
        self._follower = PathFollower(self.config.follower)
        self._safety = Safety(self.config.safety)
        self._recovery = Recovery(self.config.recovery, self.config.safety)
        self._scan_points = ScanPoints()
        self._movers = Movers(self.config.movers)
        self._yielding = Yielding(self.config.yielding)
        self._headway = Headway(self.config.headway)
        self._map_jump = MapJump()
        self._pose: Pose = np.zeros(3)
        self._elapsed = 0.0
        self._recoveries = 0
        self._recovered_at: Pose | None = None
        self._moved_at = -math.inf
        self.has_new_scan = False
        """Whether the newest scan came in this period."""
        self.jump: Pose | None = None
        """Where the old map lies in this period's map, if it was drawn anew, as ``MapJump``."""

    @property
    def time(self) -> float:
        """Time by the scans' stamps [s]."""
        return self._scan_points.time

    @property
    def is_looking(self) -> bool:
        """Whether the robot still stands to have a first look."""
        return self._elapsed < self.config.first_look

    @property
    def is_recovering(self) -> bool:
        """Whether a recovery is going on."""
        return self._recovery.active

    @property
    def path_ahead(self) -> NDArray[np.float64]:
        """The part of the path still to drive ``(n, 2)``."""
        return self._follower.path_ahead

    @property
    def course(self) -> Pose:
        """The robot's pose ``(3,)``, turned round when it drives backwards."""
        return self._pose + (0.0, 0.0, 0.0 if self._follower.gear > 0.0 else np.pi)

    @property
    def place_ahead(self) -> NDArray[np.float64]:
        """A point of the path 0.15 m or so ahead ``(2,)``; where the robot is, without a path."""
        path = self._follower.path_ahead
        return path[min(POINTS_AHEAD, len(path) - 1)] if len(path) else self._pose[:2]

    @property
    def newest_view(self) -> ScanView | None:
        """What the newest scan saw, near and far; None before there was one."""
        return self._scan_points.view

    def see(self, grid: OccupancyGrid, pose: Pose, scan: LaserScan | None) -> None:
        """Take the map, the pose and the scan of this period."""
        self._grid, self._pose = grid, pose
        self.jump = self._map_jump.update(grid, pose, self._follower.last, self.period)
        if self.jump is not None:
            self._scan_points.follow_jump(self.jump)
            self._movers.follow_jump(self.jump)
            self._headway.restart()
        self.has_new_scan = self._scan_points.update(
            scan, pose, self.period, self.config.obstacle_reach
        )
        if self.has_new_scan and self._scan_points.view is not None:
            self._movers.update(self._scan_points.view)
            if any(mover.is_known_to_move for mover in self._movers.known):
                self._moved_at = self.time
        self._elapsed += self.period

    def stand(self) -> Twist:
        """Do not move."""
        return self._move(Twist())

    def follow(self, clearance: float) -> Twist:
        """Drive on along the path; ``clearance`` is the room around the robot [m]."""
        may_reverse = self.time - self._moved_at > self.config.facing_time
        return self._move(self._follower.command(self._pose, clearance, may_reverse))

    def recover(self) -> Twist | None:
        """Go on with the recovery; None when it is over."""
        twist = self._recovery.command(
            self._pose, self._scan_points.points, self._grid, self.period
        )
        return None if twist is None else self._move(twist)

    def set_path(self, path: NDArray[np.float64]) -> None:
        """Follow a new path ``(n, 2)`` [m]."""
        self._follower.set_path(path)

    def restart_headway(self) -> None:
        """Have full patience again, as for a new goal."""
        self._headway.restart()

    def gets_nowhere(self) -> bool:
        """Whether the robot, wanting to move, has not for too long; ask once a period."""
        return self._headway.is_lost(self._pose, self.period)

    def path_is_blocked(self) -> bool:
        """Whether the newest returns lie on the next stretch of the path."""
        path = self._follower.path_ahead[:SEARCHED_POINTS]
        return bool(is_near(self._scan_points.points, path, self.config.path_clearance))

    def may_recover(self) -> bool:
        """Count a recovery here; False after too many in a row, when the robot is stuck."""
        got_on = self._recovered_at is None or (
            math.dist(self._recovered_at[:2], self._pose[:2]) > self.config.got_on
        )
        self._recoveries = 1 if got_on else self._recoveries + 1
        self._recovered_at = self._pose.copy()
        self._headway.restart()
        return self._recoveries <= self.config.recoveries_in_a_row

    def begin_recovery(self) -> None:
        """Back off from here and turn to the open side, after ``may_recover``."""
        follower = self._follower
        self._recovery.begin(self._pose, self._recoveries, follower.path_ahead, follower.gear)

    def _move(self, wanted: Twist) -> Twist:
        """The twist that is safe, remembered as the one to accelerate from."""
        twist = self._safe(self._give_way(wanted))
        self._follower.last = twist
        return twist

    def _give_way(self, wanted: Twist) -> Twist:
        """The twist that keeps out of the way of what moves; waiting for it is no lost headway."""
        twist = self._yielding.limit(
            wanted,
            self._pose,
            self.time,
            self._movers.known,
            lambda each: self._safe(each) == each,
        )
        if twist != wanted:
            self._headway.restart()
        return twist

    def _safe(self, twist: Twist) -> Twist:
        return self._safety.limit(twist, self._pose, self._scan_points.points, self._grid)
