"""Turns the points of a scan into corners: places where two straight walls meet.

Points are cut into runs at gaps, runs into straight pieces (split at the point farthest from the
chord, Ramer 1972), pieces become lines by least squares, and neighbouring lines that meet where
their points end make a corner.
"""

import math
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True, kw_only=True)
class CornerConfig:
    """What counts as a wall and a corner; for an LDS-01, whose readings err by 1.2 % of range."""

    gap: float = 0.15
    """Neighbouring points farther apart than this [m], or than GAP_SHARE of their range, lie on
    different things."""
    gap_share: float = 0.1
    """The same as a share of the range: a wall seen at a slant has far points far apart."""
    flatness: float = 0.06
    """A run whose farthest point is nearer to its chord than this [m] is straight."""
    flatness_share: float = 0.04
    """The same as a share of the range, 3.4 standard deviations; the larger of the two counts."""
    least_points: int = 8
    """Fewest points of a wall."""
    least_length: float = 0.25
    """Shortest wall [m]."""
    reach: float = 0.15
    """Both walls end within this of the corner [m]."""
    least_angle: float = math.radians(40.0)
    """Walls that meet at less than this, or less than this from straight on, make none [rad]."""
    farthest: float = 3.0
    """Corners farther away are not told [m]."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Corners:
    """Corners in the frame of the points."""

    places: Array
    """Where the walls meet ``(n, 2)`` [m]."""
    directions: Array
    """Where the bisector of the two walls points, away from the corner ``(n,)`` [rad]."""
    hollow: NDArray[np.bool_]
    """Whether the corner is that of a room, seen from inside; else it stands out ``(n,)``."""

    def __len__(self) -> int:
        return len(self.directions)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class _Wall:
    first: Array
    """Its first point in the order of the beams, on the line ``(2,)``."""
    last: Array
    normal: Array
    offset: float
    """normal . point = offset on the line."""


def find_corners(points: Array, config: CornerConfig | None = None) -> Corners:
    """The corners that a scan saw.

    Args:
        points: Where beams ended ``(n, 2)``, in the order of the beams once around, seen from the
            frame's origin [m].
        config: What counts.
    """
    config = config or CornerConfig()
    walls: list[_Wall | None] = []
    for run in _runs(points, config):
        walls += _walls(points[run], config)
        walls.append(None)  # a gap: its two sides do not meet
    places, directions, hollow = [], [], []
    for before, after in pairwise(walls):
        corner = None if before is None or after is None else _meet(before, after, config)
        if corner is not None:
            place, direction = corner
            places.append(place)
            directions.append(math.atan2(direction[1], direction[0]))
            hollow.append(float(direction @ place) < 0.0)
    return Corners(
        places=np.array(places, dtype=np.float64).reshape(-1, 2),
        directions=np.array(directions, dtype=np.float64),
        hollow=np.array(hollow, dtype=np.bool_),
    )


def _runs(points: Array, config: CornerConfig) -> list[NDArray[np.int64]]:
    """Indices of points in turn without a gap; the scan is closed, so the first run may wrap."""
    count = len(points)
    if count < 2:
        return []
    steps = np.hypot(*(np.roll(points, -1, axis=0) - points).T)
    ranges = np.hypot(points[:, 0], points[:, 1])
    cuts = np.flatnonzero(steps > np.maximum(config.gap, config.gap_share * ranges))
    if len(cuts) == 0:
        return [np.arange(count)]
    order = np.roll(np.arange(count), -(int(cuts[0]) + 1))
    return np.split(order, np.diff(cuts).cumsum())


def _walls(run: Array, config: CornerConfig) -> list[_Wall | None]:
    """The straight pieces of a run of points in turn; None for what is too short to be one."""
    if len(run) < config.least_points:
        return [None]
    cut = _farthest_from_chord(run, config)
    if cut is not None:
        return _walls(run[: cut + 1], config) + _walls(run[cut:], config)
    if np.hypot(*(run[-1] - run[0])) < config.least_length:
        return [None]
    middle = run.mean(axis=0)
    _, _, axes = np.linalg.svd(run - middle, full_matrices=False)
    along, normal = axes
    return [
        _Wall(
            first=middle + along * float((run[0] - middle) @ along),
            last=middle + along * float((run[-1] - middle) @ along),
            normal=normal,
            offset=float(normal @ middle),
        )
    ]


def _farthest_from_chord(run: Array, config: CornerConfig) -> int | None:
    """The point to split a run at, None if it is straight."""
    chord = run[-1] - run[0]
    length = math.hypot(*chord)
    if length > 0.0:
        apart = np.abs(chord[0] * (run[:, 1] - run[0, 1]) - chord[1] * (run[:, 0] - run[0, 0]))
        apart /= length
    else:
        apart = np.hypot(*(run - run[0]).T)
    ranges = np.hypot(run[:, 0], run[:, 1])
    excess = apart / np.maximum(config.flatness, config.flatness_share * ranges)
    farthest = int(np.argmax(excess))
    if excess[farthest] <= 1.0 or farthest in (0, len(run) - 1):
        return None
    return farthest


def _meet(before: _Wall, after: _Wall, config: CornerConfig) -> tuple[Array, Array] | None:
    """Where two walls meet and where their bisector points, None if they make no corner."""
    cross = float(before.normal[0] * after.normal[1] - before.normal[1] * after.normal[0])
    if abs(cross) < math.sin(config.least_angle):
        return None
    place = np.linalg.solve(
        np.array([before.normal, after.normal]), np.array([before.offset, after.offset])
    )
    if max(np.hypot(*(place - before.last)), np.hypot(*(place - after.first))) > config.reach:
        return None
    if np.hypot(*place) > config.farthest:
        return None
    one, other = before.first - place, after.last - place
    direction = one / np.hypot(*one) + other / np.hypot(*other)
    return place, direction
