"""Notices that a mapper has drawn the whole map anew, and by how much the robot's pose jumped."""

import math

import numpy as np

from mapping.geometry import Pose, compose, inverse
from mapping.grid import OccupancyGrid
from mapping.messages import Twist

NEW_SPEED_SHARE = 0.57
"""Share of a control period's motion that the newest command makes, the rest being as before: the
motors follow with a lag of half a period, 1 - (1 - exp(-2)) / 2."""


class MapJump:
    """Compares what a period should have moved the robot by with where the mapper has it now."""

    def __init__(self) -> None:
        self._redraws: int | None = None
        self._poses: list[Pose] = []

    def update(
        self, grid: OccupancyGrid, pose: Pose, commanded: Twist, period: float
    ) -> Pose | None:
        """Take the map and the pose of this period.

        Args:
            grid: The map; its ``redraws`` tell.
            pose: Pose of base_footprint in it ``(3,)``.
            commanded: What the robot was told in the period before.
            period: Control period [s].

        Returns:
            The pose ``(3,)`` of the old map's frame in the new one, as seen around the robot, if
            the map was drawn anew; composed with an old pose it gives the new one. Else None.
        """
        is_new = self._redraws is not None and grid.redraws != self._redraws
        self._redraws = grid.redraws
        jump = None
        if is_new and self._poses:
            jump = compose(pose, inverse(self._expected(commanded, period)))
        self._poses = [pose.copy()] if jump is not None else [*self._poses[-1:], pose.copy()]
        return jump

    def _expected(self, commanded: Twist, period: float) -> Pose:
        """Where the robot should be in the old map's frame."""
        newest = self._poses[-1]
        before = compose(inverse(self._poses[0]), newest)  # zero while there is only one
        way = NEW_SPEED_SHARE * commanded.linear_x * period
        way += (1.0 - NEW_SPEED_SHARE) * float(before[0])
        turn = NEW_SPEED_SHARE * commanded.angular_z * period
        turn += (1.0 - NEW_SPEED_SHARE) * float(before[2])
        return compose(newest, np.array([way, 0.0, turn]))


def shift_at(jump: Pose, place: Pose) -> float:
    """How far a jump moves a place ``(2,)`` or more of the old map [m]."""
    x, y, _ = (compose(jump, (place[0], place[1], 0.0)) - np.array([*place[:2], 0.0])).tolist()
    return math.hypot(x, y)
