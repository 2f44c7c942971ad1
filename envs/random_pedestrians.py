"""Populates a floor plan: draws loops that people can walk, through its free floor."""

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage
from scipy.sparse import coo_array, csr_array
from scipy.sparse.csgraph import dijkstra

from envs.floor_plan import FloorPlan
from envs.pedestrians import Pedestrian, feet_at, gaits_of, positions_at
from envs.plan_checks import Point
from envs.plan_raster import lattice_for, rasterize_solids
from envs.walking_room import check_walk
from mapping.errors import TestbedError

CLEARANCE = 0.35
"""How far the middle of a body keeps from things [m]: half a door of 0.7 m."""

SPEEDS = (0.5, 1.2)
"""Speeds are drawn from this range [m/s]."""

FARTHEST = 10.0
"""Corners of a loop are at most so long a walk apart [m]."""

NEAREST = 1.5
"""And at least so long a walk, where the floor allows [m]."""

START_ROOM = 1.0
"""At time 0 people are at least so far from the robot [m]."""

MAX_PEOPLE = 100
"""A crowd; more would be a slip."""

_RESOLUTION = 0.05
"""Edge of the cells that loops are looked for on [m]."""

_TRIES = 50
"""Loops and places drawn for one person before there is taken to be no room."""


def random_pedestrians(
    plan: FloorPlan,
    count: int,
    rng: np.random.Generator,
    *,
    start: tuple[float, float, float] | None = None,
) -> tuple[Pedestrian, ...]:
    """People on loops between random places of the floor that the robot starts on.

    A loop joins three places by shortest ways that keep ``CLEARANCE`` to everything, straightened
    where the straight way keeps it too.

    Args:
        plan: The floor plan.
        count: How many people.
        rng: Where the loops, speeds and phases come from.
        start: The robot's start pose, if not the plan's.

    Raises:
        TestbedError: There is no room for a walk.
    """
    if count == 0:
        return ()
    start = plan.start if start is None else start
    floor = _WalkingFloor(plan, start)
    return tuple(_draw(plan, floor, start[:2], rng) for _ in range(count))


def check_people(count: int) -> None:
    """Refuse a count that is no crowd, or no whole number."""
    if not isinstance(count, int | np.integer) or not 0 <= count <= MAX_PEOPLE:
        raise TestbedError(f"people: {count}; must be from 0 to {MAX_PEOPLE}, a whole number")


def _draw(
    plan: FloorPlan, floor: "_WalkingFloor", robot: Point, rng: np.random.Generator
) -> Pedestrian:
    """One person whose legs clear everything, and the robot at time 0."""
    for _ in range(_TRIES):
        waypoints = floor.loop(rng)
        speed, phase = float(rng.uniform(*SPEEDS)), float(rng.random())
        try:
            person = Pedestrian(waypoints=waypoints, speed=speed, phase=phase)
            check_walk(person, plan.parts())
        except TestbedError:
            continue
        places = (*feet_at(gaits_of([person]), 0.0), *positions_at([person], 0.0))
        if min(math.dist(place, robot) for place in places) >= START_ROOM:
            return person
    raise TestbedError(
        f"people: no room found for a walk in {plan.name}; people need {2.0 * CLEARANCE:g} m of "
        "width and some metres of way"
    )


