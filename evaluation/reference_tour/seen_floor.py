"""Counts how much of a floor the views of a growing or shrinking tour have seen."""

import numpy as np
from numpy.typing import NDArray

from evaluation.reference_tour.floor_graph import FloorGraph
from evaluation.reference_tour.view_kernels import count_views, unseen_weight

Runs = NDArray[np.int32]
"""What views show, as runs of blocks ``(n, 2)``: first, one past the last."""


class SeenFloor:
    """How many of a tour's views show each block, and whether together they show enough."""

    def __init__(self, floor: FloorGraph, share: float) -> None:
        """Begin with no views, of which a share 0..1 of the floor is to be seen."""
        self._floor = floor
        self._views = np.zeros(len(floor.weights), dtype=np.int32)
        self._total = int(floor.weights.sum())
        self._goal = share * self._total
        self._seen = 0

    @property
    def enough(self) -> bool:
        """Whether the share is seen."""
        return self._seen >= self._goal

    @property
    def coverage(self) -> float:
        """The share 0..1 that is seen; 1 of no floor."""
        return self._seen / self._total if self._total else 1.0

    def gain(self, runs: Runs) -> int:
        """How many blocks of some runs nobody has seen."""
        return int(unseen_weight(runs, self._floor.weights, self._views))

    def add(self, runs: Runs) -> None:
        """Count a view of some runs."""
        self._seen += int(count_views(runs, self._floor.weights, self._views, 1))

    def remove(self, runs: Runs) -> None:
        """Take back a view of some runs."""
        self._seen -= int(count_views(runs, self._floor.weights, self._views, -1))
