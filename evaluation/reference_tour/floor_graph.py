"""Turns the truth of a floor plan into blocks of floor: what each one sees, the ways between them.

A truth in cells of 1 cm is too fine to search and too valuable to coarsen: a wall or a door in
coarse cells is not where it was. So the blocks only choose the places, and beams and ways are
checked against the truth's own cells.
"""

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import ArrayLike, NDArray

from evaluation.reference_tour.view_kernels import see_blocks
from evaluation.reference_tour.way_kernels import (
    link_blocks,
    pull_taut,
    spread,
    stand_points,
    walk_back,
)
from mapping.burger import LIDAR_RANGE_MAX
from mapping.errors import TestbedError
from mapping.truth import TruthMap

Mask = NDArray[np.bool_]

BLOCK = 0.05
"""Edge of a block [m]: a robot's centre passes a door of 0.30 m in a strip 0.09 m wide."""

FRAME = 2
"""Blocked blocks round the floor: as far as the farthest of 16 neighbours lies."""

BEAM_GAP = 0.5
"""Distance between two beams at their end, in blocks: a block's middle is as wide."""

SAMPLE = 0.25
"""Length of way between two looks around [m]; the robot's lidar turns once every 0.044 m."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Leg:
    """The shortest way from one block to another."""

    points: NDArray[np.float64]
    """Its corners ``(n, 2)`` [m], both ends included."""
    stops: NDArray[np.float64]
    """How far along it the robot looks around ``(k,)`` [m]: at its end, not at its beginning."""
    blocks: tuple[int, ...]
    """The blocks it then stands in ``(k,)``."""
    runs: NDArray[np.int32]
    """All that it sees from there, as runs of blocks ``(m, 2)``."""

    @property
    def length(self) -> float:
        """The way's length [m]."""
        return float(self.stops[-1])

    def until(self, length: float) -> NDArray[np.float64]:
        """Its corners ``(n, 2)`` [m] up to a length [m] along it, that place the last."""
        along = _along(self.points)
        end = [np.interp(length, along, self.points[:, axis]) for axis in (0, 1)]
        return np.vstack((self.points[along < length], end))


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class FloorGraph:
    """Blocks of a whole number of cells, joined where a robot can go straight from one to another.

    A block stands for the reachable cell nearest to its centre. It is joined with those of its 16
    neighbours to which the straight line crosses reachable cells only. Ways over 16 neighbours are
    at most 2.8 % longer than the shortest, and less after they are pulled taut.
    """

    resolution: float
    """Edge of a cell [m]."""
    origin: NDArray[np.float64]
    """Lower-left corner of the first cell ``(2,)`` [m]."""
    width: int
    """Cells in a row."""
    side: int
    """Cells along the edge of a block."""
    blocked: Mask
    """Cells that end a beam, flat."""
    free: Mask
    """Blocks without such a cell ``(blocks,)``."""
    reachable: Mask
    """Cells where the robot's centre can be, flat."""
    weights: NDArray[np.int32]
    """1 for a block whose middle cell is to be seen, else 0 ``(blocks,)``."""
    points: NDArray[np.int32]
    """The cell that a block stands for ``(blocks,)``; -1 where the robot cannot be."""
    links: NDArray[np.uint16]
    """The neighbours that each block is joined with, a bit each ``(blocks,)``."""
    _views: dict[int, NDArray[np.int32]] = field(default_factory=dict)
    _legs: dict[tuple[int, int], Leg] = field(default_factory=dict)

    def block_at(self, point: ArrayLike) -> int:
        """The block that a point x, y [m] lies in.

        Raises:
            TestbedError: The robot cannot be there.
        """
        x, y = np.asarray(point, dtype=np.float64)[:2]
        columns, rows = self.width, len(self.reachable) // self.width
        column, row = np.floor((np.array([x, y]) - self.origin) / self.resolution)
        if 0 <= column < columns and 0 <= row < rows:
            cell = int(row) * columns + int(column)
            if self.reachable[cell]:
                return int(self._blocks_of(np.array([cell]))[0])
        raise TestbedError(f"start: ({x:g}, {y:g}) m; must be where the robot can be")

    def position(self, block: int) -> NDArray[np.float64]:
        """Where a block's cell has its centre ``(2,)`` [m]."""
        position: NDArray[np.float64] = self._positions(self.points[[block]])[0]
        return position

    def view(self, block: int) -> NDArray[np.int32]:
        """The blocks seen from a block's cell, as runs ``(n, 2)``: first, one past the last."""
        if block not in self._views:
            reach = LIDAR_RANGE_MAX / self.resolution
            beams = int(np.ceil(2.0 * np.pi * reach / max(BEAM_GAP * self.side, 1.0)))
            cell = int(self.points[block])
            self._views[block] = see_blocks(
                self.blocked, self.free, self.width, self.side, cell, reach, beams
            )
        return self._views[block]

    def lengths_from(self, block: int, reach: float = np.inf) -> NDArray[np.float64]:
        """Lengths of the ways from a block to all ``(blocks,)`` [m], inf beyond ``reach`` [m]."""
        lengths, _ = self._spread(block, -1, reach)
        within: NDArray[np.float64] = lengths.astype(np.float64) * self.resolution
        return within

    def leg(self, a: int, b: int) -> Leg:
        """The way from one block to another that it is joined with, pulled taut."""
        if (a, b) not in self._legs:
            self._legs[a, b] = self._leg(a, b)
        return self._legs[a, b]

    def _leg(self, a: int, b: int) -> Leg:
        _, before = self._spread(a, b, np.inf)
        cells = walk_back(before, self.points, b)
        there = self._positions(pull_taut(cells, self.reachable, self.width))
        back = self._positions(pull_taut(cells[::-1].copy(), self.reachable, self.width)[::-1])
        points = there if _along(there)[-1] <= _along(back)[-1] else back
        along = _along(points)
        stops = np.linspace(0.0, along[-1], int(np.ceil(along[-1] / SAMPLE)) + 1)[1:]
        looks = np.column_stack([np.interp(stops, along, points[:, axis]) for axis in (0, 1)])
        columns, rows = np.floor((looks - self.origin) / self.resolution).astype(np.int64).T
        blocks = tuple(self._blocks_of(rows * self.width + columns).tolist())
        runs = np.concatenate([self.view(block) for block in dict.fromkeys(blocks)])
        return Leg(points=points, stops=stops, blocks=blocks, runs=runs)

    def _spread(
        self, block: int, target: int, reach: float
    ) -> tuple[NDArray[np.float32], NDArray[np.int32]]:
        cells = reach / self.resolution
        lengths, before = spread(
            self.links, self.points, self.width, self.side, block, target, cells
        )
        return lengths, before

    def _positions(self, cells: NDArray[np.integer]) -> NDArray[np.float64]:
        places = np.column_stack((cells % self.width, cells // self.width)) + 0.5
        positions: NDArray[np.float64] = self.origin + places * self.resolution
        return positions

    def _blocks_of(self, cells: NDArray[np.int64]) -> NDArray[np.int64]:
        rows, columns = cells // self.width // self.side, cells % self.width // self.side
        return rows * (self.width // self.side) + columns


def floor_graph(truth: TruthMap) -> FloorGraph:
    """Cut the part of a truth that can be seen into blocks of about BLOCK.

    A truth in coarser cells has a cell a block. How much floor is seen is counted by the blocks'
    middle cells, a regular sample of the truth's.
    """
    side = max(1, round(BLOCK / truth.resolution))
    rows = np.flatnonzero(truth.visible_free.any(axis=1))
    columns = np.flatnonzero(truth.visible_free.any(axis=0))
    part = np.s_[rows[0] : rows[-1] + 1, columns[0] : columns[-1] + 1]
    missing = [-int(np.ptp(ends) + 1) % side for ends in (rows, columns)]
    padding = [(FRAME * side + each // 2, FRAME * side + each - each // 2) for each in missing]
    first = np.array([columns[0] - padding[1][0], rows[0] - padding[0][0]])
    blocked = np.pad(truth.occupied[part], padding, constant_values=True)
    reachable = np.pad(truth.reachable[part], padding).ravel()
    wanted = np.pad(truth.visible_free[part], padding)
    width = blocked.shape[1]
    points = stand_points(reachable, width, side)
    return FloorGraph(
        resolution=truth.resolution,
        origin=np.asarray(truth.origin) + first * truth.resolution,
        width=width,
        side=side,
        blocked=blocked.ravel(),
        free=~blocked.reshape(-1, side, width // side, side).any(axis=(1, 3)).ravel(),
        reachable=reachable,
        weights=wanted[side // 2 :: side, side // 2 :: side].astype(np.int32).ravel(),
        points=points,
        links=link_blocks(points, reachable, width, side),
    )


def _along(points: NDArray[np.float64]) -> NDArray[np.float64]:
    """How far along a line each of its corners lies ``(n,)`` [m]."""
    steps = np.hypot(*np.diff(points, axis=0).T)
    return np.concatenate(([0.0], np.cumsum(steps)))
