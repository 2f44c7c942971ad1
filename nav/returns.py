"""Remembers where the lidar met something, long before a mapper is sure of a wall there.

A wall 3 m away returns beams 5 cm apart that scatter by centimetres, and one that the robot drives
along returns them decimetres apart. A fine map stays unknown there for many scans, and what is
unknown looks like a way on. Returns in the same planning cell in two scans say that it is none.
"""

import numpy as np
from numpy.typing import NDArray

from mapping.grid import OCCUPIED, OccupancyGrid
from nav.cell_memory import CellMemory
from nav.costmap import Costmap
from nav.returns_kernels import cells_between, wall_in_unknown
from nav.scan_points import ScanView

NO_WAY_THROUGH = 0.2
"""Between two neighbouring beams that met things so close together there is no way that the robot
fits through with room to spare [m]."""
NO_WAY_ALONG = 0.6
"""Nor is there one, most likely, in a straight wall that is seen at a grazing angle up to this [m]:
the lidar meets a wall 0.3 m to its side every 0.58 m, 3 m ahead. What is taken for wall wrongly
turns free when beams pass."""


class Returns:
    """The planning cells that scans met something in, once and more often.

    Walls that are most likely there, and those that surely are, are remembered apart: a narrow door
    may be taken for wall from afar, so somebody has to look closer before all is said to be known.
    """

    def __init__(self) -> None:
        self._likely = _Twice()
        self._sure = _Twice()

    def note(self, costmap: Costmap, view: ScanView) -> None:
        """Remember where a scan met something; what lies outside the map is ignored."""
        if costmap.states.size == 0:
            return
        self._likely.note(costmap, _cells(costmap, view, NO_WAY_ALONG))
        self._sure.note(costmap, _cells(costmap, view, NO_WAY_THROUGH))

    def take_over(self, costmap: Costmap, grid: OccupancyGrid) -> None:
        """Remember where a map that was drawn anew has been hit more often than passed.

        The mapper knows where its scans belong now, and the map has them all, though its cells,
        finer than beams are apart, do not all call a wall what is one.

        Args:
            costmap: Lies over the map.
            grid: The map.
        """
        rows, columns = costmap.states.shape
        factor = round(costmap.resolution / grid.resolution)
        hit = np.zeros((rows * factor, columns * factor), dtype=np.bool_)
        hit[: grid.shape[0], : grid.shape[1]] = grid.log_odds > 0.0
        cells = np.asarray(hit.reshape(rows, factor, columns, factor).any(axis=(1, 3)))
        self._likely.add(costmap, cells)
        self._sure.add(costmap, cells)

    def mark(self, costmap: Costmap, sure: bool = False) -> None:
        """Take cells with returns from two scans, unknown or next to unknown, for occupied.

        A wall may lie in the last cell whose greater part is free. Clearances stay.

        Args:
            costmap: What to mark on.
            sure: Whether to leave out what is most likely a wall seen at a grazing angle, but might
                be a narrow door in it.
        """
        again = (self._sure if sure else self._likely).again(costmap)
        rows, columns = wall_in_unknown(costmap.states, again).T
        costmap.states[rows, columns] = OCCUPIED


class _Twice:
    """The planning cells that something was noted in, once and more often."""

    def __init__(self) -> None:
        self._once = CellMemory()
        self._again = CellMemory()

    def note(self, costmap: Costmap, cells: NDArray[np.int64]) -> None:
        """Note cells ``(n, 2)`` of one scan; one may come more than once."""
        self._follow(costmap)
        rows, columns = cells.T
        again = self._once.marks[rows, columns]
        self._again.marks[rows[again], columns[again]] = True
        self._once.marks[rows, columns] = True

    def add(self, costmap: Costmap, cells: NDArray[np.bool_]) -> None:
        """Take cells ``[row, col]`` for noted often enough."""
        self._follow(costmap)
        self._again.marks |= cells

    def again(self, costmap: Costmap) -> NDArray[np.bool_]:
        """Whether each cell was noted in two scans or more."""
        self._follow(costmap)
        return self._again.marks

    def _follow(self, costmap: Costmap) -> None:
        self._once.follow(costmap)
        self._again.follow(costmap)


def _cells(costmap: Costmap, view: ScanView, straight_gap: float) -> NDArray[np.int64]:
    """The cells ``(n, 2)``, each once or more, that a scan met something in."""
    cells = cells_between(
        view.points,
        view.beams,
        len(view.ranges),
        NO_WAY_THROUGH,
        straight_gap,
        (float(costmap.origin[0]), float(costmap.origin[1]), costmap.resolution),
        costmap.states.shape,
    )
    return np.asarray(cells)
