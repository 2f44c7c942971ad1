"""Turns a map that lies askew into one that lies on the truth: rigid registration of its walls.

The cost of a pose is the mean distance of the map's occupied cells, moved by it, to the truth's
wall surfaces, read from a distance transform; far cells count little more than near ones, so that
walls without partner do not pull.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage, optimize

from mapping.compare import MapScores, score_map
from mapping.geometry import Pose, inverse, transform_points
from mapping.grid import OCCUPIED, UNKNOWN, OccupancyGrid
from mapping.io.map_server import MapFile
from mapping.truth import TruthMap

MAX_POINTS = 4000
"""Occupied cells used, evenly taken from all."""

FARTHEST = 1.0
"""Cap of a distance [m], and how far around the truth's raster it is known."""

INLIER = 0.05
"""Scale of the robust loss [m]: about the noise of a wall."""

REFINED_STARTS = 6
"""How many of the best starts are refined."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Alignment:
    """Where a map lies on the truth."""

    pose: tuple[float, float, float]
    """Pose x [m], y [m], yaw [rad] of the map's frame in the truth's."""
    scores: MapScores
    """Scores of the map moved there."""


def align_map(
    grid: OccupancyGrid | MapFile,
    truth: TruthMap,
    *,
    max_shift: float = 0.5,
    max_yaw: float = np.radians(10.0),
) -> Alignment | None:
    """Find the pose that brings a map's walls onto the truth's.

    Starts lie on a lattice within the bounds, as seen from the middle of the map's walls; the best
    are refined by robust least squares and may end a little outside of the bounds.

    Args:
        grid: The map.
        truth: The truth.
        max_shift: How far off the map may be along x and y [m].
        max_yaw: How far it may be turned [rad].

    Returns:
        None when the map has no occupied cell or the truth no visible wall.
    """
    states = grid.states() if isinstance(grid, OccupancyGrid) else grid.states
    walls = np.argwhere(states == OCCUPIED)[:, ::-1]
    if len(walls) == 0 or not truth.visible_surface.any():
        return None
    points = (walls + 0.5) * grid.resolution + np.asarray(grid.origin, dtype=np.float64)
    centre = points.mean(axis=0)
    field = _DistanceField(truth)
    chosen = points[:: -(-len(points) // MAX_POINTS)] - centre

    def distances(pose: NDArray[np.float64]) -> NDArray[np.float64]:
        return field.at(transform_points(pose, chosen) + centre)

    starts = sorted(_starts(max_shift, max_yaw), key=lambda pose: float(distances(pose).mean()))
    fits = [
        optimize.least_squares(distances, start, loss="soft_l1", f_scale=INLIER)
        for start in starts[:REFINED_STARTS]
    ]
    best = min(fits, key=lambda fit: float(fit.cost)).x
    shift = centre + best[:2] - transform_points([0.0, 0.0, best[2]], centre[np.newaxis])[0]
    pose = np.array([shift[0], shift[1], best[2]])
    moved = move_map(grid, pose)
    return Alignment(
        pose=(float(pose[0]), float(pose[1]), float(pose[2])), scores=score_map(moved, truth)
    )


def move_map(grid: OccupancyGrid | MapFile, pose: Pose) -> MapFile:
    """The map seen from the frame in which its own frame lies at ``pose``; nearest cells."""
    states = grid.states() if isinstance(grid, OccupancyGrid) else grid.states
    origin, edge = np.asarray(grid.origin, dtype=np.float64), grid.resolution
    rows, columns = states.shape
    corners = origin + np.array([[0, 0], [columns, 0], [0, rows], [columns, rows]]) * edge
    moved_corners = transform_points(pose, corners)
    low = np.floor(moved_corners.min(axis=0) / edge) * edge
    count = np.ceil((moved_corners.max(axis=0) - low) / edge).astype(np.int64)
    x, y = np.meshgrid(*(low[axis] + (np.arange(count[axis]) + 0.5) * edge for axis in (0, 1)))
    sources = transform_points(inverse(pose), np.column_stack((x.ravel(), y.ravel())))
    column, row = np.floor((sources - origin) / edge).astype(np.int64).T
    inside = (row >= 0) & (row < rows) & (column >= 0) & (column < columns)
    moved = np.full(len(sources), UNKNOWN, dtype=np.int8)
    moved[inside] = states[row[inside], column[inside]]
    return MapFile(
        resolution=edge, origin=(float(low[0]), float(low[1])), states=moved.reshape(x.shape)
    )


class _DistanceField:
    """The distance [m] from any point to the truth's nearest visible wall surface."""

    def __init__(self, truth: TruthMap) -> None:
        frame = int(np.ceil(FARTHEST / truth.resolution))
        surface = np.pad(truth.visible_surface, frame)
        cells = ndimage.distance_transform_edt(~surface)
        self._distances = np.minimum(np.asarray(cells) * truth.resolution, FARTHEST)
        self._resolution = truth.resolution
        self._origin = np.asarray(truth.origin) - frame * truth.resolution

    def at(self, points: NDArray[np.float64]) -> NDArray[np.float64]:
        """Interpolated distances ``(n,)`` of points ``(n, 2)``; FARTHEST outside."""
        cells = (points - self._origin) / self._resolution - 0.5
        return np.asarray(
            ndimage.map_coordinates(
                self._distances, cells[:, ::-1].T, order=1, mode="constant", cval=FARTHEST
            )
        )


def _starts(max_shift: float, max_yaw: float) -> list[NDArray[np.float64]]:
    """A lattice of poses: five yaws, and five shifts along each axis, from bound to bound."""
    shares = np.linspace(-1.0, 1.0, 5)
    return [
        np.array([x * max_shift, y * max_shift, yaw * max_yaw])
        for yaw in shares
        for x in shares
        for y in shares
    ]
