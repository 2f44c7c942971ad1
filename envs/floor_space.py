"""Find the floor of a plan: the free cells joined to the start."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

from envs.floor_plan import FloorPlan, Point
from envs.plan_raster import lattice_for, rasterize


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class FloorSpace:
    """The floor round the start, as cells."""

    free: NDArray[np.bool_]
    """Cells ``[row = y, col = x]`` joined to the start's cell by edges, through free cells."""
    origin: Point
    """Lower-left corner of cell (0, 0) [m]."""
    resolution: float
    """Edge of a cell [m]."""
    enclosed: bool
    """Whether walls keep the floor within the plan; else it runs out to the raster's rim."""

    @property
    def area(self) -> float:
        """Area of the floor [m2]; of what lies within the plan's bounds when not enclosed."""
        return float(np.count_nonzero(self.free)) * self.resolution**2

    @property
    def extent(self) -> tuple[float, float, float, float]:
        """Edges of the raster: left, right, bottom, top [m]."""
        rows, columns = self.free.shape
        left, bottom = self.origin
        return left, left + columns * self.resolution, bottom, bottom + rows * self.resolution


def floor_space(plan: FloorPlan, *, resolution: float) -> FloorSpace:
    """Flood the floor of a plan from its start.

    Args:
        plan: The floor plan.
        resolution: Edge of a cell [m]; walls and gaps thinner than it may be missed.
    """
    origin, shape = lattice_for(plan, resolution, margin=2.0 * resolution)
    solid = rasterize(plan, resolution=resolution, origin=origin, shape=shape)
    labels, _ = ndimage.label(~solid)
    row = int((plan.start[1] - origin[1]) // resolution)
    column = int((plan.start[0] - origin[0]) // resolution)
    if not (0 <= row < shape[0] and 0 <= column < shape[1]) or solid[row, column]:
        # Outside the plan's bounds, or on a cell larger than the room that the start has.
        free = np.zeros(shape, dtype=np.bool_)
        return FloorSpace(free=free, origin=origin, resolution=resolution, enclosed=False)
    free = labels == labels[row, column]
    return FloorSpace(
        free=free, origin=origin, resolution=resolution, enclosed=not _reaches_rim(free)
    )


def enclosed_cells(solid: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """The cells ``[row, col]`` that are not solid and from which no way leads to the rim."""
    outside = np.pad(~solid, 1, constant_values=True)
    labels, _ = ndimage.label(outside)
    return np.asarray(outside & (labels != labels[0, 0]))[1:-1, 1:-1]


def _reaches_rim(free: NDArray[np.bool_]) -> bool:
    """Whether a cell at the rim is free."""
    return bool(free[0].any() or free[-1].any() or free[:, 0].any() or free[:, -1].any())
