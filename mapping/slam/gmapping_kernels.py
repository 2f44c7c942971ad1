"""Kernels of GMapping's scan matcher: how well a scan fits a particle's map, and a better pose.

Positions are in cells from the corner of the particle's table of tiles (``tile_map_kernels``).
Points of a scan are rows of four: x and y of a hit, and from there to the cell before it.
"""

import math

import numpy as np
from numba import njit
from numpy.typing import NDArray

from mapping.slam.tile_map_kernels import IN_TILE, TILE_CELLS, TILE_SHIFT, Means, Table, Words

MOVES = 6
"""Steps tried from each place: forth and back along x and y, and turning both ways."""

Array = NDArray[np.float64]


@njit(cache=True)
def match_particles(
    poses: Array,
    points: Array,
    steps: tuple[float, float],
    iterations: int,
    kernel: int,
    sharpness: float,
    least_score: float,
    tables: NDArray[np.int32],
    means: Means,
    full: Words,
) -> tuple[Array, Array]:
    """Match a scan with every particle's map.

    Args:
        poses: Where the odometry led each particle ``(particles, 3)``.
        points: The scan ``(n, 4)`` in base_footprint.
        steps: First step [cells] and first turn [rad] of the climbing.
        iterations: How often they are halved.
        kernel: Cells searched to each side of a hit.
        sharpness: Of the score, see ``fit``.
        least_score: A match that scores no more is not believed; the pose stays as it was.
        tables: The particles' tiles ``(particles, tile rows, tile columns)``.
        means: Of the pool.
        full: Of the pool.

    Returns:
        The matched poses ``(particles, 3)``, and of each its score, its sum of squared distances
        and its lost points ``(particles, 3)``.
    """
    matched, fits = poses.copy(), np.empty((len(poses), 3))
    bits = np.empty((tables.shape[1] * TILE_CELLS, tables.shape[2] + 1), dtype=np.uint32)
    turned = np.empty_like(points)
    for p in range(len(poses)):
        gather_full(tables[p], full, bits)
        x, y, yaw, score = climb(
            poses[p], points, steps, iterations, kernel, sharpness, bits, tables[p], means
        )
        if score > least_score:
            matched[p, 0], matched[p, 1], matched[p, 2] = x, y, yaw
        turn(matched[p, 2], points, turned)
        x, y = matched[p, 0], matched[p, 1]
        fits[p, 0], fits[p, 1], fits[p, 2] = fit(
            x, y, turned, kernel, sharpness, -1.0, bits, tables[p], means
        )
    return matched, fits


@njit(cache=True)
def climb(
    start: Array,
    points: Array,
    steps: tuple[float, float],
    iterations: int,
    kernel: int,
    sharpness: float,
    bits: Words,
    table: Table,
    means: Means,
) -> tuple[float, float, float, float]:
    """The pose near ``start`` whose scan fits best, by hill climbing, and its score.

    From each place the best of six steps is taken; when none is better, the steps are halved,
    ``iterations`` times in all.
    """
    x, y, yaw = start[0], start[1], start[2]
    linear, angular = steps
    turned, tried = np.empty_like(points), np.empty_like(points)
    turn(yaw, points, turned)
    best, _, _ = fit(x, y, turned, kernel, sharpness, -1.0, bits, table, means)
    halved = 0
    while halved <= iterations:
        before, from_x, from_y, from_yaw = best, x, y, yaw
        for move in range(MOVES):
            sign = 1.0 - 2.0 * (move & 1)
            to_x = from_x + (sign * linear if move < 2 else 0.0)
            to_y = from_y + (sign * linear if 2 <= move < 4 else 0.0)
            to_yaw = from_yaw + (sign * angular if move >= 4 else 0.0)
            if move >= 4:
                turn(to_yaw, points, tried)
            rays = tried if move >= 4 else turned
            score, _, _ = fit(to_x, to_y, rays, kernel, sharpness, best, bits, table, means)
            if score > best:
                best, x, y, yaw = score, to_x, to_y, to_yaw
        if yaw != from_yaw:
            turn(yaw, points, turned)
        if best <= before:
            halved += 1
            linear *= 0.5
            angular *= 0.5
    return x, y, yaw, best


