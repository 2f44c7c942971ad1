"""A floor plan: the walls and things a robot can meet, the people who walk there, and its start.

Every part checks itself when it is made, so a plan that exists can be simulated: its figures are
finite, the lidar can see everything in it, people walk through no wall, and the robot fits where it
starts.
"""

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from envs.pedestrians import LEG_RADIUS, Pedestrian, feet_at, gaits_of, positions_at
from envs.plan_checks import MAX_COORDINATE, MIN_HEIGHT, Point, check_finite, check_points
from envs.plan_parts import Box, Cylinder, Part, Polygon, Wall
from envs.solids import Solid, bounds, distance
from envs.walking_room import check_walk
from mapping.burger import ROBOT_RADIUS
from mapping.errors import TestbedError

__all__ = [
    "MAX_COORDINATE",
    "MIN_HEIGHT",
    "Box",
    "Cylinder",
    "FloorPlan",
    "Part",
    "Pedestrian",
    "Point",
    "Polygon",
    "Route",
    "Wall",
]


@dataclass(frozen=True, slots=True, kw_only=True)
class Route:
    """Places to drive through in order, for runs that are to be repeated."""

    name: str
    points: tuple[Point, ...]
    """The places [m]."""

    def __post_init__(self) -> None:
        """Refuse a route that leads nowhere."""
        if not self.points:
            raise TestbedError("points: none; a route needs one at least")
        check_points("points", self.points)


@dataclass(frozen=True, slots=True, kw_only=True)
class FloorPlan:
    """Everything that stands on the floor, and the pose the robot starts from."""

    name: str
    start: tuple[float, float, float]
    """Start pose x [m], y [m], yaw [rad] of base_footprint in the world frame."""
    walls: tuple[Wall, ...] = ()
    boxes: tuple[Box, ...] = ()
    cylinders: tuple[Cylinder, ...] = ()
    polygons: tuple[Polygon, ...] = ()
    description: str = ""
    """One line that says what place this is."""
    pedestrians: tuple[Pedestrian, ...] = ()
    """People who walk there; they are no part of what a map of the place is scored against."""
    routes: tuple[Route, ...] = ()
    """Ways through the place that have a name."""

    def __post_init__(self) -> None:
        """Refuse a plan with nothing in it, walks through walls, and a start without room."""
        if not (self.walls or self.boxes or self.cylinders or self.polygons):
            raise TestbedError(
                "the plan has zero area; it needs at least one wall, box, cylinder or polygon"
            )
        check_points("start", (self.start[:2],))
        check_finite("start yaw", self.start[2], "rad")
        _check_start(self)
        _check_people(self)
        names = [route.name for route in self.routes]
        for name in names:
            if names.count(name) > 1:
                raise TestbedError(f"routes: {name!r} stands twice; names must differ")

    @property
    def bounds(self) -> tuple[float, float, float, float]:
        """The upright rectangle round all solids: left, right, bottom, top [m]."""
        left, right, bottom, top = np.array([bounds(solid) for solid in self.solids()]).T
        return float(left.min()), float(right.max()), float(bottom.min()), float(top.max())

    def parts(self) -> Iterator[tuple[str, Part]]:
        """Every part with the name that its place in the plan gives it, such as ``walls[0]``."""
        for kind, parts in self.kinds().items():
            for i, part in enumerate(parts):
                yield f"{kind}[{i}]", part

    def kinds(self) -> dict[str, tuple[Part, ...]]:
        """The parts by kind: ``walls``, ``boxes``, ``cylinders``, ``polygons``."""
        return {
            "walls": self.walls,
            "boxes": self.boxes,
            "cylinders": self.cylinders,
            "polygons": self.polygons,
        }

    def solids(self) -> tuple[Solid, ...]:
        """Everything as convex prisms and discs, in the order of ``parts``."""
        return tuple(solid for _, part in self.parts() for solid in part.solids())


def _check_start(plan: FloorPlan) -> None:
    """Refuse a start pose in a solid, or nearer to one than the robot's radius."""
    x, y, _ = plan.start
    nearest, clearance = "", ROBOT_RADIUS
    for label, part in plan.parts():
        if isinstance(part, Box) and _certainly_clear(part, plan.start[:2], clearance):
            continue
        gap = min((distance(solid, (x, y)) for solid in part.solids()), default=math.inf)
        if gap < clearance:
            nearest, clearance = label, gap
    if nearest:
        where = "inside" if clearance == 0.0 else f"{clearance:.3f} m from"
        raise TestbedError(
            f"start: ({x:g}, {y:g}) is {where} {nearest}; the robot needs {ROBOT_RADIUS} m round it"
        )


def _check_people(plan: FloorPlan) -> None:
    """Refuse people who walk through things, or stand on the robot at time 0."""
    for i, person in enumerate(plan.pedestrians):
        try:
            check_walk(person, plan.parts())
        except TestbedError as error:
            raise TestbedError(f"pedestrians[{i}]: {error}") from None
        feet, middle = feet_at(gaits_of([person]), 0.0), positions_at([person], 0.0)
        gap = min(math.dist(place, plan.start[:2]) for place in (*feet, *middle)) - LEG_RADIUS
        if gap < ROBOT_RADIUS:
            raise TestbedError(
                f"pedestrians[{i}]: stands on the robot's start at time 0; the robot needs "
                f"{ROBOT_RADIUS} m round it (move the start, or change the phase)"
            )


def _certainly_clear(box: Box, point: Point, clearance: float) -> bool:
    """Whether the circle round a box is far enough: spares plans of many boxes the exact test."""
    return math.dist(box.center, point) - 0.5 * math.hypot(*box.size) >= clearance
