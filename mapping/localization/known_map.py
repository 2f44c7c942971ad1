"""Turns a map file into what localisers need: where the robot fits, and how far walls are."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

from mapping.burger import ROBOT_RADIUS
from mapping.errors import TestbedError
from mapping.geometry import Pose
from mapping.grid import FREE, OCCUPIED
from mapping.io.map_server import MapFile


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class KnownMap:
    """A map that is taken for the truth; arrays ``[row = y, col = x]``, row 0 at the origin."""

    resolution: float
    """Edge of a cell [m]."""
    origin: tuple[float, float]
    """Lower-left corner of cell (0, 0) in the map frame [m]."""
    occupied: NDArray[np.bool_]
    """Cells that are wall."""
    free: NDArray[np.bool_]
    """Cells that are free."""
    distances: NDArray[np.float32]
    """From the middle of each cell to that of the nearest occupied one [m]."""
    places: NDArray[np.int64]
    """Cells (row, column) where the robot's centre fits ``(n, 2)``."""

    def draw_poses(self, count: int, rng: np.random.Generator) -> Pose:
        """Poses ``(count, 3)``, uniform over the places where the robot fits and over headings."""
        cells = self.places[rng.integers(len(self.places), size=count)]
        within = rng.random((count, 2))
        poses = np.empty((count, 3))
        poses[:, 0] = self.origin[0] + (cells[:, 1] + within[:, 0]) * self.resolution
        poses[:, 1] = self.origin[1] + (cells[:, 0] + within[:, 1]) * self.resolution
        poses[:, 2] = rng.uniform(-np.pi, np.pi, count)
        return poses

    def holds(self, x: float, y: float) -> bool:
        """Whether a point [m] lies on the map; NaN does not."""
        rows, columns = self.occupied.shape
        right = self.origin[0] + columns * self.resolution
        top = self.origin[1] + rows * self.resolution
        return bool(self.origin[0] <= x < right and self.origin[1] <= y < top)

    def fits(self, points: NDArray[np.float64], radius: float = ROBOT_RADIUS) -> NDArray[np.bool_]:
        """Whether the robot's centre may be at points ``(n, 2)`` [m]: far enough from walls."""
        cells = np.floor((points - self.origin) / self.resolution).astype(np.int64)
        rows, columns = self.occupied.shape
        inside = np.all((cells >= 0) & (cells < (columns, rows)), axis=1)
        cells = np.clip(cells, 0, (columns - 1, rows - 1))
        return np.asarray(inside & (self.distances[cells[:, 1], cells[:, 0]] >= radius))


def known_map(file: MapFile) -> KnownMap:
    """Prepare a map.

    Raises:
        TestbedError: It shows no wall, or no free place where the robot fits.
    """
    occupied = file.states == OCCUPIED
    if not occupied.any():
        raise TestbedError("map: no occupied cell; must show walls to localise by")
    distances = ndimage.distance_transform_edt(~occupied) * file.resolution
    places = np.argwhere((file.states == FREE) & (distances >= ROBOT_RADIUS))
    if len(places) == 0:
        raise TestbedError(
            f"map: no free cell {ROBOT_RADIUS} m or more from every wall; the robot must fit"
        )
    return KnownMap(
        resolution=file.resolution,
        origin=file.origin,
        occupied=occupied,
        free=file.states == FREE,
        distances=distances.astype(np.float32),
        places=places,
    )
