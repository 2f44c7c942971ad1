"""Turns a floor plan into places where the robot can be put down."""

import numpy as np

from envs.floor_plan import FloorPlan
from envs.truth import truth_of_plan
from mapping.burger import ROBOT_RADIUS

DRAW_RESOLUTION = 0.05
"""Raster on which places are drawn [m]."""

ELBOW_ROOM = 0.05
"""The robot is put down no nearer to a wall than its radius and this [m]."""


class Places:
    """Places where the robot can be put down: those it can reach from the plan's start."""

    def __init__(self, plan: FloorPlan) -> None:
        truth = truth_of_plan(
            plan, resolution=DRAW_RESOLUTION, robot_radius=ROBOT_RADIUS + ELBOW_ROOM
        )
        self._origin = truth.origin
        self._cells = np.argwhere(truth.reachable)

    def draw(self, rng: np.random.Generator) -> tuple[float, float, float]:
        """A pose, uniform over the places and over headings."""
        row, column = self._cells[rng.integers(len(self._cells))]
        x = self._origin[0] + (float(column) + 0.5) * DRAW_RESOLUTION
        y = self._origin[1] + (float(row) + 0.5) * DRAW_RESOLUTION
        return x, y, float(rng.uniform(-np.pi, np.pi))
