"""People on two legs: turns waypoints, a speed and a time into where each leg stands.

A person walks round a loop of waypoints, stopping for nothing and nobody. The feet do the walking:
one stands where it was set down while the other swings past it, straight to its next place.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from envs.pedestrian_kernels import feet_at_time
from envs.plan_checks import Point, check_points
from envs.wall_line import SAME_POINT
from mapping.errors import TestbedError

LEG_RADIUS = 0.06
"""Radius of a leg [m]: a shin in trousers, at the lidar's height."""

LEG_HEIGHT = 0.80
"""Height of a leg [m]: to the hip, far above any beam [assumption]."""

HIP_WIDTH = 0.20
"""How far apart the two feet's tracks run [m] [assumption: a little wider than people step, so that
the legs, which are upright here, do not pass through one another]."""

WALK_RATIO = 0.0065
"""Length of a step over steps a minute [m min]: about the same at every speed above 1 m/s (Sekiya
and Nagasaki 1998; Murakami and Otaka 2017, who find slow walkers to take somewhat longer ones)."""

TURN_LENGTH = 0.5
"""A turn at a waypoint is spread over so much of the way [m] [assumption]: about a step."""

MIN_SPEED, MAX_SPEED = 0.1, 2.0
"""From a shuffle to the end of walking [m/s]; people begin to run at about 2 m/s."""

MIN_ROUND = 1.0
"""The shortest loop [m]: two steps."""

Feet = NDArray[np.float64]


@dataclass(frozen=True, slots=True, kw_only=True)
class Pedestrian:
    """A person who walks round a loop for ever."""

    waypoints: tuple[Point, ...]
    """Corners of the loop [m]; the last leads back to the first."""
    speed: float = 0.8
    """Walking speed [m/s], 0.1 to 2."""
    phase: float = 0.0
    """Where on the loop the person is at time 0, as a share of it from the first waypoint on."""
    there_and_back: bool = False
    """Whether the way leads back from the last waypoint through all the others."""

    def __post_init__(self) -> None:
        """Refuse what nobody can walk."""
        check_points("waypoints", self.waypoints)
        if not MIN_SPEED <= self.speed <= MAX_SPEED:
            raise TestbedError(
                f"speed: {self.speed} m/s; must be from {MIN_SPEED:g} to {MAX_SPEED:g}"
            )
        if not 0.0 <= self.phase <= 1.0:
            raise TestbedError(f"phase: {self.phase}; must be a share of the loop, from 0 to 1")
        if not self.length >= MIN_ROUND:
            raise TestbedError(
                f"waypoints: {self.length:g} m round; a loop must be at least {MIN_ROUND:g} m"
            )

    @property
    def length(self) -> float:
        """Length of one round [m]."""
        return float(self.laid_out()[1][-1])

    @property
    def step_count(self) -> int:
        """Steps of one round: even, so that each round begins with the same foot."""
        natural = math.sqrt(60.0 * WALK_RATIO * self.speed)
        return 2 * max(1, round(self.length / (2.0 * natural)))

    def footsteps(self) -> Feet:
        """Where the feet are set down in one round ``(step_count, 2)`` [m], the left one first.

        Step ``k`` stands beside the middle of the ``k``-th part of the way, half a hip's width to
        its side of it.
        """
        halves = np.arange(self.step_count, dtype=np.float64) + 0.5
        middles: NDArray[np.float64] = halves * (self.length / self.step_count)
        headings = self._headings(middles)
        aside = np.where(np.arange(self.step_count) % 2 == 0, 0.5, -0.5) * HIP_WIDTH
        left = np.stack((-np.sin(headings), np.cos(headings)), axis=1)
        return np.asarray(self.middle_at(middles) + aside[:, None] * left)

    def middle_at(self, way: NDArray[np.float64]) -> Feet:
        """Where the body is after so much of the loop ``(n,)`` [m]: ``(n, 2)`` [m]."""
        corners, ways = self.laid_out()
        way = np.remainder(way, ways[-1])
        return np.stack([np.interp(way, ways, column) for column in corners.T], axis=1)

    def way_at(self, time: float) -> float:
        """How far round the loop the person is at a time [s], from the first waypoint on [m]."""
        length = self.length
        return (self.phase * length + self.speed * time) % length

    def laid_out(self) -> tuple[Feet, NDArray[np.float64]]:
        """Corners of the closed loop ``(m + 1, 2)``, and how far along each is ``(m + 1,)`` [m]."""
        back = self.waypoints[-2:0:-1] if self.there_and_back else ()
        kept: list[Point] = []
        for point in (*self.waypoints, *back, *self.waypoints[:1]):
            if not kept or math.dist(kept[-1], point) >= SAME_POINT:
                kept.append(point)
        corners = np.array(kept, dtype=np.float64).reshape(-1, 2)
        steps = np.hypot(*np.diff(corners, axis=0).T)
        return corners, np.concatenate(((0.0,), np.cumsum(steps)))

    def _headings(self, way: NDArray[np.float64]) -> NDArray[np.float64]:
        """Heading of the body ``(n,)`` [rad]: that of the way, averaged over ``TURN_LENGTH``."""
        corners, ways = self.laid_out()
        along = np.diff(corners, axis=0)
        headings = np.arctan2(along[:, 1], along[:, 0])
        turns = np.diff(headings, append=headings[0])
        # To the left by half a turn at most; whoever turns right round does so to the left.
        turns = math.pi - np.remainder(math.pi - turns, 2.0 * math.pi)
        unwound = headings[0] + np.concatenate(((0.0,), np.cumsum(turns)))
        rounds = np.concatenate([unwound[:-1] + k * (unwound[-1] - unwound[0]) for k in (-1, 0, 1)])
        edges = np.concatenate([ways[:-1] + k * ways[-1] for k in (-1, 0, 1)] + [2.0 * ways[-1:]])
        integral = np.concatenate(((0.0,), np.cumsum(rounds * np.diff(edges))))
        ends = way[:, None] + 0.5 * TURN_LENGTH * np.array((-1.0, 1.0))
        return np.diff(np.interp(ends, edges, integral), axis=1)[:, 0] / TURN_LENGTH


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Gaits:
    """The footsteps of several people, as the kernel wants them."""

    footsteps: Feet
    """All footsteps, one person after another ``(n, 2)`` [m]."""
    firsts: NDArray[np.int64]
    """Where each person's begin, and where the last one's end ``(p + 1,)``."""
    step_times: NDArray[np.float64]
    """How long a step takes each person ``(p,)`` [s]."""
    first_steps: NDArray[np.float64]
    """How many steps each has taken at time 0 ``(p,)``."""


