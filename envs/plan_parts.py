"""The parts of a floor plan: walls, boxes, cylinders, polygons, and the solids they consist of.

Every part checks itself when it is made, so that a part that exists can be simulated.
"""

import math
from dataclasses import dataclass

import numpy as np

from envs.convex_pieces import convex_pieces, is_simple
from envs.plan_checks import (
    Point,
    check_finite,
    check_height,
    check_points,
    check_size,
    count_distinct,
)
from envs.solids import Disc, Prism, Solid
from envs.wall_line import SAME_POINT, wall_prisms
from mapping.errors import TestbedError


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
        check_points("points", self.points)
        check_size("thickness", self.thickness)
        check_height(self.height)
        least = 3 if self.closed else 2
        if count_distinct(self.points) < least:
            kind = "a closed wall" if self.closed else "a wall"
            raise TestbedError(
                f"points: {count_distinct(self.points)} that differ; {kind} needs at least {least}"
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
        check_points("center", (self.center,))
        check_size("size", self.size[0])
        check_size("size", self.size[1])
        check_finite("yaw", self.yaw, "rad")
        check_height(self.height)

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
        check_points("center", (self.center,))
        check_size("radius", self.radius)
        check_height(self.height)

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
        check_points("vertices", self.vertices)
        check_height(self.height)
        if count_distinct(self.vertices) < 3:
            raise TestbedError(
                f"vertices: {count_distinct(self.vertices)} that differ; a polygon needs at least 3"
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


def _on_one_line(points: tuple[Point, ...]) -> bool:
    """Whether no point lies farther from the line through two others than one point is wide."""
    centred = np.array(points) - points[0]
    along = centred[np.argmax(np.hypot(*centred.T))]
    across = centred[:, 0] * along[1] - centred[:, 1] * along[0]
    return bool(np.all(np.abs(across) < SAME_POINT * np.hypot(*along)))
