"""Turns a map into landmarks: the corners that a scan would see in it.

Scans are made up from places all over the map and their corners gathered, so that what is a corner
in a scan and what is one on the map are found by the same rules.
"""

import numpy as np
from numpy.typing import NDArray

from mapping.burger import LIDAR_BEAMS, LIDAR_RANGE_MAX
from mapping.geometry import circular_mean, wrap_to_pi
from mapping.localization.known_map import KnownMap
from mapping.localization.scan_corners import CornerConfig, Corners, find_corners

LATTICE = 0.6
"""Distance between the places that the map is looked at from [m]."""

SAME_PLACE, SAME_DIRECTION = 0.12, 0.35
"""Corners this near to one another [m, rad], and of one kind, are the same."""

LEAST_SIGHTINGS = 3
"""A corner seen from fewer places is none."""

MOST_STEPS = 200
"""A beam ends at the latest after so many steps."""

Array = NDArray[np.float64]


def map_corners(known: KnownMap, config: CornerConfig | None = None) -> Corners:
    """The corners of a map, in the map frame."""
    found = [_seen_from(known, place, config) for place in _lattice(known)]
    if not found:
        return find_corners(np.zeros((0, 2)), config)
    places = np.concatenate([corners.places for corners in found])
    directions = np.concatenate([corners.directions for corners in found])
    hollow = np.concatenate([corners.hollow for corners in found])
    groups = []
    left = np.ones(len(directions), dtype=np.bool_)
    for i in range(len(directions)):
        if not left[i]:
            continue
        same = left & (hollow == hollow[i])
        same &= np.hypot(*(places - places[i]).T) <= SAME_PLACE
        same &= np.abs(wrap_to_pi(directions - directions[i])) <= SAME_DIRECTION
        left &= ~same
        if same.sum() >= LEAST_SIGHTINGS:
            groups.append(same)
    return Corners(
        places=np.array([np.median(places[g], axis=0) for g in groups]).reshape(-1, 2),
        directions=np.array([circular_mean(directions[g]) for g in groups], dtype=np.float64),
        hollow=np.array([hollow[g][0] for g in groups], dtype=np.bool_),
    )


def _lattice(known: KnownMap) -> Array:
    """Places a lattice apart where the robot fits ``(n, 2)``, cell middles."""
    step = max(1, round(LATTICE / known.resolution))
    on = known.places[np.all(known.places % step == step // 2, axis=1)]
    return np.asarray(known.origin + (on[:, ::-1] + 0.5) * known.resolution)


def _seen_from(known: KnownMap, place: Array, config: CornerConfig | None) -> Corners:
    """The corners that a scan from a place ``(2,)`` would show, in the map frame."""
    ends = _cast(known, place)
    corners = find_corners(ends - place, config)
    return Corners(
        places=corners.places + place, directions=corners.directions, hollow=corners.hollow
    )


def _cast(known: KnownMap, place: Array) -> Array:
    """Where a lidar's beams from a place end at walls ``(n, 2)``; each steps as far as is free."""
    angles = np.arange(LIDAR_BEAMS) * (2.0 * np.pi / LIDAR_BEAMS)
    rays = np.column_stack((np.cos(angles), np.sin(angles)))
    lengths = np.zeros(LIDAR_BEAMS)
    hit = np.zeros(LIDAR_BEAMS, dtype=np.bool_)
    rows, columns = known.occupied.shape
    for _ in range(MOST_STEPS):
        cells = np.floor((place + lengths[:, None] * rays - known.origin) / known.resolution)
        row, column = cells[:, 1].astype(np.int64), cells[:, 0].astype(np.int64)
        inside = (row >= 0) & (row < rows) & (column >= 0) & (column < columns)
        row, column = np.clip(row, 0, rows - 1), np.clip(column, 0, columns - 1)
        hit |= inside & known.occupied[row, column]
        going = inside & ~hit & (lengths <= LIDAR_RANGE_MAX)
        if not going.any():
            break
        free = known.distances[row, column] - known.resolution
        lengths[going] += np.maximum(free[going], 0.5 * known.resolution)
    return np.asarray((place + lengths[:, None] * rays)[hit & (lengths <= LIDAR_RANGE_MAX)])
