"""Turns the beams of a scan into the outline of the space that they saw free.

A lidar of 360 beams leaves gaps of several cells between them: at 3 m two neighbours are 5 cm
apart. The gap between two that agree is as free as the beams themselves (the beam cone of
Probabilistic Robotics, table 9.2), so free space is the union of wedges between neighbours. Where
two disagree, at the edge of a thing, the wedge ends at the nearer one, and what the farther beam
saw beyond is a strip one cell wide.

The outline is a set of directed edges; a point is inside when they wind around it. Edges that two
wedges share in opposite directions cancel out, so only the outer ones are made. Within about a cell
of a moving sensor wedges turn over and may cancel one another: under the robot, for a scan or two.
"""

import numpy as np
from numba import njit
from numpy.typing import NDArray

APART, DISAGREE, AGREE = 0, 1, 2
"""Two beams: no neighbours; neighbours that saw different things; that saw the same surface."""

EDGES_PER_BEAM = 7
"""At most: one between cuts, one outer edge, one of the sensor's path, four of a strip."""

STRIP_HALF_WIDTH = 0.5
"""Half the width, in cells, of what a beam without agreeing neighbours saw."""

AGREE_SIGMAS = 3.0
"""Neighbours whose lengths differ by less than this many standard deviations may agree."""

AGREE_SLOPE = 4.0
"""A surface seen at up to 76 degrees from its normal, of which this is the tangent, makes
neighbours differ by this many times their distance."""


@njit(cache=True)
def compare_neighbours(
    directions: NDArray[np.float64],
    lengths: NDArray[np.float64],
    sigmas: NDArray[np.float64],
    hits: NDArray[np.bool_],
    widest: float,
) -> NDArray[np.uint8]:
    """How each beam and the next, the last one's being the first, go together ``(n,)``.

    Args:
        directions: Unit vectors of the beams ``(n, 2)``, counter-clockwise one after another.
        lengths: Lengths of the beams ``(n,)``.
        sigmas: Standard deviations of the lengths ``(n,)``, in the same unit.
        hits: Whether a beam met something ``(n,)``.
        widest: Beams that are this far apart [rad] or farther are no neighbours.
    """
    count = len(lengths)
    pairs = np.full(count, APART, dtype=np.uint8)
    for i in range(count):
        j = (i + 1) % count
        sine = directions[i, 0] * directions[j, 1] - directions[i, 1] * directions[j, 0]
        cosine = directions[i, 0] * directions[j, 0] + directions[i, 1] * directions[j, 1]
        if sine > 0.0 and cosine > np.cos(widest):
            noise = AGREE_SIGMAS * np.hypot(sigmas[i], sigmas[j])
            slope = AGREE_SLOPE * sine * min(lengths[i], lengths[j])
            same = hits[i] == hits[j] and abs(lengths[i] - lengths[j]) <= noise + slope
            pairs[i] = AGREE if same else DISAGREE
    return pairs


@njit(cache=True)
def free_outline(
    origins: NDArray[np.float64],
    directions: NDArray[np.float64],
    lengths: NDArray[np.float64],
    pairs: NDArray[np.uint8],
) -> NDArray[np.float64]:
    """The edges ``(m, 4)`` x0, y0, x1, y1 around what beams saw free, in cells.

    Args:
        origins: Where each beam starts ``(n, 2)`` in cells.
        directions: Unit vectors of the beams ``(n, 2)``, counter-clockwise one after another.
        lengths: How far each beam saw space free ``(n,)`` in cells.
        pairs: How each beam and the next go together ``(n,)``, of ``compare_neighbours``.
    """
    count = len(lengths)
    edges = np.empty((EDGES_PER_BEAM * count, 4))
    made = 0
    for i in range(count):
        before, after = (i - 1) % count, (i + 1) % count
        x, y = origins[i]
        dx, dy = directions[i]
        cut_before = _wedge_length(lengths[i], lengths[before], pairs[before])
        cut = _wedge_length(lengths[i], lengths[after], pairs[i])
        if cut != cut_before:
            made = _add(
                edges, made, x + cut_before * dx, y + cut_before * dy, x + cut * dx, y + cut * dy
            )
        if pairs[i] != APART:
            next_x, next_y = origins[after]
            next_dx, next_dy = directions[after]
            next_cut = _wedge_length(lengths[after], lengths[i], pairs[i])
            end_x, end_y = next_x + next_cut * next_dx, next_y + next_cut * next_dy
            made = _add(edges, made, x + cut * dx, y + cut * dy, end_x, end_y)
            made = _add(edges, made, next_x, next_y, x, y)
        wedge = max(cut_before, cut)
        if lengths[i] > wedge:
            made = _add_strip(edges, made, x, y, dx, dy, wedge, lengths[i])
    return edges[:made]


@njit(cache=True)
def _wedge_length(length: float, other: float, pair: int) -> float:
    """How far along a beam its wedge with a neighbour goes; 0 where there is none."""
    if pair == APART:
        return 0.0
    return length if pair == AGREE else min(length, other)


@njit(cache=True)
def _add(edges: NDArray[np.float64], made: int, x0: float, y0: float, x1: float, y1: float) -> int:
    """Add one edge; returns how many there are."""
    edges[made, 0], edges[made, 1], edges[made, 2], edges[made, 3] = x0, y0, x1, y1
    return made + 1


@njit(cache=True)
def _add_strip(
    edges: NDArray[np.float64],
    made: int,
    x: float,
    y: float,
    dx: float,
    dy: float,
    start: float,
    end: float,
) -> int:
    """Add the four edges around a piece of a single beam, counter-clockwise."""
    left_x, left_y = -STRIP_HALF_WIDTH * dy, STRIP_HALF_WIDTH * dx
    near_x, near_y, far_x, far_y = x + start * dx, y + start * dy, x + end * dx, y + end * dy
    right_x, right_y = -left_x, -left_y
    made = _add(edges, made, near_x + right_x, near_y + right_y, far_x + right_x, far_y + right_y)
    made = _add(edges, made, far_x + right_x, far_y + right_y, far_x + left_x, far_y + left_y)
    made = _add(edges, made, far_x + left_x, far_y + left_y, near_x + left_x, near_y + left_y)
    _add(edges, made, near_x + left_x, near_y + left_y, near_x + right_x, near_y + right_y)
    return made + 1
