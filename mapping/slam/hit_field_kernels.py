"""Kernels of the hit field: smear walls into it, read its height, slope and curvature.

The field has a layer for each of four sides that a wall can be seen from, +x, +y, -x and -y of the
field: the two faces of a thin wall, or of a corner, lie closer together than bells are wide, and a
reading of one must not be drawn to the other. A wall seen from between two sides is shared out by
the squares of the cosines, which add up to one.
"""

import math

import numpy as np
from numba import njit
from numpy.typing import NDArray

REACH = 3
"""A reading is smeared over this many cells to each side: three standard deviations."""

TAPS = 4
"""Cells along each axis that a cubic B-spline reads."""

KNOWN = 0.2
"""A reading at this density, a fifth of a wall seen by one scan, lies half on a known wall."""

SIDES = 4
"""Layers of a field."""

UNKNOWN_SIDE = 0.5
"""What a point that faces an unknown direction gives to every side."""

FAINT = 1e-3
"""Below this density there is nothing to be drawn to."""


@njit(cache=True)
def smear(
    density: NDArray[np.float32],
    pose: NDArray[np.float64],
    surface: NDArray[np.float32],
    resolution: float,
    height: float,
) -> tuple[int, int, int, int]:
    """Add to ``density`` a bell of one cell's standard deviation for each point of a surface.

    Args:
        density: The field ``(rows, columns, SIDES)``; what would fall outside is left out.
        pose: Where the surface was seen from ``(3,)``: x, y in cells from the corner, yaw [rad].
        surface: Its points ``(n, 5)``: x, y [m], weight, and the direction that it faces, zeros
            where that is not known.
        resolution: Edge of a cell [m].
        height: Height of the bell of a point of weight 1.

    Returns:
        The window that was written to: first row and one past the last, first column and one past
        the last; an empty one, the first past the last, when nothing was.
    """
    rows, columns, _ = density.shape
    first_row, last_row, first_column, last_column = rows, 0, columns, 0
    cos, sin = math.cos(pose[2]), math.sin(pose[2])
    along = np.empty(2 * REACH + 2, dtype=np.float32)
    sides = np.empty(SIDES, dtype=np.float32)
    for i in range(len(surface)):
        x = pose[0] + (cos * surface[i, 0] - sin * surface[i, 1]) / resolution - 0.5
        y = pose[1] + (sin * surface[i, 0] + cos * surface[i, 1]) / resolution - 0.5
        left, bottom = math.floor(x) - REACH, math.floor(y) - REACH
        right, top = left + 2 * REACH + 2, bottom + 2 * REACH + 2
        if right <= 0 or top <= 0 or left >= columns or bottom >= rows:
            continue
        side_shares(
            cos * surface[i, 3] - sin * surface[i, 4],
            sin * surface[i, 3] + cos * surface[i, 4],
            UNKNOWN_SIDE,
            sides,
        )
        first_row, last_row = min(first_row, max(bottom, 0)), max(last_row, min(top, rows))
        first_column = min(first_column, max(left, 0))
        last_column = max(last_column, min(right, columns))
        for k in range(2 * REACH + 2):
            along[k] = math.exp(-0.5 * (left + k - x) ** 2)
        for row in range(max(bottom, 0), min(top, rows)):
            high = np.float32(height * surface[i, 2] * math.exp(-0.5 * (row - y) ** 2))
            for column in range(max(left, 0), min(right, columns)):
                bell = high * along[column - left]
                for side in range(SIDES):
                    density[row, column, side] += bell * sides[side]
    return first_row, last_row, first_column, last_column


@njit(cache=True)
def side_shares(nx: float, ny: float, unknown: float, sides: NDArray[np.float32]) -> None:
    """Share a wall that faces a direction out among the sides.

    Args:
        nx: The direction along x; both 0 when it is not known.
        ny: And along y.
        unknown: What every side gets then.
        sides: Written ``(SIDES,)``.
    """
    if nx == 0.0 and ny == 0.0:
        for side in range(SIDES):
            sides[side] = unknown
        return
    sides[0] = max(nx, 0.0) ** 2
    sides[1] = max(ny, 0.0) ** 2
    sides[2] = max(-nx, 0.0) ** 2
    sides[3] = max(-ny, 0.0) ** 2


