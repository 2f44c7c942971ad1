"""A floor plan: the walls and things a robot can meet, and where it starts.

Every part checks itself when it is made, so a plan that exists can be simulated: its figures are
finite, the lidar can see everything in it, and the robot fits where it starts.
"""

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from envs.burger_constants import BASE_LINK_HEIGHT, LIDAR_POSITION
from envs.convex_pieces import convex_pieces, is_simple
from envs.solids import Disc, Prism, Solid, bounds, distance
from envs.wall_line import SAME_POINT, wall_prisms
from mapping.burger import ROBOT_RADIUS
from mapping.errors import TestbedError

Point = tuple[float, float]

LIDAR_PLANE_HEIGHT = BASE_LINK_HEIGHT + LIDAR_POSITION[2]
"""Height of the lidar's plane above the floor [m]."""

PITCH_MARGIN = 0.04
"""How much higher a beam may run at full range [m]: a robot that pitches by 0.6 degrees, as on
ROBOTIS's caster, lifts it by 3.5 m * tan(0.6 degrees) = 0.037 m."""

MIN_HEIGHT = LIDAR_PLANE_HEIGHT + PITCH_MARGIN
"""The lowest thing that the lidar is sure to see [m]; the robot would run into lower ones."""

MIN_SIZE = 0.001
"""The smallest thickness, side or radius [m]: what the LDS-01 resolves."""

MAX_COORDINATE = 1e4
"""The farthest a plan may reach from the origin [m]: no building does, a slip of units may."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Wall:
    """A wall along a polyline, its thickness centred on the line, joints mitred.

    The line may cross and touch itself, repeat points and turn back.
    """

    points: tuple[Point, ...]
    """Corners of the line [m]; at least two that differ, three for a closed wall."""
    closed: bool = False
    """Whether the last point joins the first."""
    thickness: float = 0.1
    """Thickness [m]."""
    height: float = 1.0
    """Height above the floor [m]; higher than the lidar's plane."""

    def __post_init__(self) -> None:
        """Refuse figures that make no wall."""
        _check_points("points", self.points)
        _check_size("thickness", self.thickness)
        _check_height(self.height)
        least = 3 if self.closed else 2
        if _distinct(self.points) < least:
            kind = "a closed wall" if self.closed else "a wall"
            raise TestbedError(
                f"points: {_distinct(self.points)} that differ; {kind} needs at least {least}"
            )
        if self.closed and _on_one_line(self.points):
            raise TestbedError("points: all on one line; a closed wall must enclose an area")

    def solids(self) -> tuple[Solid, ...]:
        """The wall as convex prisms, one a segment."""
        return wall_prisms(
            self.points, closed=self.closed, thickness=self.thickness, height=self.height
        )


@dataclass(frozen=True, slots=True, kw_only=True)
class Box:
    """An upright box: furniture."""

    center: Point
    """Centre [m]."""
    size: Point
    """Length along its own x and y [m]."""
    yaw: float = 0.0
    """Direction of its own x in the world [rad], counter-clockwise."""
    height: float = 0.5
    """Height above the floor [m]."""

    def __post_init__(self) -> None:
        """Refuse figures that make no box."""
        _check_points("center", (self.center,))
        _check_size("size", self.size[0])
        _check_size("size", self.size[1])
        _check_finite("yaw", self.yaw, "rad")
        _check_height(self.height)

    def solids(self) -> tuple[Solid, ...]:
        """The box as one prism."""
        cos, sin = math.cos(self.yaw), math.sin(self.yaw)
        (x, y), (half_x, half_y) = self.center, (0.5 * self.size[0], 0.5 * self.size[1])
        corners = [
            (x + cos * u - sin * v, y + sin * u + cos * v)
            for u, v in ((-half_x, -half_y), (half_x, -half_y), (half_x, half_y), (-half_x, half_y))
        ]
        return (Prism(vertices=np.array(corners), height=self.height),)


@dataclass(frozen=True, slots=True, kw_only=True)
class Cylinder:
    """An upright cylinder: a pillar, a trash can, the leg of a table."""

    center: Point
    """Centre [m]."""
    radius: float
    """Radius [m]."""
    height: float = 0.5
    """Height above the floor [m]."""

    def __post_init__(self) -> None:
        """Refuse figures that make no cylinder."""
        _check_points("center", (self.center,))
        _check_size("radius", self.radius)
        _check_height(self.height)

    def solids(self) -> tuple[Solid, ...]:
        """The cylinder as one disc."""
        return (Disc(center=np.array(self.center), radius=self.radius, height=self.height),)