def gaits_of(people: Sequence[Pedestrian]) -> Gaits:
    """How these people walk."""
    counts = np.array([person.step_count for person in people], dtype=np.int64)
    phases = np.array([person.phase for person in people], dtype=np.float64)
    rounds = np.array([person.length / person.speed for person in people], dtype=np.float64)
    steps = [person.footsteps() for person in people]
    return Gaits(
        footsteps=np.concatenate([np.empty((0, 2)), *steps]),
        firsts=np.concatenate((np.zeros(1, dtype=np.int64), np.cumsum(counts))),
        step_times=rounds / counts,
        first_steps=phases * counts,
    )


def feet_at(gaits: Gaits, time: float, feet: Feet | None = None) -> Feet:
    """Where the legs are at a time [s]: ``(2 p, 2)`` [m], each person's left leg, then the right.

    A function of time alone. A standing foot does not move; a swinging one sets off and comes down
    at rest, and moves at three times the walking speed in between.

    Args:
        gaits: Who walks.
        time: The time [s].
        feet: Array to put them into, two columns or more; a new one without it.
    """
    if feet is None:
        feet = np.empty((2 * len(gaits.step_times), 2))
    feet_at_time(gaits.footsteps, gaits.firsts, gaits.step_times, gaits.first_steps, time, feet)
    return feet


def positions_at(people: Sequence[Pedestrian], time: float) -> Feet:
    """Where the middles of people's bodies are at a time [s] ``(p, 2)`` [m]."""
    positions = np.empty((len(people), 2))
    for place, person in zip(positions, people, strict=True):
        place[:] = person.middle_at(np.array([person.way_at(time)]))[0]
    return positions
