"""Turns a wanted twist into one that keeps out of the way of what moves: slow, stand, step aside.

A robot of 0.2 m/s cannot outrun anybody, and a robot that stands is walked round or into, but runs
into nobody. So it stands where that is enough, and steps aside where somebody comes straight at it.
Where many walk about, each step aside may undo what it had got on; then it only stands.
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import product

import numpy as np
from numpy.typing import NDArray

from mapping.burger import ROBOT_RADIUS
from mapping.errors import TestbedError
from mapping.geometry import Pose
from mapping.messages import Twist
from nav.movers import Mover
from nav.patience import Patience

SHARES = (1.0, 0.5, 0.0)
"""Shares of the wanted twist that are tried, in turn."""


@dataclass(frozen=True, slots=True, kw_only=True)
class YieldingConfig:
    """How much room others are given."""

    room: float = ROBOT_RADIUS + 0.28
    """Distance of centres to keep [m]: the robot's radius, a person's legs (0.16 m from the middle
    to the outside) and 0.12 m for what they do next."""
    touch: float = ROBOT_RADIUS + 0.20
    """Distance of centres at which legs may touch the robot [m]: it drives no nearer than this. Its
    corners lie 0.02 m outside its radius, and a slow walker's feet 0.02 m outside the stride."""
    straight_away: float = 0.7
    """A way leads straight away from somebody if the distance grows by this share of it:
    within 45 degrees."""
    stride: float = 0.3
    """A foot is as far ahead or behind as the middle goes in this time [s]."""
    horizon: float = 2.4
    """How far ahead others are foreseen [s]."""
    committed: float = 0.5
    """The robot drives its twist so long before it can stand: an old scan and a period [s]."""
    step: float = 0.1
    """Time between the moments looked at [s]."""
    doubt: float = 0.6
    """What has been seen once may be going any way this fast [m/s]."""
    aside_speed: float = 0.2
    """Speed of stepping aside [m/s]."""
    aside_turn: float = 1.5
    """Turn rate of stepping aside [rad/s]."""
    aside_time: float = 1.6
    """How long a step aside takes [s]."""
    kept_for: float = 0.5
    """How long the robot goes on with a step aside before it thinks again [s]."""
    worth: float = 0.05
    """A step aside must give so much more room than standing [m]."""
    patience: float = 10.0
    """After giving way for so long without getting on, the robot steps aside no more [s]."""
    progress: float = 1.0
    """It has got on when it is so far from where the count began [m]."""

    def __post_init__(self) -> None:
        """Refuse figures that foresee nothing."""
        for name in self.__slots__:
            if not (math.isfinite(getattr(self, name)) and getattr(self, name) > 0.0):
                raise TestbedError(f"yielding {name}: {getattr(self, name)}; must be above 0")


Allowed = Callable[[Twist], bool]
"""Whether a twist runs into nothing that stands."""


class Yielding:
    """Chooses each period; remembers the step aside that is going on."""

    def __init__(self, config: YieldingConfig | None = None) -> None:
        self.config = config or YieldingConfig()
        self._aside = Twist()
        self._aside_until = -math.inf
        self._patience = Patience(reach=self.config.progress, limit=self.config.patience)

    def limit(
        self, wanted: Twist, pose: Pose, time: float, movers: Sequence[Mover], allowed: Allowed
    ) -> Twist:
        """The twist for now: what is wanted where nobody comes near, else slower, none, or aside.

        Args:
            wanted: What the navigator wants.
            pose: Pose of base_footprint in the map frame ``(3,)``.
            time: Now [s].
            movers: What moves.
            allowed: Tells which steps aside run into nothing that stands.
        """
        twist = self._choose(wanted, pose, time, movers, allowed)
        self._patience.note(pose[:2], time, gives_way=twist != wanted)
        return twist

    def _choose(
        self, wanted: Twist, pose: Pose, time: float, movers: Sequence[Mover], allowed: Allowed
    ) -> Twist:
        """What ``limit`` returns."""
        movers = [mover for mover in movers if not mover.is_known_to_stand]
        if not movers:
            return wanted
        outlook = _Outlook(pose, time, movers, self.config)
        if time < self._aside_until:
            if allowed(self._aside) and not outlook.may_be_run_into(self._aside):
                return self._aside
            self._aside_until = -math.inf
        for share in SHARES:
            twist = Twist(linear_x=share * wanted.linear_x, angular_z=share * wanted.angular_z)
            has_room = outlook.room(twist, self.config.committed) >= self.config.room
            if has_room and not outlook.may_be_run_into(twist):
                return twist
        if self._patience.is_out:
            return Twist()
        self._aside = self._step_aside(outlook, allowed)
        if self._aside != Twist():
            self._aside_until = time + self.config.kept_for
        return self._aside

    def _step_aside(self, outlook: "_Outlook", allowed: Allowed) -> Twist:
        """The step aside that leaves most room, or none if that is not worth it."""
        config = self.config
        best, most = Twist(), outlook.room(Twist(), 0.0) + config.worth
        speeds = (config.aside_speed, -config.aside_speed)
        turns = (0.0, config.aside_turn, -config.aside_turn)
        for speed, turn in product(speeds, turns):
            twist = Twist(linear_x=speed, angular_z=turn)
            room = outlook.room(twist, config.aside_time)
            if room > most and allowed(twist) and not outlook.may_be_run_into(twist):
                best, most = twist, room
        return best


