"""Numba kernels that fill solids into a raster, row by row."""

import math
from typing import Any

import numpy as np
from numba import njit
from numpy.typing import NDArray


@njit(cache=True)
def fill_prisms(
    raster: NDArray[np.bool_],
    left: float,
    bottom: float,
    resolution: float,
    vertices: NDArray[np.float64],
    firsts: NDArray[np.int64],
    slack: float,
) -> None:
    """Set the cells whose centres lie in convex prisms.

    A row cuts a convex polygon in one span, the overlap of what each edge allows.

    Args:
        raster: Cells ``[row = y, col = x]``, changed in place.
        left: Left edge of the raster [m].
        bottom: Bottom edge of the raster [m].
        resolution: Edge of a cell [m].
        vertices: Corners of all prisms ``(n, 2)``, each counter-clockwise [m].
        firsts: Where each prism begins in ``vertices``, and where the last one ends ``(m + 1,)``.
        slack: Centres this near a prism count as in it [m].
    """
    rows = raster.shape[0]
    for prism in range(len(firsts) - 1):
        corners = vertices[firsts[prism] : firsts[prism + 1]]
        low, high = corners[:, 1].min() - slack, corners[:, 1].max() + slack
        first_row = max(0, math.ceil((low - bottom) / resolution - 0.5))
        last_row = min(rows - 1, math.floor((high - bottom) / resolution - 0.5))
        for row in range(first_row, last_row + 1):
            y = bottom + (row + 0.5) * resolution
            span_left, span_right = corners[:, 0].min(), corners[:, 0].max()
            for i in range(len(corners)):
                x0, y0 = corners[i]
                x1, y1 = corners[(i + 1) % len(corners)]
                if min(y0, y1) - slack > y or y > max(y0, y1) + slack or abs(y1 - y0) <= slack:
                    continue
                crossing = x0 + (x1 - x0) * min(max((y - y0) / (y1 - y0), 0.0), 1.0)
                if y1 > y0:
                    span_right = min(span_right, crossing)
                else:
                    span_left = max(span_left, crossing)
            _fill_span(raster, row, left, resolution, span_left - slack, span_right + slack)


@njit(cache=True)
def fill_discs(
    raster: NDArray[np.bool_],
    left: float,
    bottom: float,
    resolution: float,
    discs: NDArray[np.float64],
    slack: float,
) -> None:
    """Set the cells whose centres lie in discs, rows ``(x, y, radius)`` [m]; else as above."""
    rows = raster.shape[0]
    for x, y, radius in discs:
        reach = radius + slack
        first_row = max(0, math.ceil((y - reach - bottom) / resolution - 0.5))
        last_row = min(rows - 1, math.floor((y + reach - bottom) / resolution - 0.5))
        for row in range(first_row, last_row + 1):
            dy = bottom + (row + 0.5) * resolution - y
            half = math.sqrt(max(0.0, reach * reach - dy * dy))
            _fill_span(raster, row, left, resolution, x - half, x + half)


@njit(cache=True)
def _fill_span(
    raster: Any, row: int, left: float, resolution: float, low: float, high: float
) -> None:
    """Set the cells of a row whose centres lie from low to high [m]."""
    first = max(0, math.ceil((low - left) / resolution - 0.5))
    last = min(raster.shape[1] - 1, math.floor((high - left) / resolution - 0.5))
    if first <= last:
        raster[row, first : last + 1] = True
