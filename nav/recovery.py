"""Gets a robot that is blocked moving again: back off a little, then turn to the open side.

That is cheap, and enough where something passes by. Where it was not enough, the robot may stand in
a pocket in which it can neither back off straight nor turn: the next recovery manoeuvres out of it.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mapping.geometry import Pose, wrap_to_pi
from mapping.grid import OccupancyGrid
from mapping.messages import Twist
from nav.manoeuvre import NO_PLACES
from nav.manoeuvre_drive import ManoeuvreDrive, ManoeuvreDriveConfig
from nav.safety import SafetyConfig
from nav.spot_turn import SpotTurn

BACKING_PATIENCE = 1.5
"""Backing off may take this many times as long as it would unhindered."""


@dataclass(frozen=True, slots=True, kw_only=True)
class RecoveryConfig:
    """How a recovery moves."""

    back_off_speed: float = 0.06
    """[m/s]."""
    back_off_distance: float = 0.10
    """Of a first recovery [m]; each further one in a row doubles it."""
    longest_back_off: float = 0.8
    """[m]."""
    turn_speed: float = 0.8
    """[rad/s]."""
    facing: float = 0.3
    """Heading error at which the open side counts as faced [rad]."""
    time_limit: float = 6.0
    """A recovery ends this long after backing off whatever came of it [s]."""
    view: float = 1.0
    """Obstacles farther than this do not count when looking for the open side [m]."""
    manoeuvre: ManoeuvreDriveConfig = ManoeuvreDriveConfig()
    """How to get out of where that does not help."""
    manoeuvre_from: int = 2
    """So many recoveries in a row it takes until the robot manoeuvres."""
    beyond: float = 0.3
    """Of its way, what lies farther off than this is where it manoeuvres to, if it can [m]."""


class Recovery:
    """One recovery: begun, commanded each period, over when ``command`` returns None."""

    def __init__(
        self, config: RecoveryConfig | None = None, safety: SafetyConfig | None = None
    ) -> None:
        self.config = config or RecoveryConfig()
        self._start: Pose | None = None
        self._elapsed = 0.0
        self._heading: float | None = None
        self._distance = self.config.back_off_distance
        self._back_off = Twist()
        self._turn = SpotTurn()
        self._manoeuvre = ManoeuvreDrive(self.config.manoeuvre, safety)
        self._may_manoeuvre = self._elsewhere = False
        self._onward = NO_PLACES

    @property
    def active(self) -> bool:
        """Whether a recovery is going on."""
        return self._start is not None

    def begin(
        self,
        pose: Pose,
        in_a_row: int = 1,
        path: NDArray[np.float64] = NO_PLACES,
        gear: float = 1.0,
    ) -> None:
        """Start from here; the more recoveries in a row, the farther, and by other means.

        Args:
            pose: Pose of base_footprint in the map frame ``(3,)``.
            in_a_row: Which of them this one is.
            path: The way that the robot was to go on ``(n, 2)`` [m].
            gear: 1 when it drove forwards, -1 when backwards: it backs off the other way.
        """
        config = self.config
        away = np.hypot(path[:, 0] - pose[0], path[:, 1] - pose[1])
        near = away < config.manoeuvre.plan.reach
        within_reach = len(path) if near.all() else int(np.argmin(near))
        self._onward = path[:within_reach][away[:within_reach] > config.beyond]
        self._start, self._elapsed, self._heading = pose.copy(), 0.0, None
        self._back_off = Twist(linear_x=-gear * config.back_off_speed)
        farther = config.back_off_distance * 2.0 ** (in_a_row - 1)
        self._distance = min(farther, config.longest_back_off)
        self._may_manoeuvre = in_a_row >= config.manoeuvre_from
        self._elsewhere = in_a_row > config.manoeuvre_from

    def command(
        self, pose: Pose, points: NDArray[np.float64], grid: OccupancyGrid, period: float
    ) -> Twist | None:
        """The twist for the next period, or None when the recovery is over.

        Args:
            pose: Pose of base_footprint in the map frame ``(3,)``.
            points: Obstacle points in the map frame ``(n, 2)``.
            grid: The map, for obstacles that the points do not show.
            period: Control period [s].
        """
        if self._start is None:
            return None
        if self._may_manoeuvre:
            self._may_manoeuvre = False
            self._manoeuvre.begin(
                pose, points, grid, elsewhere=self._elsewhere, onward=self._onward
            )
        if self._manoeuvre.active:
            twist = self._manoeuvre.command(pose, points, grid, period)
            if twist is None:
                self._start = None
            return twist
        return self._back_off_and_turn(self._start, pose, points, period)

    def _back_off_and_turn(
        self, start: Pose, pose: Pose, points: NDArray[np.float64], period: float
    ) -> Twist | None:
        config = self.config
        self._elapsed += period
        backing_time = BACKING_PATIENCE * self._distance / config.back_off_speed
        if self._elapsed > config.time_limit + backing_time:
            self._start = None
            return None
        backed = float(np.hypot(*(pose[:2] - start[:2])))
        if self._heading is None and backed < self._distance and self._elapsed < backing_time:
            return self._back_off
        if self._heading is None:
            self._heading = open_heading(pose, points, config.view)
            error = float(wrap_to_pi(self._heading - pose[2]))
            self._turn.begin(float(np.copysign(1.0, error)), float(pose[2]))
        if abs(float(wrap_to_pi(self._heading - pose[2]))) < config.facing:
            self._start = None
            return None
        return Twist(angular_z=config.turn_speed * self._turn.update(float(pose[2]), period))


def open_heading(pose: Pose, points: NDArray[np.float64], view: float, sectors: int = 24) -> float:
    """The direction [rad, map frame] with the most space around it.

    Space is what the nearest points leave in each sector, summed over a sector and two neighbours
    on either side (75 degrees); of equals the first counter-clockwise from +x.

    Args:
        pose: Where the robot is ``(3,)``.
        points: Obstacle points in the map frame ``(n, 2)`` [m].
        view: Space beyond this does not count [m].
        sectors: How many sectors the circle has.
    """
    offsets = points - pose[:2]
    distances = np.hypot(offsets[:, 0], offsets[:, 1])
    near = distances < view
    bearing = np.mod(np.arctan2(offsets[near, 1], offsets[near, 0]), 2.0 * np.pi)
    sector = np.minimum((bearing / (2.0 * np.pi) * sectors).astype(int), sectors - 1)
    space = np.full(sectors, view)
    np.minimum.at(space, sector, distances[near])
    smooth = sum(np.roll(space, shift) for shift in (-2, -1, 0, 1, 2))
    return float(wrap_to_pi((int(np.argmax(smooth)) + 0.5) * 2.0 * np.pi / sectors))
