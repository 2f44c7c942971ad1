"""Turns scans into the things that move: where they are and how fast they go.

What is now where earlier scans saw nothing has come there. That tells a leg that was just set down
from the leg of a chair, however still both stand; what was hidden before is not taken for it.
"""

import math
from collections import deque
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from mapping.errors import TestbedError
from mapping.geometry import Pose, transform_points
from nav.legs import NO_LEGS, hanging_together, has_neighbour, legs_of, parted
from nav.movers_kernels import seen_through
from nav.scan_points import ScanView

LEAST_SCANS = 3
"""So many earlier scans must have seen nothing: some may have failed to see a thin thing."""

LEAST_SPEED = 0.15
"""What goes slower than this after a few sightings stands still [m/s]."""


PACE_KEPT = 0.8
"""What a second without going so fast leaves of a pace."""


@dataclass(frozen=True, slots=True, kw_only=True)
class MoversConfig:
    """What counts as moving and how it is followed."""

    reach: float = 3.0
    """Things farther away than this are no concern [m]: 2 s for somebody who walks fast."""
    memory: float = 2.4
    """Scans are remembered so long [s]; a slow walker's foot stands still for 1.5 s."""
    recent: float = 0.4
    """Scans younger than this may have seen the same thing in the same place [s]."""
    aside: float = 0.10
    """Beams that pass so near a place tell of it [m]: more than a leg's radius, so that what peeps
    round a corner is not taken for moving."""
    margin: float = 0.15
    """Beams must have gone so much farther [m]: what matched poses may err by, and a leg."""
    share: float = 0.04
    """And so much for each metre: over three sigmas of the LDS-01's datasheet."""
    whole: float = 0.25
    """Returns of neighbouring beams up to this far apart are of one leg [m]: 0.07 m apart at most,
    and the noise of two beams at 3 m, four sigmas."""
    same: float = 0.75
    """Legs up to this far apart belong to one thing [m]: two in stride."""
    gate: float = 0.5
    """A thing seen again is at most this far from where it was expected [m]."""
    lost_after: float = 0.7
    """A thing not seen for so long is gone [s]: three scans."""
    place_gain: float = 0.6
    """Share of a surprise in the place that is believed."""
    speed_gain: float = 0.35
    """Share of a surprise in the place, over the time since the last scan, by which the velocity
    is corrected: an alpha-beta filter (Bar-Shalom et al. 2001, 6.5)."""
    max_speed: float = 1.6
    """Nothing goes faster indoors [m/s]."""

    def __post_init__(self) -> None:
        """Refuse figures that follow nothing."""
        for name in self.__slots__:
            if not (math.isfinite(getattr(self, name)) and getattr(self, name) > 0.0):
                raise TestbedError(f"movers {name}: {getattr(self, name)}; must be above 0")


@dataclass(slots=True, kw_only=True)
class Mover:
    """Something that moves."""

    place: NDArray[np.float64]
    """Middle of it ``(2,)`` in the map frame [m]."""
    velocity: NDArray[np.float64]
    """``(2,)`` [m/s]."""
    stamp: float
    """When it was seen last [s]."""
    sightings: int = 1
    """In how many scans."""
    pace: float = 0.0
    """How fast it went of late [m/s]: while somebody turns, the velocity tells less."""

    @property
    def is_known_to_stand(self) -> bool:
        """Whether it was seen often enough to tell that it goes nowhere."""
        return self.sightings > LEAST_SCANS and float(np.hypot(*self.velocity)) < LEAST_SPEED

    @property
    def is_known_to_move(self) -> bool:
        """Whether it was seen often enough to tell that it goes somewhere."""
        return self.sightings > LEAST_SCANS and not self.is_known_to_stand

    def at(self, time: float) -> NDArray[np.float64]:
        """Where it will be at a time, going on as it does ``(2,)``."""
        return np.asarray(self.place + (time - self.stamp) * self.velocity)


