"""A floor plan: the walls and things a robot can meet, and where it starts."""

from dataclasses import dataclass

Point = tuple[float, float]


@dataclass(frozen=True, slots=True, kw_only=True)
class Wall:
    """A wall along a polyline, its thickness centred on the line, joints mitred."""

    points: tuple[Point, ...]
    """Corners of the line [m]; at least two."""
    closed: bool = False
    """Whether the last point joins the first."""
    thickness: float = 0.1
    """Thickness [m]."""
    height: float = 1.0
    """Height above the floor [m]; higher than the lidar's plane."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Box:
    """An upright box: furniture."""

    center: Point
    size: Point
    """Length along its own x and y [m]."""
    yaw: float = 0.0
    height: float = 0.5


@dataclass(frozen=True, slots=True, kw_only=True)
class Cylinder:
    """An upright cylinder: a pillar, a trash can, the leg of a table."""

    center: Point
    radius: float
    height: float = 0.5


@dataclass(frozen=True, slots=True, kw_only=True)
class Polygon:
    """A solid prism over a simple polygon, convex or not, either orientation."""

    vertices: tuple[Point, ...]
    height: float = 1.0


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
