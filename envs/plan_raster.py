"""Draw a floor plan into a raster of cells: solid or not."""

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from envs.fill_solids import fill_discs, fill_prisms
from envs.floor_plan import FloorPlan, Point
from envs.solids import Disc, Prism, Solid, bounds
from mapping.errors import TestbedError

SEAM = 1e-9
"""A cell's centre this near a solid counts as in it [m], so that no cell falls through the seam
between two pieces of a wall; far above rounding, far below anything that is measured."""

_ROUNDING = 1e-6
"""Part of a cell that a plan may reach out of the lattice: -0.3 / 0.05 is a little below -6."""

MAX_CELLS = 400_000_000
"""The largest raster that is made, 400 MB of cells: 200 x 200 m at 1 cm."""


def rasterize(
    plan: FloorPlan, *, resolution: float, origin: Point, shape: tuple[int, int]
) -> NDArray[np.bool_]:
    """The cells of a lattice that are solid: those whose centre lies in a solid.

    Args:
        plan: The floor plan.
        resolution: Edge of a cell [m].
        origin: Lower-left corner of cell (0, 0) in the world [m].
        shape: Rows (y) and columns (x).

    Returns:
        Cells ``[row = y, col = x]``, row 0 at the origin.

    Raises:
        TestbedError: The lattice has no cells, or more than ``MAX_CELLS``.
    """
    return rasterize_solids(plan.solids(), resolution=resolution, origin=origin, shape=shape)


def rasterize_solids(
    solids: Sequence[Solid],
    *,
    resolution: float,
    origin: Point,
    shape: tuple[int, int],
    slack: float = SEAM,
) -> NDArray[np.bool_]:
    """As ``rasterize``, for solids that are no plan yet; ``slack`` in place of ``SEAM``."""
    _check_resolution(resolution)
    if min(shape) < 1 or shape[0] * shape[1] > MAX_CELLS:
        raise TestbedError(f"raster: {shape[0]} x {shape[1]} cells; must be 1 to {MAX_CELLS} cells")
    raster = np.zeros(shape, dtype=np.bool_)
    left, bottom = float(origin[0]), float(origin[1])
    prisms = [solid.vertices for solid in solids if isinstance(solid, Prism)]
    if prisms:
        firsts = np.cumsum([0, *(len(vertices) for vertices in prisms)], dtype=np.int64)
        fill_prisms(raster, left, bottom, resolution, np.concatenate(prisms), firsts, slack)
    discs = [(*solid.center, solid.radius) for solid in solids if isinstance(solid, Disc)]
    if discs:
        fill_discs(raster, left, bottom, resolution, np.array(discs, dtype=np.float64), slack)
    return raster


def lattice_for(
    plan: FloorPlan, resolution: float, margin: float = 0.0
) -> tuple[Point, tuple[int, int]]:
    """The lattice that holds a plan and a margin [m] round it.

    Returns:
        Its origin [m], on whole multiples of the resolution, and its shape (rows, columns).
    """
    return lattice_round(plan.solids(), resolution, margin)


def lattice_round(
    solids: Sequence[Solid], resolution: float, margin: float = 0.0
) -> tuple[Point, tuple[int, int]]:
    """As ``lattice_for``, for solids that are no plan yet."""
    _check_resolution(resolution)
    lefts, rights, bottoms, tops = np.array([bounds(solid) for solid in solids]).T
    first_column = math.floor((lefts.min() - margin) / resolution + _ROUNDING)
    first_row = math.floor((bottoms.min() - margin) / resolution + _ROUNDING)
    columns = math.ceil((rights.max() + margin) / resolution - _ROUNDING) - first_column
    rows = math.ceil((tops.max() + margin) / resolution - _ROUNDING) - first_row
    return (first_column * resolution, first_row * resolution), (rows, columns)


def _check_resolution(resolution: float) -> None:
    """Refuse a cell of no size."""
    if not (math.isfinite(resolution) and resolution > 0.0):
        raise TestbedError(f"resolution: {resolution} m; must be a finite number above 0")
