"""Kernel that moves a belief over cells of x, y and yaw."""

import math

import numpy as np
from numba import njit
from numpy.typing import NDArray


@njit(cache=True)
def shift_belief(
    belief: NDArray[np.float64],
    motion: tuple[float, float, float],
    resolution: float,
    least: float,
) -> NDArray[np.float64]:
    """The belief after a motion, each cell's share going to the eight cells around its new middle.

    Args:
        belief: ``[yaw, row = y, col = x]``; yaw layers go round in 2 pi, the first at yaw 0.
        motion: The new pose in the frame of the old one: ahead, to the left [m], turn [rad].
        resolution: Edge of a cell [m].
        least: Cells with less belief than this are left out.

    Returns:
        The new belief; what would leave the raster is lost.
    """
    layers, rows, columns = belief.shape
    step = 2.0 * math.pi / layers
    moved = np.zeros_like(belief)
    turn = motion[2] / step
    whole_turn = math.floor(turn)
    part_turn = turn - whole_turn
    for layer in range(layers):
        cos, sin = math.cos(layer * step), math.sin(layer * step)
        dx = (cos * motion[0] - sin * motion[1]) / resolution
        dy = (sin * motion[0] + cos * motion[1]) / resolution
        whole_x, whole_y = math.floor(dx), math.floor(dy)
        part_x, part_y = dx - whole_x, dy - whole_y
        for row in range(rows):
            for column in range(columns):
                share = belief[layer, row, column]
                if share < least:
                    continue
                for k in range(2):
                    to_layer = int(layer + whole_turn + k) % layers
                    by_turn = share * (part_turn if k == 1 else 1.0 - part_turn)
                    for j in range(2):
                        to_row = int(row + whole_y + j)
                        if to_row < 0 or to_row >= rows:
                            continue
                        by_row = by_turn * (part_y if j == 1 else 1.0 - part_y)
                        for i in range(2):
                            to_column = int(column + whole_x + i)
                            if 0 <= to_column < columns:
                                by_column = part_x if i == 1 else 1.0 - part_x
                                moved[to_layer, to_row, to_column] += by_row * by_column
    return moved
