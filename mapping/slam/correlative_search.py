"""Searches all poses within a window for the one that lays most of a scan on known walls."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mapping.geometry import Pose, transform_points
from mapping.slam.correlative_kernels import search
from mapping.slam.hit_field import HitField, Window
from mapping.slam.scan_cloud import ScanCloud

FAR_SHARE = 90.0
"""Percentile of the points' distances at which one step of yaw moves a point by one cell."""

SHIFT_PULL, TURN_PULL = 0.05, 0.2
"""How much score a shift of the whole window, or a turn of it, costs: of poses that match alike,
the one nearer to the prediction is right."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Found:
    """The best pose of a window."""

    pose: Pose
    """In cells of the field ``(3,)``; the window's middle when nothing scored above the floor."""
    score: float
    """Share of the scan on known walls, 0..1, less what the distance from the middle costs."""


def search_window(
    field: HitField,
    cloud: ScanCloud,
    center: NDArray[np.float64],
    shift: float,
    turn: float,
    floor: float = 0.0,
) -> Found:
    """Look at every whole cell within ``shift`` and every yaw within ``turn`` of a pose.

    Args:
        field: The field.
        cloud: The scan; must have points.
        center: The middle of the window ``(3,)`` in cells of the field.
        shift: Half the window's width [m], at least one cell is searched.
        turn: Half the range of yaw [rad].
        floor: Only scores above this are looked for; the higher, the faster.
    """
    points = cloud.points / field.resolution
    far = max(float(np.percentile(np.hypot(points[:, 0], points[:, 1]), FAR_SHARE)), 1.0)
    turns = np.linspace(-turn, turn, 2 * math.ceil(turn * far) + 1)
    reach = max(math.ceil(shift / field.resolution), 1)
    worth = cloud.weights * np.minimum(np.hypot(points[:, 0], points[:, 1]), far)
    pull = np.array([SHIFT_PULL / reach**2, TURN_PULL / turn**2 if turn > 0.0 else 0.0])
    window = _window(field, points, center, turn, reach)
    corner = np.array([window[2], window[0], 0.0])
    score, index, shift_x, shift_y = search(
        field.maxima(window, _levels(reach)),
        points,
        worth / worth.sum(),
        center - corner,
        turns,
        reach,
        pull,
        floor,
    )
    if index < 0:
        return Found(pose=center, score=0.0)
    return Found(pose=center + np.array([shift_x, shift_y, turns[index]]), score=score)


def _window(
    field: HitField,
    points: NDArray[np.float64],
    center: NDArray[np.float64],
    turn: float,
    reach: int,
) -> Window:
    """The part of the field that the points can come to lie in; never empty."""
    spread = np.hypot(points[:, 0], points[:, 1]) * min(turn, 2.0)  # a chord is no longer
    placed = transform_points(center, points)
    margin = spread[:, None] + reach + 1.0
    left, bottom = np.floor((placed - margin).min(axis=0)).astype(int)
    right, top = np.ceil((placed + margin).max(axis=0)).astype(int) + 1
    rows, columns, _ = field.density.shape
    first_row, first_column = min(max(bottom, 0), rows - 1), min(max(left, 0), columns - 1)
    last_row, last_column = (
        max(min(top, rows), first_row + 1),
        max(min(right, columns), first_column + 1),
    )
    return first_row, last_row, first_column, last_column


def _levels(reach: int) -> int:
    """Levels of block maxima for shifts up to ``reach`` cells: the top blocks are half as wide."""
    return max(int(math.log2(max(reach, 1))), 1) + 1
