"""The field that scans are matched with: every reading smeared into a bell, all bells added up.

Its logarithm is the log likelihood of a reading (a kernel density estimate with a floor for
readings of unknown things), so a wall seen often is no broader than one seen once, and its middle
stays where the readings' mean is, however coarse the cells: bells are added at the exact place.
"""

import numpy as np
from numpy.typing import ArrayLike, NDArray

from mapping.slam.correlative_kernels import block_maxima
from mapping.slam.hit_field_kernels import SIDES, shares_of, smear

BELL_SUM = float(np.sqrt(2.0 * np.pi))
"""Bells one cell apart along a wall add up to this height, in the height of one."""

Window = tuple[int, int, int, int]
"""First row and one past the last, first column and one past the last."""


class HitField:
    """A square field of readings around a place."""

    def __init__(self, resolution: float, half_width: float, outlier: float) -> None:
        """Make an empty field.

        Args:
            resolution: Edge of a cell, and standard deviation of a bell [m].
            half_width: From the middle to the edges [m].
            outlier: Density that stands for readings of things not in the field yet; a wall seen
                by one scan has density 1.
        """
        self.resolution = resolution
        self.outlier = outlier
        self._half_cells = round(half_width / resolution)
        side = 2 * self._half_cells
        self.density: NDArray[np.float32] = np.zeros((side, side, SIDES), dtype=np.float32)
        self.corner = np.zeros(2)
        self._written: Window = (side, 0, side, 0)

    @property
    def center(self) -> NDArray[np.float64]:
        """The middle of the field ``(2,)`` [m]."""
        return self.corner + self._half_cells * self.resolution

    def clear(self, center: ArrayLike) -> None:
        """Empty the field and lay its middle on a place ``(2,)`` [m]."""
        cells = np.round(np.asarray(center, dtype=np.float64) / self.resolution)
        self.corner = (cells - self._half_cells) * self.resolution
        first_row, last_row, first_column, last_column = self._written
        self.density[first_row:last_row, first_column:last_column] = 0.0
        rows, columns, _ = self.density.shape
        self._written = (rows, 0, columns, 0)

    def add(self, pose: ArrayLike, surface: NDArray[np.float32]) -> None:
        """Smear the walls that a scan saw into the field.

        Args:
            pose: Where it was taken ``(3,)``, in the frame of the field.
            surface: The walls ``(n, 5)``: x, y [m], weight and the direction that they face, points
                a resolution apart.
        """
        cells = self.to_cells(pose)
        written = smear(self.density, cells, surface, self.resolution, 1.0 / BELL_SUM)
        self._written = (
            min(self._written[0], written[0]),
            max(self._written[1], written[1]),
            min(self._written[2], written[2]),
            max(self._written[3], written[3]),
        )

    def maxima(self, window: Window, levels: int) -> NDArray[np.uint8]:
        """Block maxima ``(levels, rows, columns)`` of what is known in a window of the field.

        Of each cell that is the share, in 255ths, of readings there that lie on known walls.
        """
        top, bottom, left, right = window
        shares = np.empty((bottom - top, right - left), dtype=np.uint8)
        shares_of(self.density[top:bottom, left:right], shares)
        return block_maxima(shares, levels)

    def to_cells(self, pose: ArrayLike) -> NDArray[np.float64]:
        """A pose ``(3,)`` with its position in cells from the corner."""
        x, y, yaw = np.asarray(pose, dtype=np.float64)
        left, bottom = self.corner
        return np.array([(x - left) / self.resolution, (y - bottom) / self.resolution, yaw])

    def to_metres(self, pose: ArrayLike) -> NDArray[np.float64]:
        """The pose ``(3,)`` that ``to_cells`` made this one of."""
        x, y, yaw = np.asarray(pose, dtype=np.float64)
        left, bottom = self.corner
        return np.array([left + x * self.resolution, bottom + y * self.resolution, yaw])
