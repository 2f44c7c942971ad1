"""Turns a map and the truth into scores: how much is covered, how sharp and right the walls are.

The two need not lie on the same lattice: the scores work on the centres of cells in metres, and
read the map at the truth's centres, or the truth at the map's. On one lattice that is exact.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage
from scipy.spatial import KDTree

from mapping.coverage import ROUNDING, CoverageMeter
from mapping.grid import FREE, OCCUPIED, UNKNOWN, OccupancyGrid
from mapping.io.map_server import MapFile
from mapping.truth import TruthMap

__all__ = ["CoverageMeter", "MapScores", "score_map"]

FINE_MATCH, LOOSE_MATCH = 0.05, 0.10
"""A wall cell within this of one of the other map's matches it [m] (f1_5cm, f1_10cm)."""

H95 = 95.0
"""Percentile of h95_m: the Hausdorff distance without its outliers."""

_DECIMALS = 9
"""Distances are told to the nanometre: what is finer is rounding."""

_States = NDArray[np.int8]
_Distances = NDArray[np.float64]


@dataclass(frozen=True, slots=True, kw_only=True)
class MapScores:
    """How good a map is; None where a value cannot exist, as a distance without any wall."""

    coverage: float | None
    """Share of the truth's visible free cells that the map calls free."""
    f1_5cm: float | None
    """Harmonic mean of precision, the share of the map's occupied cells within 5 cm of a visible
    wall surface of the truth, and recall, the share of those surface cells within 5 cm of an
    occupied cell. 0 when the map has no occupied cell; None when the truth has no surface."""
    f1_10cm: float | None
    """The same within 10 cm."""
    adnn_m: float | None
    """Mean distance from each occupied cell to the nearest surface cell and from each surface cell
    to the nearest occupied cell, over all of these distances [m]."""
    h95_m: float | None
    """95th percentile of the same distances [m]."""
    free_iou: float | None
    """Cells free in the map and visibly free in the truth, over cells that are either."""
    false_free: float | None
    """Share of the map's free cells that lie in a wall of the truth and are not of its outermost
    layer of cells."""
    wall_thickness_ratio: float | None
    """Thickness of the drawn walls in cells: area of the map's occupied cells over the length of
    surface that has one within 10 cm, one cell's edge for each such surface cell. 1 is a wall one
    cell thick; a wall drawn twice, as by drift, counts twice."""


@dataclass(frozen=True, slots=True, kw_only=True)
class _FreeCells:
    """How many of a map's cells are free."""

    all: int
    outside: int
    """Off the truth's raster."""
    marked: int
    """Where a mask of the truth is True."""


def score_map(grid: OccupancyGrid | MapFile, truth: TruthMap) -> MapScores:
    """Compare a map with the truth, both in one frame, without aligning them."""
    states = grid.states() if isinstance(grid, OccupancyGrid) else grid.states
    states, origin = _known_part(states, (grid.origin[0], grid.origin[1]), grid.resolution)
    occupied = _centres(states == OCCUPIED, origin, grid.resolution)
    surface = _centres(truth.visible_surface, truth.origin, truth.resolution)
    to_surface, to_occupied = _nearest(occupied, surface), _nearest(surface, occupied)
    both_ways = np.concatenate((to_surface, to_occupied))
    exist = len(occupied) > 0 and len(surface) > 0
    coverage, free_iou = _free_scores(states, origin, grid.resolution, truth)
    return MapScores(
        coverage=coverage,
        f1_5cm=_f1(to_surface, to_occupied, FINE_MATCH),
        f1_10cm=_f1(to_surface, to_occupied, LOOSE_MATCH),
        adnn_m=float(both_ways.mean()) if exist else None,
        h95_m=float(np.percentile(both_ways, H95)) if exist else None,
        free_iou=free_iou,
        false_free=_false_free(states, origin, grid.resolution, truth),
        wall_thickness_ratio=_thickness(to_surface, to_occupied, grid.resolution, truth.resolution),
    )


def _known_part(
    states: _States, origin: tuple[float, float], resolution: float
) -> tuple[_States, tuple[float, float]]:
    """The smallest part of a map that holds all it knows, and that part's corner [m]."""
    known = states != UNKNOWN
    rows, columns = np.flatnonzero(known.any(axis=1)), np.flatnonzero(known.any(axis=0))
    if rows.size == 0:
        return states[:0, :0], origin
    part = states[rows[0] : rows[-1] + 1, columns[0] : columns[-1] + 1]
    x, y = origin
    return part, (float(x + columns[0] * resolution), float(y + rows[0] * resolution))


