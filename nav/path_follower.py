"""Turns a path and a pose into a twist: pure pursuit, slower in curves and near things.

Coulter 1992 for the arc to a point ahead, Macenski et al. 2023 (regulated pure pursuit) for
slowing by curvature, by clearance and on approach. The lidar sees all around, so the robot drives
backwards as well as forwards, and rather so than turn round.
"""

import math
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from mapping.errors import TestbedError
from mapping.geometry import Pose
from mapping.messages import Twist
from nav.motion_limits import MotionLimits
from nav.path_kernels import advance, point_ahead
from nav.spot_turn import SpotTurn

FORWARDS = 1.0

SHORTEST_LOOKAHEAD = 1e-3
"""A point nearer than this gives no curvature worth dividing by [m]."""


@dataclass(frozen=True, slots=True, kw_only=True)
class FollowerConfig:
    """How far ahead to look and when to slow down or turn on the spot."""

    limits: MotionLimits = MotionLimits()
    lookahead: float = 0.35
    """Distance along the path to the point steered for, in the open [m]."""
    tight_lookahead: float = 0.18
    """The same where it is tight: a shorter one cuts corners less [m]."""
    open_clearance: float = 0.30
    """Clearance from which it counts as open [m]."""
    tight_clearance: float = 0.12
    """Clearance at which it counts as tight [m]."""
    tight_speed: float = 0.10
    """Speed where it is tight [m/s]."""
    turn_on_spot_above: float = 1.0
    """Heading error from which the robot stops and turns [rad]."""
    drive_again_below: float = 0.35
    """Heading error at which it drives again [rad]."""
    reverse_above: float = 2.0
    """Heading error from which the robot goes on the other way round, backwards or forwards again,
    rather than turn [rad]; from pi on it never does."""
    unwind_above: float = 1.7
    """Heading error from which the robot may turn the long way round, if that undoes earlier turns
    [rad]: the error of the wheel base grows with the turns that are left standing."""
    wound_up_above: float = 1.6
    """Turns left standing from which it does so [rad]."""
    turn_gain: float = 4.0
    """Turn rate per heading error when turning on the spot [1/s]."""
    approach_gain: float = 1.2
    """Speed per distance left to the goal [1/s]."""
    creep_speed: float = 0.03
    """Slowest useful speed [m/s]."""

    def __post_init__(self) -> None:
        """Refuse figures by which the robot would not make up its mind."""
        if not self.reverse_above > 0.5 * math.pi:
            raise TestbedError(f"reverse_above: {self.reverse_above}; must be above a right angle")


class PathFollower:
    """Follows one path at a time; remembers how far along it is and how it moves."""

    def __init__(self, config: FollowerConfig | None = None) -> None:
        self.config = config or FollowerConfig()
        self.last = Twist()
        self._path: NDArray[np.float64] = np.zeros((0, 2))
        self._along: NDArray[np.float64] = np.zeros(0)
        self._progress = 0
        self._turn = SpotTurn()
        self._wound = 0.0
        self._yaw: float | None = None
        self._gear = FORWARDS

    @property
    def gear(self) -> float:
        """1 when the robot drives forwards, -1 when it drives backwards."""
        return self._gear

    @property
    def path_ahead(self) -> NDArray[np.float64]:
        """The part of the path still to drive ``(n, 2)``, a point every 5 cm or so."""
        return self._path[self._progress :]

    def set_path(self, path: NDArray[np.float64], spacing: float = 0.05) -> None:
        """Follow a new path ``(n, 2)`` [m] from its start."""
        self._path = _densify(path, spacing)
        steps = np.hypot(*np.diff(self._path, axis=0).T)
        self._along = np.concatenate(([0.0], np.cumsum(steps)))
        self._progress = 0

    def distance_left(self, pose: Pose) -> float:
        """Way left to the end of the path [m], from the nearest point of it not yet passed."""
        self._progress, left = advance(self._path, self._along, self._progress, pose)
        return float(left)

    def command(self, pose: Pose, clearance: float, may_reverse: bool = True) -> Twist:
        """The twist for the next period, within the limits; ``clearance`` is that of the robot.

        Without ``may_reverse`` the robot turns round where it would go backwards.
        """
        config = self.config
        left = self.distance_left(pose)
        openness = (clearance - config.tight_clearance) / (
            config.open_clearance - config.tight_clearance
        )
        openness = min(max(openness, 0.0), 1.0)
        lookahead = config.tight_lookahead + openness * (config.lookahead - config.tight_lookahead)
        x, y = point_ahead(self._path, self._along, self._progress, lookahead)
        ahead_x, ahead_y = x - float(pose[0]), y - float(pose[1])
        error = self._heading_error(math.atan2(ahead_y, ahead_x) - float(pose[2]), may_reverse)
        direction = self._turn_direction(error, float(pose[2]))
        wanted = (
            Twist(angular_z=direction * config.turn_gain * abs(error))
            if direction
            else self._arc(error, math.hypot(ahead_x, ahead_y), left, openness)
        )
        return config.limits.approach(wanted, self.last)

    def _heading_error(self, bearing: float, may_reverse: bool) -> float:
        """How far off the robot's front, or its back, the way ahead lies [rad].

        Front or back as the robot drives, which it changes when that spares it to turn round.
        """
        front = math.remainder(bearing, 2.0 * math.pi)
        back = math.remainder(bearing + math.pi, 2.0 * math.pi)
        if not may_reverse:
            self._gear = FORWARDS
        error, other = (front, back) if self._gear == FORWARDS else (back, front)
        if not may_reverse or self._turn.direction or abs(error) <= self.config.reverse_above:
            return error
        self._gear = -self._gear
        return other

    def _turn_direction(self, error: float, yaw: float) -> float:
        """Which way to turn on the spot, +1 or -1, or 0 to drive."""
        if self._yaw is not None:
            self._wound += math.remainder(yaw - self._yaw, 2.0 * math.pi)
        self._yaw = yaw
        config = self.config
        turn = self._turn
        if abs(error) < (config.drive_again_below if turn.direction else config.turn_on_spot_above):
            turn.end()
        elif turn.direction:
            turn.update(yaw, config.limits.period)
        else:
            short_way = math.copysign(1.0, error)
            winds_up = self._wound * short_way > config.wound_up_above
            unwinds = winds_up and abs(error) > config.unwind_above
            turn.begin(-short_way if unwinds else short_way, yaw)
        return turn.direction

    def _arc(self, error: float, distance: float, left: float, openness: float) -> Twist:
        """The arc to the point ahead, as fast as it, the clearance and the way left allow."""
        config = self.config
        limits = config.limits
        curvature = 2.0 * math.sin(error) / max(distance, SHORTEST_LOOKAHEAD)
        speed = config.tight_speed + openness * (limits.max_linear - config.tight_speed)
        speed = min(speed, config.creep_speed + config.approach_gain * left)
        if curvature != 0.0:
            speed = min(speed, limits.max_angular / abs(curvature))
        speed *= max(math.cos(error), 0.0)
        return Twist(linear_x=self._gear * speed, angular_z=speed * curvature)


def _densify(path: NDArray[np.float64], spacing: float) -> NDArray[np.float64]:
    """The same polyline with a point at least every ``spacing`` metres."""
    pieces = [path[:1]]
    for a, b in pairwise(path):
        count = max(1, int(np.ceil(np.hypot(*(b - a)) / spacing)))
        shares = np.arange(1, count + 1)[:, None] / count
        pieces.append(a + shares * (b - a))
    return np.concatenate(pieces)
