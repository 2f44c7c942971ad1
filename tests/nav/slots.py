"""Dead-end slots for the manoeuvre's tests, and a robot that does as it is told."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from shapely import MultiLineString, Polygon
from shapely.affinity import rotate, translate
from shapely.geometry import box
from shapely.ops import unary_union

from mapping.geometry import Pose, transform_points
from mapping.messages import Twist
from nav.outline import BURGER_OUTLINE

SHAPE = unary_union([box(-back, -side, front, side) for front, back, side in BURGER_OUTLINE])

SPACING = 0.008
"""Distance between two points that the lidar sees of a wall [m]: a degree at half a metre."""


@dataclass(frozen=True)
class Slot:
    """Two walls and an end, in a wall of a wide room, turned about the origin: the slot's mouth."""

    width: float
    depth: float
    turned: float
    slant: float
    """Angle between the end of the slot and a square one [rad]."""

    @property
    def lines(self) -> MultiLineString:
        half, skew = 0.5 * self.width, 0.5 * self.width * np.tan(self.slant)
        left = [(0.0, 1.0), (0.0, half), (self.depth + skew, half)]
        right = [(self.depth - skew, -half), (0.0, -half), (0.0, -1.0)]
        return rotate(MultiLineString([[*left, *right]]), self.turned, (0, 0), use_radians=True)

    def pose(self, ahead: float, aside: float, yaw: float) -> Pose:
        """A pose ``(3,)`` from one relative to the slot's mouth and direction."""
        x, y = transform_points(np.array([0.0, 0.0, self.turned]), np.array([[ahead, aside]]))[0]
        return np.array([x, y, self.turned + yaw])

    @property
    def points(self) -> NDArray[np.float64]:
        return points_along(self.lines)


@dataclass(frozen=True)
class Passage:
    """The gap along x between the corners of two cupboards that reach past one another."""

    width: float
    length: float
    """How far the cupboards reach past one another [m]."""

    @property
    def lines(self) -> MultiLineString:
        half = 0.5 * self.width
        right = [(-0.4, -1.0), (-0.4, -half), (self.length, -half), (self.length, -1.0)]
        left = [(0.0, 1.0), (0.0, half), (0.7, half), (0.7, 1.0)]
        return MultiLineString([right, left])

    @property
    def points(self) -> NDArray[np.float64]:
        return points_along(self.lines)


def points_along(lines: MultiLineString) -> NDArray[np.float64]:
    """What the lidar sees of walls ``(n, 2)``."""
    return np.array(
        [
            line.interpolate(s).coords[0]
            for line in lines.geoms
            for s in np.arange(0.0, line.length, SPACING)
        ]
    )


def outline_at(pose: Pose) -> Polygon:
    return translate(rotate(SHAPE, pose[2], (0, 0), use_radians=True), pose[0], pose[1])


def driven(pose: Pose, twist: Twist, period: float) -> Pose:
    """The pose a period later."""
    middle = pose[2] + 0.5 * period * twist.angular_z
    ahead = period * twist.linear_x
    turned = period * twist.angular_z
    return np.array(pose + [ahead * np.cos(middle), ahead * np.sin(middle), turned])