@njit(cache=True)
def spline_taps(
    offset: float,
    value: NDArray[np.float64],
    slope: NDArray[np.float64],
    curvature: NDArray[np.float64],
) -> None:
    """Weights of four neighbours of a cubic B-spline, and of its first two derivatives.

    Args:
        offset: Place between the second and the third neighbour, 0..1.
        value: Written: weights of the value ``(4,)``.
        slope: Written: weights of the first derivative per cell ``(4,)``.
        curvature: Written: weights of the second derivative per cell squared ``(4,)``.
    """
    t, u = offset, 1.0 - offset
    value[0], value[3] = u * u * u / 6.0, t * t * t / 6.0
    value[1] = 2.0 / 3.0 - t * t + 0.5 * t * t * t
    value[2] = 2.0 / 3.0 - u * u + 0.5 * u * u * u
    slope[0], slope[3] = -0.5 * u * u, 0.5 * t * t
    slope[1] = -2.0 * t + 1.5 * t * t
    slope[2] = 2.0 * u - 1.5 * u * u
    curvature[0], curvature[3] = u, t
    curvature[1] = -2.0 + 3.0 * t
    curvature[2] = -2.0 + 3.0 * u


@njit(cache=True)
def newton_terms(
    density: NDArray[np.float32],
    pose: NDArray[np.float64],
    points: NDArray[np.float64],
    normals: NDArray[np.float64],
    weights: NDArray[np.float64],
    outlier: float,
    gradient: NDArray[np.float64],
    hessian: NDArray[np.float64],
    scatter: NDArray[np.float64],
) -> tuple[float, float]:
    """Slope and curvature of the log likelihood of a scan over its pose.

    The log likelihood of a reading is ``log(density + outlier)``; its negative curvature in the
    plane is made positive semi-definite, so that the sum is a matrix that Newton's step can use.

    Args:
        density: The field ``(rows, columns, SIDES)``.
        pose: Pose of the scan in cells: x, y from the field's corner, yaw [rad] ``(3,)``.
        points: Readings in the scan's frame, in cells ``(n, 2)``.
        normals: Directions that the walls they lie on face, in the scan's frame ``(n, 2)``; a
            reading tells nothing along its wall. Zeros for a reading that may lie on any wall.
        weights: How much each reading tells ``(n,)``.
        outlier: Density that stands for readings of unknown things.
        gradient: Written: slope over x, y [1/cell] and yaw ``(3,)``.
        hessian: Written: negative curvature ``(3, 3)``.
        scatter: Written: sum of the outer products of the readings' own slopes ``(3, 3)``.

    Returns:
        The log likelihood, and the mean share of readings that lie on known walls, 0..1.
    """
    rows, columns, _ = density.shape
    sides = np.empty(SIDES, dtype=np.float32)
    gradient[:] = 0.0
    hessian[:] = 0.0
    scatter[:] = 0.0
    wx, sx, cx = np.empty(TAPS), np.empty(TAPS), np.empty(TAPS)
    wy, sy, cy = np.empty(TAPS), np.empty(TAPS), np.empty(TAPS)
    cos, sin = math.cos(pose[2]), math.sin(pose[2])
    likelihood = matched = total = 0.0
    log_outlier = math.log(outlier)
    for i in range(len(weights)):
        weight = weights[i]
        total += weight
        arm_x = cos * points[i, 0] - sin * points[i, 1]
        arm_y = sin * points[i, 0] + cos * points[i, 1]
        x, y = pose[0] + arm_x - 0.5, pose[1] + arm_y - 0.5
        column, row = math.floor(x), math.floor(y)
        if row < 1 or column < 1 or row >= rows - 2 or column >= columns - 2:
            likelihood += weight * log_outlier
            continue
        spline_taps(x - column, wx, sx, cx)
        spline_taps(y - row, wy, sy, cy)
        nx = cos * normals[i, 0] - sin * normals[i, 1]
        ny = sin * normals[i, 0] + cos * normals[i, 1]
        side_shares(nx, ny, 1.0, sides)
        if nx != 0.0 or ny != 0.0:  # a wall's own shares give back all of it, however it lies
            whole = np.float32(0.0)
            for side in range(SIDES):
                whole += sides[side] * sides[side]
            for side in range(SIDES):
                sides[side] /= whole
        height = dx = dy = dxx = dxy = dyy = 0.0
        for j in range(TAPS):
            line = line_x = line_xx = 0.0
            for k in range(TAPS):
                cell = np.float32(0.0)
                for side in range(SIDES):
                    cell += sides[side] * density[row - 1 + j, column - 1 + k, side]
                line += wx[k] * cell
                line_x += sx[k] * cell
                line_xx += cx[k] * cell
            height += wy[j] * line
            dx += wy[j] * line_x
            dxx += wy[j] * line_xx
            dy += sy[j] * line
            dxy += sy[j] * line_x
            dyy += cy[j] * line
        height = max(height, 0.0)
        level = height + outlier
        likelihood += weight * math.log(level)
        matched += weight * height / (height + KNOWN)
        if height < FAINT:
            continue
        gx, gy = dx / level, dy / level
        # negative curvature of log(level), its two eigenvalues not below 0
        a = gx * gx - dxx / level
        b = gx * gy - dxy / level
        c = gy * gy - dyy / level
        if nx != 0.0 or ny != 0.0:
            across = nx * gx + ny * gy
            bend = max(nx * nx * a + 2.0 * nx * ny * b + ny * ny * c, 0.0)
            gx, gy = across * nx, across * ny
            a, b, c = bend * nx * nx, bend * nx * ny, bend * ny * ny
        middle, spread = 0.5 * (a + c), math.hypot(0.5 * (a - c), b)
        high, low = middle + spread, middle - spread
        if high <= 0.0:
            continue
        if low < 0.0 and spread > 0.0:
            # keep only the part along the larger eigenvalue: high * n n'
            share_x = 0.5 + 0.25 * (a - c) / spread
            cross = 0.5 * b / spread
            a, b, c = high * share_x, high * cross, high * (1.0 - share_x)
        lever_x, lever_y = -arm_y, arm_x
        gx, gy = weight * gx, weight * gy
        g_yaw = gx * lever_x + gy * lever_y
        gradient[0] += gx
        gradient[1] += gy
        gradient[2] += g_yaw
        scatter[0, 0] += gx * gx
        scatter[0, 1] += gx * gy
        scatter[1, 1] += gy * gy
        scatter[0, 2] += gx * g_yaw
        scatter[1, 2] += gy * g_yaw
        scatter[2, 2] += g_yaw * g_yaw
        ax, ay = a * lever_x + b * lever_y, b * lever_x + c * lever_y
        hessian[0, 0] += weight * a
        hessian[0, 1] += weight * b
        hessian[1, 1] += weight * c
        hessian[0, 2] += weight * ax
        hessian[1, 2] += weight * ay
        hessian[2, 2] += weight * (ax * lever_x + ay * lever_y)
    hessian[1, 0], hessian[2, 0], hessian[2, 1] = hessian[0, 1], hessian[0, 2], hessian[1, 2]
    scatter[1, 0], scatter[2, 0], scatter[2, 1] = scatter[0, 1], scatter[0, 2], scatter[1, 2]
    return likelihood, matched / total if total > 0.0 else 0.0


@njit(cache=True)
def shares_of(density: NDArray[np.float32], shares: NDArray[np.uint8]) -> None:
    """Write how likely a reading at each cell belongs to a known wall, in 255ths."""
    rows, columns, _ = density.shape
    known = np.float32(KNOWN)
    for row in range(rows):
        for column in range(columns):
            height = np.float32(0.0)
            for side in range(SIDES):
                height += density[row, column, side]
            shares[row, column] = np.uint8(np.float32(255.0) * height / (height + known))
