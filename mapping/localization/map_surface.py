"""Turns a map into the faces of its walls: evenly spaced points that know which way they look."""

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

from mapping.localization.known_map import KnownMap

SMOOTHING = 0.03
"""Standard deviation over which a wall's direction is taken [m]."""


def map_surface(known: KnownMap, spacing: float) -> NDArray[np.float32]:
    """The faces of the walls, as ``ScanCloud.surface`` has them.

    Args:
        known: The map.
        spacing: How much of a wall a point of weight 1 stands for [m].

    Returns:
        Points ``(n, 5)``: x, y [m], weight, and the direction that they face, zeros if unknown.
    """
    free = known.free
    edge = known.occupied & ndimage.binary_dilation(free)
    rows, columns = np.nonzero(edge)
    openness = ndimage.gaussian_filter(
        free.astype(np.float32) - known.occupied, SMOOTHING / known.resolution
    )
    slope_y, slope_x = np.gradient(openness, axis=0), np.gradient(openness, axis=1)
    nx, ny = slope_x[rows, columns], slope_y[rows, columns]
    length = np.hypot(nx, ny)
    known_side = length > 0.0
    scale = np.where(known_side, 1.0 / np.where(known_side, length, 1.0), 0.0)
    surface = np.empty((len(rows), 5), dtype=np.float32)
    surface[:, 0] = known.origin[0] + (columns + 0.5) * known.resolution
    surface[:, 1] = known.origin[1] + (rows + 0.5) * known.resolution
    surface[:, 2] = known.resolution / spacing
    surface[:, 3], surface[:, 4] = nx * scale, ny * scale
    return surface