class Movers:
    """Remembers scans and follows what moves."""

    def __init__(self, config: MoversConfig | None = None) -> None:
        self.config = config or MoversConfig()
        self.known: list[Mover] = []
        """What moves, by the newest scan."""
        self._views: deque[ScanView] = deque()

    def update(self, view: ScanView) -> None:
        """Take a new scan; one without turn from beam to beam tells nothing."""
        if view.increment == 0.0:
            return
        self._follow(view.stamp, self._places(view.stamp, self._moving_legs(view)))
        self._views.append(view)
        while view.stamp - self._views[0].stamp > self.config.memory:
            self._views.popleft()

    def follow_jump(self, jump: Pose) -> None:
        """Move what is remembered into a map drawn anew, in which the old one lies at ``jump``."""
        turn = np.array([0.0, 0.0, jump[2]])
        self._views = deque(
            replace(
                view,
                origin=transform_points(jump, view.origin[None])[0],
                bearing=view.bearing + float(jump[2]),
            )
            for view in self._views
        )
        for mover in self.known:
            mover.place = transform_points(jump, mover.place[None])[0]
            mover.velocity = transform_points(turn, mover.velocity[None])[0]

    def _moving_legs(self, newest: ScanView) -> NDArray[np.float64]:
        """Middles of the legs ``(n, 2)`` whose points lie where nothing was."""
        config = self.config
        views = [
            view
            for view in self._views
            if newest.stamp - view.stamp >= config.recent and len(view.ranges) == len(newest.ranges)
        ]
        offsets = newest.points - newest.origin
        is_near = np.hypot(offsets[:, 0], offsets[:, 1]) < config.reach
        near = newest.points[is_near]
        if len(views) < LEAST_SCANS or len(near) == 0:
            return NO_LEGS
        counts = seen_through(
            near,
            np.array([view.origin for view in views]),
            np.array([view.bearing for view in views]),
            np.array([view.increment for view in views]),
            np.array([view.ranges for view in views]),
            config.aside,
            config.margin,
            config.share,
        )
        came = counts >= LEAST_SCANS
        if not came.any():
            return NO_LEGS
        points, beams = near[came], newest.beams[is_near][came]
        wide = has_neighbour(points, beams, len(newest.ranges), config.whole)
        return legs_of(points[wide], newest.origin)

    def _places(self, stamp: float, legs: NDArray[np.float64]) -> list[NDArray[np.float64]]:
        """Middles of those who walk on legs ``(n, 2)`` [m].

        Each leg counts alike, however many beams met it: what one leg hides of the other does not
        draw the middle. Two who pass each other are told apart by where they went.
        """
        config = self.config
        expected = np.array([mover.at(stamp) for mover in self.known]).reshape(-1, 2)
        return [
            part.mean(axis=0)
            for group in hanging_together(legs, config.same)
            for part in parted(group, expected, config.gate)
        ]

    def _follow(self, stamp: float, places: list[NDArray[np.float64]]) -> None:
        """Match what moves with what moved before; forget what has not been seen for long."""
        config = self.config
        free = list(places)
        for mover in sorted(self.known, key=lambda each: -each.sightings):
            expected = mover.at(stamp)
            gaps = [float(np.hypot(*(place - expected))) for place in free]
            if gaps and min(gaps) < config.gate:
                self._correct(mover, expected, free.pop(int(np.argmin(gaps))), stamp)
        self.known = [each for each in self.known if stamp - each.stamp <= config.lost_after]
        self.known += [Mover(place=place, velocity=np.zeros(2), stamp=stamp) for place in free]

    def _correct(
        self,
        mover: Mover,
        expected: NDArray[np.float64],
        seen: NDArray[np.float64],
        stamp: float,
    ) -> None:
        config = self.config
        surprise, elapsed = seen - expected, stamp - mover.stamp
        mover.place = expected + config.place_gain * surprise
        # of the velocity nothing is known yet: the first surprise tells more of it than later ones
        gain = max(config.speed_gain, 1.0 / (mover.sightings + 1.0))
        velocity = mover.velocity + gain * surprise / elapsed
        speed = float(np.hypot(*velocity))
        mover.velocity = velocity * min(1.0, config.max_speed / max(speed, config.max_speed))
        mover.pace = max(float(np.hypot(*mover.velocity)), PACE_KEPT**elapsed * mover.pace)
        mover.stamp, mover.sightings = stamp, mover.sightings + 1
