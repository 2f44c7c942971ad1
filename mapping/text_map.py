"""Turns a map into a few lines of text: for a terminal, where no picture can be shown."""

import numpy as np
from numpy.typing import NDArray

from mapping.geometry import Pose
from mapping.grid import FREE, OCCUPIED, UNKNOWN, OccupancyGrid

ROBOT, UNSEEN = "●", "░"
BLOCKS = {(True, True): "█", (True, False): "▀", (False, True): "▄"}
"""How a character shows which of its upper and lower half is occupied."""


def text_map(grid: OccupancyGrid, pose: Pose, columns: int, lines: int) -> list[str]:
    """The known part of a map in at most ``lines`` lines of ``columns`` characters.

    A character is two square halves, one above the other; a half is occupied when anything in it
    is, else free when anything in it is.

    Args:
        grid: The map; nothing known of it gives no lines.
        pose: The robot's pose in the map frame ``(3,)``, shown as a dot.
        columns: Characters a line may have.
        lines: Lines there may be.
    """
    states = grid.states()
    known = states != UNKNOWN
    in_rows, in_columns = np.flatnonzero(known.any(axis=1)), np.flatnonzero(known.any(axis=0))
    if len(in_rows) == 0:
        return []
    low = np.array((in_rows[0], in_columns[0]))
    high = np.array((in_rows[-1], in_columns[-1])) + 1
    rows, width = high - low
    block = max(-(-int(rows) // (2 * lines)), -(-int(width) // columns), 1)
    halves = _pooled(states[low[0] : high[0], low[1] : high[1]], block)
    robot_row, robot_column = (grid.world_to_cell(pose[:2]) - low) // block
    text = []
    for row in range(0, len(halves), 2):
        characters = [_character(upper, lower) for lower, upper in halves[row : row + 2].T]
        if robot_row // 2 == row // 2 and 0 <= robot_column < len(characters):
            characters[robot_column] = ROBOT
        text.append("".join(characters))
    return text[::-1]


def _pooled(states: NDArray[np.int8], block: int) -> NDArray[np.int8]:
    """One state for each square of ``block`` cells, an even number of rows."""
    rows, columns = states.shape
    tall, wide = -(-rows // (2 * block)) * 2, -(-columns // block)
    padded = np.full((tall * block, wide * block), UNKNOWN, dtype=np.int8)
    padded[:rows, :columns] = states
    pooled: NDArray[np.int8] = padded.reshape(tall, block, wide, block).max(axis=(1, 3))
    return pooled


def _character(upper: int, lower: int) -> str:
    block = BLOCKS.get((upper == OCCUPIED, lower == OCCUPIED))
    if block is not None:
        return block
    return " " if FREE in (upper, lower) else UNSEEN