def _centres(
    cells: NDArray[np.bool_], origin: tuple[float, float], resolution: float
) -> NDArray[np.float64]:
    """The centres ``(n, 2)`` as (x, y) [m] of the cells that are True."""
    return np.asarray((np.argwhere(cells)[:, ::-1] + 0.5) * resolution + np.asarray(origin))


def _nearest(points: NDArray[np.float64], others: NDArray[np.float64]) -> _Distances:
    """The distance [m] of each point ``(n, 2)`` to the nearest of the others; inf without any."""
    if len(points) == 0 or len(others) == 0:
        return np.full(len(points), np.inf)
    distances, _ = KDTree(others).query(points)
    return np.asarray(np.round(distances, _DECIMALS), dtype=np.float64)


def _f1(to_surface: _Distances, to_occupied: _Distances, within: float) -> float | None:
    """F1 of occupied cells against surface cells that match within a distance [m]."""
    if len(to_occupied) == 0:
        return None
    matched_surface = np.count_nonzero(to_occupied <= within)
    matched_occupied = np.count_nonzero(to_surface <= within)
    if matched_surface == 0 or matched_occupied == 0:
        return 0.0
    recall, precision = matched_surface / len(to_occupied), matched_occupied / len(to_surface)
    return float(2.0 * precision * recall / (precision + recall))


def _free_scores(
    states: _States, origin: tuple[float, float], resolution: float, truth: TruthMap
) -> tuple[float | None, float | None]:
    """Coverage and free_iou, with areas counted in cells of the truth."""
    columns = _cells_at(truth.origin[0], truth.resolution, truth.shape[1], origin[0], resolution)
    rows = _cells_at(truth.origin[1], truth.resolution, truth.shape[0], origin[1], resolution)
    free_here = np.zeros(truth.shape, dtype=np.bool_)
    in_rows = (rows >= 0) & (rows < states.shape[0])
    in_columns = (columns >= 0) & (columns < states.shape[1])
    read = states[np.ix_(rows[in_rows], columns[in_columns])]
    free_here[np.ix_(in_rows, in_columns)] = read == FREE
    outside = _count_free(states, origin, resolution, truth, truth.visible_free).outside
    free_elsewhere = outside * (resolution / truth.resolution) ** 2
    both = np.count_nonzero(free_here & truth.visible_free)
    either = np.count_nonzero(free_here | truth.visible_free) + free_elsewhere
    visible = np.count_nonzero(truth.visible_free)
    return (float(both / visible) if visible else None, float(both / either) if either else None)


def _false_free(
    states: _States, origin: tuple[float, float], resolution: float, truth: TruthMap
) -> float | None:
    """The share of free cells that are deep in a wall; outside the truth's raster is no wall."""
    deep = ndimage.binary_erosion(truth.occupied, np.ones((3, 3), np.bool_), border_value=1)
    free = _count_free(states, origin, resolution, truth, deep)
    return free.marked / free.all if free.all else None


def _count_free(
    states: _States,
    origin: tuple[float, float],
    resolution: float,
    truth: TruthMap,
    mask: NDArray[np.bool_],
) -> _FreeCells:
    """Count the map's free cells against a mask of the truth."""
    columns = _cells_at(origin[0], resolution, states.shape[1], truth.origin[0], truth.resolution)
    rows = _cells_at(origin[1], resolution, states.shape[0], truth.origin[1], truth.resolution)
    in_rows = (rows >= 0) & (rows < truth.shape[0])
    in_columns = (columns >= 0) & (columns < truth.shape[1])
    free = states == FREE
    inside = free[np.ix_(in_rows, in_columns)]
    marked = inside & mask[np.ix_(rows[in_rows], columns[in_columns])]
    count = int(np.count_nonzero(free))
    return _FreeCells(
        all=count,
        outside=count - int(np.count_nonzero(inside)),
        marked=int(np.count_nonzero(marked)),
    )


def _cells_at(
    origin: float, resolution: float, count: int, other_origin: float, other_resolution: float
) -> NDArray[np.int64]:
    """Along one axis, the other lattice's cell at the centre of each of ``count`` cells."""
    centres = origin + (np.arange(count) + 0.5) * resolution
    places = np.floor((centres - other_origin) / other_resolution + ROUNDING)
    return np.asarray(places, dtype=np.int64)


def _thickness(
    to_surface: _Distances, to_occupied: _Distances, resolution: float, truth_resolution: float
) -> float | None:
    """Occupied area over matched length, in cells of the map."""
    matched = np.count_nonzero(to_occupied <= LOOSE_MATCH)
    if matched == 0 or len(to_surface) == 0:
        return None
    return float(len(to_surface) * resolution / (matched * truth_resolution))