class _Outlook:
    """Where others are going to be, and how near the robot comes to them."""

    def __init__(
        self, pose: Pose, time: float, movers: Sequence[Mover], config: YieldingConfig
    ) -> None:
        self._pose, self._config = pose, config
        self._times = np.arange(0.0, config.horizon + 0.5 * config.step, config.step)
        leads = np.arange(-config.stride, config.stride + 0.5 * config.step, config.step)
        moments = time + self._times[:, None] + leads
        places = np.array([mover.place for mover in movers])
        velocities = np.array([mover.velocity for mover in movers])
        stamps = np.array([mover.stamp for mover in movers])
        ages = moments - stamps[:, None, None]
        self._places = places[:, None, None] + ages[..., None] * velocities[:, None, None]
        self._seen, self._ages = places, time - stamps
        self._paces = np.array([self._pace_of(mover) for mover in movers])
        self._doubt = config.doubt * self._times / np.array([[mover.sightings] for mover in movers])

    def _pace_of(self, mover: Mover) -> float:
        """How fast somebody may set out in another direction [m/s]."""
        return max(mover.pace, self._config.doubt / mover.sightings)

    def room(self, twist: Twist, driven_for: float) -> float:
        """The least distance of centres [m] when a twist is driven so long [s], then none."""
        return float((self._gaps(twist, driven_for).min(axis=2) - self._doubt).min())

    def may_be_run_into(self, twist: Twist) -> bool:
        """Whether the robot may still be moving when it touches somebody, if he turns now.

        People turn on the spot, and it takes a second until their way tells. Straight away from
        somebody the robot may go, unless it is among his feet already, and stand it may always.
        """
        if twist == Twist():
            return False
        config = self._config
        soon = self._times[self._times <= config.committed]
        robot = self._driven(twist, soon)
        gaps = np.linalg.norm(self._seen[:, None] - robot, axis=2)
        walked = self._paces[:, None] * (self._ages[:, None] + soon)
        in_reach = (gaps - walked < config.touch).any(axis=1)
        way = float(np.hypot(*(robot[-1] - robot[0])))
        flees = (gaps[:, -1] - gaps[:, 0] >= config.straight_away * way) & (way > 0.0)
        is_close = gaps[:, 0] < config.room
        return bool((in_reach & (is_close | ~flees)).any())

    def _gaps(self, twist: Twist, driven_for: float) -> NDArray[np.float64]:
        """Distances of centres to everybody, at every time and part of a stride ``(m, t, s)``."""
        robot = self._driven(twist, np.minimum(self._times, driven_for))
        return np.asarray(np.linalg.norm(self._places - robot[:, None], axis=3))

    def _driven(self, twist: Twist, times: NDArray[np.float64]) -> NDArray[np.float64]:
        """Where the robot is after driving a twist for some times ``(t,)``: ``(t, 2)`` [m]."""
        half_turn = 0.5 * twist.angular_z * times
        chord = twist.linear_x * times * np.sinc(half_turn / np.pi)
        heading = self._pose[2] + half_turn
        way = chord[:, None] * np.column_stack((np.cos(heading), np.sin(heading)))
        return np.asarray(self._pose[:2] + way)
