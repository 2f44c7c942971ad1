"""A layer of marks on the planning cells that stays in place while the map grows."""

import numpy as np
from numpy.typing import NDArray

from nav.costmap import Costmap


class CellMemory:
    """Which planning cells were ever marked; ``marks`` fits the costmap after ``follow``."""

    def __init__(self) -> None:
        self.marks: NDArray[np.bool_] = np.zeros((0, 0), dtype=np.bool_)
        self._origin = np.zeros(2)

    def follow(self, costmap: Costmap) -> None:
        """Move the marks onto the costmap's cells if the map has grown since."""
        shape = costmap.states.shape
        if shape == self.marks.shape and np.array_equal(self._origin, costmap.origin):
            return
        marked, origin = np.argwhere(self.marks), self._origin
        self.marks = np.zeros(shape, dtype=np.bool_)
        self._origin = costmap.origin.copy()
        if len(marked):
            column_shift, row_shift = np.round((origin - self._origin) / costmap.resolution)
            cells = marked + np.array([row_shift, column_shift], dtype=np.int64)
            inside = np.all((cells >= 0) & (cells < shape), axis=1)
            self.marks[cells[inside, 0], cells[inside, 1]] = True
