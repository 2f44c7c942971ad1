"""Turns maps of any extent into pixels of one picture, which stays where it is as a map grows."""

import numpy as np
from numpy.typing import NDArray

from mapping.grid import UNKNOWN
from mapping.io.map_server import MapFile

MOST_WIDTH, MOST_HEIGHT, LEAST_WIDTH = 900, 860, 480
"""Size of the picture [pixels]; what is beside a small map is unknown."""

MARGIN = 0.2
"""Unknown space around what is known in the end [m]."""


class MapCanvas:
    """A picture in which a pixel is a whole number of cells or a cell a whole number of pixels.

    Args:
        last_map: What is known in the end, from edge to edge; it makes the bounds.
    """

    def __init__(self, last_map: MapFile) -> None:
        resolution = last_map.resolution
        margin = round(MARGIN / resolution)
        rows, columns = (side + 2 * margin for side in last_map.states.shape)
        self._block = max(-(-columns // MOST_WIDTH), -(-rows // MOST_HEIGHT))
        self._zoom = max(min(MOST_WIDTH // columns, MOST_HEIGHT // rows), 1)
        least = -(-LEAST_WIDTH * self._block // self._zoom)
        beside = max(least - columns, 0) // 2 + margin
        self._rows, self._columns = (
            -(-side // self._block) * self._block for side in (rows, max(columns, least))
        )
        self._left = last_map.origin[0] - beside * resolution
        self._bottom = last_map.origin[1] - margin * resolution
        self._resolution = resolution

    @property
    def pixels_per_metre(self) -> float:
        """The scale."""
        return float(self._zoom / (self._block * self._resolution))

    def states(self, drawn: MapFile) -> NDArray[np.int8]:
        """The state that each pixel ``(rows, columns)`` shows, the uppermost row first.

        Of several cells it is occupied if one of them is, else free if one is. What lies outside of
        the picture is left out.

        Args:
            drawn: A map with cells of the same size.
        """
        cells = np.full((self._rows, self._columns), UNKNOWN, dtype=np.int8)
        row = round((drawn.origin[1] - self._bottom) / self._resolution)
        column = round((drawn.origin[0] - self._left) / self._resolution)
        rows, from_rows = _overlap(row, drawn.states.shape[0], self._rows)
        columns, from_columns = _overlap(column, drawn.states.shape[1], self._columns)
        cells[rows, columns] = drawn.states[from_rows, from_columns]
        pooled = _pooled(_pooled(cells, self._block).T, self._block).T
        return pooled[::-1].repeat(self._zoom, axis=0).repeat(self._zoom, axis=1)

    def pixels(self, places: NDArray[np.float64]) -> NDArray[np.float64]:
        """Where places ``(n, 2)`` [m] are: right of and below the upper left corner ``(n, 2)``."""
        height = self._rows // self._block * self._zoom
        from_corner = (places - (self._left, self._bottom)) * self.pixels_per_metre
        return np.column_stack((from_corner[:, 0], height - from_corner[:, 1]))


def _overlap(start: int, count: int, size: int) -> tuple[slice, slice]:
    """Where ``count`` things from ``start`` on lie among ``size``, and which of them do."""
    first, end = min(max(start, 0), size), max(min(start + count, size), 0)
    end = max(first, end)
    return slice(first, end), slice(first - start, end - start)


def _pooled(cells: NDArray[np.int8], block: int) -> NDArray[np.int8]:
    """The greatest of each ``block`` rows, whole rows at a time: that is fast."""
    greatest = cells[::block].copy(order="K")
    for first in range(1, block):
        np.maximum(greatest, cells[first::block], out=greatest)
    return greatest