class _WalkingFloor:
    """The floor joined to a place where people can walk, as cells and the ways between them."""

    def __init__(self, plan: FloorPlan, start: tuple[float, float, float]) -> None:
        self._origin, shape = lattice_for(plan, _RESOLUTION, margin=2.0 * _RESOLUTION)
        solid = rasterize_solids(
            plan.solids(),
            resolution=_RESOLUTION,
            origin=self._origin,
            shape=shape,
            slack=0.5 * _RESOLUTION,  # so that no thin leg of a chair falls between the centres
        )
        self._walkable = _joined_to(start, ~solid, self._origin)
        away = ndimage.distance_transform_edt(np.pad(self._walkable, 1))[1:-1, 1:-1]
        self._walkable &= away * _RESOLUTION >= CLEARANCE
        self._cells = np.argwhere(self._walkable)
        if len(self._cells) == 0:
            raise TestbedError(
                f"people: no room for a walk in {plan.name}; people need "
                f"{2.0 * CLEARANCE:g} m of width"
            )
        self._ways = _ways_between(self._walkable)

    def loop(self, rng: np.random.Generator) -> tuple[Point, ...]:
        """Corners of a loop through three random places."""
        first = int(rng.integers(len(self._cells)))
        second, third = self._two_in_reach(first, rng)
        ways = [
            _straightened(self._cells[self._way(begin, end)], self._walkable)[:-1]
            for begin, end in ((first, second), (second, third), (third, first))
        ]
        corners = np.concatenate(ways)
        points = (corners[:, ::-1] + 0.5) * _RESOLUTION + np.asarray(self._origin)
        return tuple((float(x), float(y)) for x, y in points)

    def _two_in_reach(self, first: int, rng: np.random.Generator) -> tuple[int, int]:
        """Two cells a walk away from the first, as far as there are such."""
        walks = dijkstra(self._ways, directed=False, indices=np.array(first), limit=FARTHEST)
        walks[~np.isfinite(walks)] = 0.0
        far = np.flatnonzero(walks >= min(NEAREST, float(walks.max())))
        second, third = rng.choice(far, size=2)
        return int(second), int(third)

    def _way(self, begin: int, end: int) -> list[int]:
        """The cells of a shortest way, both ends included."""
        _, before = dijkstra(
            self._ways,
            directed=False,
            indices=np.array(begin),
            return_predecessors=True,
            limit=2.0 * FARTHEST + 1.0,
        )
        cells = []
        while end != begin:
            cells.append(end)
            end = int(before[end])
        return [begin, *cells[::-1]]


def _joined_to(
    start: tuple[float, float, float], free: NDArray[np.bool_], origin: Point
) -> NDArray[np.bool_]:
    """The free cells joined to the start's, or to those round it."""
    labels, _ = ndimage.label(free)
    row, column = (int((start[1 - k] - origin[1 - k]) // _RESOLUTION) for k in (0, 1))
    inside = 0 <= row < free.shape[0] and 0 <= column < free.shape[1]
    return np.asarray(labels == labels[row, column]) & free if inside else np.zeros_like(free)


def _ways_between(walkable: NDArray[np.bool_]) -> csr_array[Any, Any]:
    """The graph of neighbouring walkable cells, of eight, with the lengths of steps [m]."""
    numbers = np.full(walkable.shape, -1, dtype=np.int64)
    numbers[walkable] = np.arange(np.count_nonzero(walkable))
    rows, columns = walkable.shape
    firsts, seconds, lengths = [], [], []
    for down, right in ((0, 1), (1, 0), (1, 1), (1, -1)):
        here = numbers[: rows - down, max(0, -right) : columns - max(0, right)]
        there = numbers[down:, max(0, right) : columns - max(0, -right)]
        both = (here >= 0) & (there >= 0)
        firsts.append(here[both])
        seconds.append(there[both])
        lengths.append(np.full(np.count_nonzero(both), math.hypot(down, right) * _RESOLUTION))
    count = int(np.count_nonzero(walkable))
    ends = (np.concatenate(firsts), np.concatenate(seconds))
    return coo_array((np.concatenate(lengths), ends), shape=(count, count)).tocsr()


def _straightened(cells: NDArray[np.int64], walkable: NDArray[np.bool_]) -> NDArray[np.int64]:
    """The corners ``(m, 2)`` of a way of cells ``(n, 2)``, cut short where one can see ahead."""
    corners, at = [0], 0
    while at < len(cells) - 1:
        ahead = len(cells) - 1
        while ahead > at + 1 and not _sees(cells[at], cells[ahead], walkable):
            ahead -= 1
        corners.append(ahead)
        at = ahead
    return np.asarray(cells[corners])


def _sees(cell: NDArray[np.int64], other: NDArray[np.int64], walkable: NDArray[np.bool_]) -> bool:
    """Whether the straight way from cell to cell stays on walkable ones."""
    steps = 2 * int(np.abs(other - cell).max()) + 1
    line = np.rint(np.linspace(cell, other, steps)).astype(np.int64)
    return bool(np.all(walkable[line[:, 0], line[:, 1]]))
