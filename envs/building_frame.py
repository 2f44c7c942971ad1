"""Places a lattice of rooms in the world: scaled to its area, wedge-shaped or not, turned, moved.

The wedge stretches each row by its own factor. Lines along rows and columns stay straight, but
those along columns fan out, so that a wedge-shaped house has oblique walls only.
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from envs.room_layout import Labels

Points = NDArray[np.float64]


@dataclass(frozen=True, slots=True, kw_only=True)
class BuildingFrame:
    """From lattice coordinates (column, row), in cells, to the world [m], and back."""

    middle: tuple[float, float]
    """The lattice's middle (column, row)."""
    scale: float
    """Edge of a cell [m]."""
    wedge: float
    """Stretch of the topmost row, and shrink of the lowest; 0 = rectangular, below 1."""
    yaw: float
    """How far the building is turned [rad]."""
    origin: tuple[float, float] = (0.0, 0.0)
    """Where the middle lies in the world [m]."""

    def to_world(self, lattice: ArrayLike) -> Points:
        """World points ``(n, 2)`` [m] of lattice points ``(n, 2)`` (column, row)."""
        u, v = (np.asarray(lattice, dtype=np.float64) - self.middle).T
        x, y = self.scale * u * self._stretch(v), self.scale * v
        cos, sin = math.cos(self.yaw), math.sin(self.yaw)
        return np.column_stack((cos * x - sin * y, sin * x + cos * y)) + self.origin

    def to_lattice(self, points: ArrayLike) -> Points:
        """Lattice points (column, row) ``(n, 2)`` of world points ``(n, 2)``."""
        x, y = (np.asarray(points, dtype=np.float64) - self.origin).T
        cos, sin = math.cos(self.yaw), math.sin(self.yaw)
        v = (cos * y - sin * x) / self.scale
        u = (cos * x + sin * y) / self.scale / self._stretch(v)
        return np.column_stack((u, v)) + self.middle

    def _stretch(self, v: NDArray[np.float64]) -> NDArray[np.float64]:
        """Factor of the rows at heights ``v`` over the middle; never 0, however far outside."""
        return np.maximum(1.0 + self.wedge * v / max(self.middle[1], 1.0), 0.1)


def frame_for(labels: Labels, area: float, *, wedge: float, yaw: float) -> BuildingFrame:
    """The frame in which the rooms together have an area [m2]; all of it right of and above 0."""
    rows, columns = labels.shape
    middle = (0.5 * columns, 0.5 * rows)
    heights = np.arange(rows) + 0.5 - middle[1]
    cells = np.count_nonzero(labels >= 0, axis=1)
    stretched = float(cells @ (1.0 + wedge * heights / max(middle[1], 1.0)))
    at_zero = BuildingFrame(middle=middle, scale=math.sqrt(area / stretched), wedge=wedge, yaw=yaw)
    corners = at_zero.to_world([(0, 0), (columns, 0), (columns, rows), (0, rows)])
    left, bottom = corners.min(axis=0).tolist()
    return BuildingFrame(
        middle=middle, scale=at_zero.scale, wedge=wedge, yaw=yaw, origin=(-left, -bottom)
    )
