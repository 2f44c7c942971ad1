"""Keeps poses over time in one growing table: 32 bytes a row, however long the run."""

import numpy as np
from numpy.typing import NDArray

from mapping.geometry import Pose

FIRST_ROWS = 1024
"""Rows held at the start; the table doubles when it is full."""


class PoseHistory:
    """Stamps and poses, a row each; ``add`` adds it whole or not at all, Ctrl-C or not."""

    def __init__(self) -> None:
        self._rows = np.empty((FIRST_ROWS, 4))
        self._count = 0

    @classmethod
    def of(cls, stamps: NDArray[np.float64], poses: Pose) -> "PoseHistory":
        """The history with stamps ``(n,)`` and poses ``(n, 3)``."""
        history = cls()
        history._rows = np.column_stack((stamps, poses))
        history._count = len(stamps)
        return history

    def __len__(self) -> int:
        return self._count

    def add(self, stamp: float, pose: Pose) -> None:
        """Add a stamp [s] and its pose ``(3,)``."""
        if self._count == len(self._rows):
            more = np.empty((max(self._count, FIRST_ROWS), 4))
            self._rows = np.concatenate((self._rows, more))
        self._rows[self._count, 0] = stamp
        self._rows[self._count, 1:] = pose
        self._count += 1

    @property
    def stamps(self) -> NDArray[np.float64]:
        """The stamps ``(n,)`` [s], in the order in which they came."""
        return self._rows[: self._count, 0].copy()

    @property
    def poses(self) -> Pose:
        """The poses ``(n, 3)``."""
        return self._rows[: self._count, 1:].copy()