@dataclass(frozen=True, slots=True, kw_only=True)
class Polygon:
    """A solid prism over a simple polygon, convex or not, either orientation."""

    vertices: tuple[Point, ...]
    """Corners [m]; the first may be repeated at the end."""
    height: float = 1.0
    """Height above the floor [m]."""

    def __post_init__(self) -> None:
        """Refuse figures that make no solid."""
        _check_points("vertices", self.vertices)
        _check_height(self.height)
        if _distinct(self.vertices) < 3:
            raise TestbedError(
                f"vertices: {_distinct(self.vertices)} that differ; a polygon needs at least 3"
            )
        if not is_simple(self.vertices):
            raise TestbedError(
                "vertices: cross, touch or enclose nothing; a polygon's edges may meet only at "
                "its corners (split it in two, or use a closed wall)"
            )

    def solids(self) -> tuple[Solid, ...]:
        """The polygon as convex prisms."""
        pieces = convex_pieces(self.vertices)
        return tuple(Prism(vertices=piece, height=self.height) for piece in pieces)


Part = Wall | Box | Cylinder | Polygon


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
        _check_points("points", self.points)


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
    routes: tuple[Route, ...] = ()
    """Ways through the place that have a name."""

    def __post_init__(self) -> None:
        """Refuse a plan with nothing in it, or where the robot does not fit at its start."""
        if not (self.walls or self.boxes or self.cylinders or self.polygons):
            raise TestbedError(
                "the plan has zero area; it needs at least one wall, box, cylinder or polygon"
            )
        _check_points("start", (self.start[:2],))
        _check_finite("start yaw", self.start[2], "rad")
        _check_start(self)
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


def _certainly_clear(box: Box, point: Point, clearance: float) -> bool:
    """Whether the circle round a box is far enough: spares plans of many boxes the exact test."""
    return math.dist(box.center, point) - 0.5 * math.hypot(*box.size) >= clearance


def _check_points(field: str, points: tuple[Point, ...]) -> None:
    """Refuse coordinates that are no finite numbers within the largest plan."""
    for x, y in points:
        if not (abs(x) <= MAX_COORDINATE and abs(y) <= MAX_COORDINATE):  # NaN compares false
            raise TestbedError(
                f"{field}: ({x}, {y}) m; coordinates must be finite, "
                f"{MAX_COORDINATE:g} m from the origin at most"
            )


def _check_finite(field: str, value: float, unit: str) -> None:
    """Refuse NaN and infinity."""
    if not math.isfinite(value):
        raise TestbedError(f"{field}: {value} {unit}; must be finite")


def _check_size(field: str, value: float) -> None:
    """Refuse what is not positive, finite and large enough to be seen."""
    if not MIN_SIZE <= value <= MAX_COORDINATE:
        raise TestbedError(f"{field}: {value} m; must be from {MIN_SIZE} to {MAX_COORDINATE:g} m")


def _check_height(height: float) -> None:
    """Refuse what the lidar could look over."""
    if not MIN_HEIGHT <= height <= MAX_COORDINATE:
        raise TestbedError(
            f"height: {height} m; must be at least {MIN_HEIGHT:.3f} m and finite: "
            f"the lidar sees nothing lower (its plane is at {LIDAR_PLANE_HEIGHT:.3f} m)"
        )


def _distinct(points: tuple[Point, ...]) -> int:
    """How many points differ, by what a wall takes for one point; counts no farther than 3."""
    kept: list[Point] = []
    for point in points:
        if all(math.dist(point, other) >= SAME_POINT for other in kept):
            kept.append(point)
        if len(kept) == 3:
            break
    return len(kept)


def _on_one_line(points: tuple[Point, ...]) -> bool:
    """Whether no point lies farther from the line through two others than one point is wide."""
    centred = np.array(points) - points[0]
    along = centred[np.argmax(np.hypot(*centred.T))]
    across = centred[:, 0] * along[1] - centred[:, 1] * along[0]
    return bool(np.all(np.abs(across) < SAME_POINT * np.hypot(*along)))