@njit(cache=True)
def fit(
    x: float,
    y: float,
    turned: Array,
    kernel: int,
    sharpness: float,
    at_least: float,
    bits: Words,
    table: Table,
    means: Means,
) -> tuple[float, float, float]:
    """How well a scan taken from a pose fits the map.

    Each hit looks for full cells at most ``kernel`` rows and columns from its own cell, before
    which, a step back along the beam, lies a cell that is not full. The one counts whose mean hit
    is nearest to the hit.

    Args:
        x: Of the pose.
        y: Of the pose.
        turned: The scan's points, turned by the pose's yaw ``(n, 4)``.
        kernel: Cells searched to each side.
        sharpness: A hit ``d`` cells off scores exp(-sharpness * d * d).
        at_least: As soon as a score cannot exceed this the rest is not looked at; -1 for all.
        bits: The full cells, from ``gather_full``.
        table: The particle's tiles.
        means: Of the pool.

    Returns:
        The score, the sum of squared distances over the hits that found a cell, and how many hits
        found none.
    """
    width = 2 * kernel + 1
    mask = np.uint64((1 << width) - 1)
    last_row, last_column = bits.shape[0] - width - 1, (bits.shape[1] - 1) * TILE_CELLS - width - 1
    score, squares, lost = 0.0, 0.0, 0.0
    for i in range(len(turned)):
        if score + (len(turned) - i) <= at_least:
            break
        end_x, end_y = x + turned[i, 0], y + turned[i, 1]
        left, bottom = int(end_x) - kernel, int(end_y) - kernel
        if left < 1 or bottom < 1 or left > last_column or bottom > last_row:
            lost += 1.0
            continue
        before_left, rows_back = left + int(turned[i, 2]), int(turned[i, 3])
        word, place = left >> TILE_SHIFT, np.uint64(left & IN_TILE)
        before, before_place = before_left >> TILE_SHIFT, np.uint64(before_left & IN_TILE)
        nearest = np.inf
        for row in range(bottom, bottom + width):
            pair = np.uint64(bits[row, word + 1]) << np.uint64(TILE_CELLS)
            wanted = ((pair | np.uint64(bits[row, word])) >> place) & mask
            if wanted == 0:
                continue
            other = row + rows_back
            pair = np.uint64(bits[other, before + 1]) << np.uint64(TILE_CELLS)
            wanted &= ~((pair | np.uint64(bits[other, before])) >> before_place)
            column = left
            while wanted != 0:
                if wanted & np.uint64(1):
                    tile = table[row >> TILE_SHIFT, column >> TILE_SHIFT]
                    dx = end_x - (column + means[tile, row & IN_TILE, column & IN_TILE, 0])
                    dy = end_y - (row + means[tile, row & IN_TILE, column & IN_TILE, 1])
                    nearest = min(nearest, dx * dx + dy * dy)
                wanted >>= np.uint64(1)
                column += 1
        if nearest < np.inf:
            score += math.exp(-sharpness * nearest)
            squares += nearest
        else:
            lost += 1.0
    return score, squares, lost


@njit(cache=True)
def turn(yaw: float, points: Array, turned: Array) -> None:
    """Turn a scan's points into ``turned``; the way to the cell before becomes whole cells."""
    cos, sin = math.cos(yaw), math.sin(yaw)
    for i in range(len(points)):
        turned[i, 0] = cos * points[i, 0] - sin * points[i, 1]
        turned[i, 1] = sin * points[i, 0] + cos * points[i, 1]
        turned[i, 2] = math.floor(cos * points[i, 2] - sin * points[i, 3] + 0.5)
        turned[i, 3] = math.floor(sin * points[i, 2] + cos * points[i, 3] + 0.5)


@njit(cache=True)
def gather_full(table: Table, full: Words, bits: Words) -> None:
    """Lay the ``full`` words of a particle's tiles side by side.

    Args:
        table: The particle's tiles ``(tile rows, tile columns)``.
        full: Of the pool.
        bits: Written: a word per tile column and one of zeros for every row of cells
            ``(tile rows * TILE_CELLS, tile columns + 1)``.
    """
    for tile_row in range(table.shape[0]):
        for y in range(TILE_CELLS):
            row = tile_row * TILE_CELLS + y
            for tile_column in range(table.shape[1]):
                bits[row, tile_column] = full[table[tile_row, tile_column], y]
            bits[row, table.shape[1]] = 0


@njit(cache=True)
def sample_fits(
    pose: Array,
    offsets: Array,
    points: Array,
    kernel: int,
    bits: Words,
    table: Table,
    means: Means,
) -> Array:
    """Squared distances and lost points ``(m, 2)`` at offsets ``(m, 3)`` from a pose."""
    found, turned = np.empty((len(offsets), 2)), np.empty_like(points)
    for k in range(len(offsets)):
        turn(pose[2] + offsets[k, 2], points, turned)
        x, y = pose[0] + offsets[k, 0], pose[1] + offsets[k, 1]
        _, found[k, 0], found[k, 1] = fit(x, y, turned, kernel, 1.0, -1.0, bits, table, means)
    return found
