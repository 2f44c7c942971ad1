"""Finds the true wall that a drive's lidar hit, and what a map shows where it should stand.

A map drawn with a pose that is off shows a wall elsewhere, yet it may show it whole. So that holes
and drift can be told apart, each piece of wall is looked for where the mapper must draw it: at its
true place, moved by the error of the mapper's pose when it was seen. That is tried at the scan that
saw it from nearest, and at the last, whose drawing may have replaced all others.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import KDTree

from mapping.geometry import Pose, between, compose, inverse, wrap_to_pi
from mapping.messages import LaserScan
from mapping.sensor_log import SensorLog
from mapping.trajectory import Trajectory, poses_at
from mapping.truth import TruthMap

NEAR = 1.5
"""Only walls hit from this near count [m]: the LDS-01's readings there scatter by 5 cm (3.5 %,
ROBOTIS e-manual), farther out a wall is a cloud in which holes cannot be told."""

BELONGS = 0.10
"""A reading that ends within this of a true wall came from there [m]: two of those deviations."""

ACROSS = 0.10
"""A wall counts as drawn by an occupied cell within this of it, across it [m]."""

ALONG = 0.01
"""Along it, beyond half the edge of the occupied cell, only this is allowed [m]: one cell of the
thesis's map, so that a gap of one cell between neighbours is no hole, and a gap of two is."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Sightings:
    """Pieces of true wall, a centimetre each, that the lidar hit from near."""

    places: NDArray[np.float64]
    """Where they are ``(n, 2)`` in the world frame [m]."""
    stamps: NDArray[np.float64]
    """When each was hit from nearest ``(n,)`` [s]."""
    last: NDArray[np.float64]
    """When each was hit last, from however far ``(n,)`` [s]."""
    along_y: NDArray[np.bool_]
    """Whether the wall there runs along y ``(n,)``, else along x; corners count as along y."""
    cells: NDArray[np.int64]
    """Which cell of the truth it is ``(n,)``, the same for every drive through one world."""

    def __len__(self) -> int:
        return len(self.stamps)


def see_walls(log: SensorLog, ground_truth: Trajectory, truth: TruthMap) -> Sightings:
    """The pieces of wall that a log's readings came from.

    Args:
        log: The scans, at least none.
        ground_truth: Where the robot really was.
        truth: The world, in cells of a centimetre.
    """
    rows, columns = np.nonzero(truth.visible_surface)
    places = np.column_stack((columns, rows)) + 0.5
    places = places * truth.resolution + np.asarray(truth.origin)
    nearest = np.full(len(places), np.inf)
    stamps, last = np.zeros(len(places)), np.zeros(len(places))
    tree = KDTree(places)
    for scan in log.scans:
        ends, ranges = _ends(scan, log.lidar_pose_base, ground_truth)
        gaps, indices = tree.query(ends, distance_upper_bound=BELONGS)
        belongs = np.isfinite(gaps)
        hit, ranges = np.asarray(indices)[belongs], ranges[belongs]
        far_first = np.argsort(-ranges, kind="stable")  # the last to be written is the nearest
        hit, ranges = hit[far_first], ranges[far_first]
        nearer = ranges < nearest[hit]
        nearest[hit[nearer]] = ranges[nearer]
        stamps[hit[nearer]] = scan.stamp
        last[hit] = scan.stamp
    seen = nearest <= NEAR
    return Sightings(
        places=places[seen],
        stamps=stamps[seen],
        last=last[seen],
        along_y=_runs_along_y(truth, rows, columns)[seen],
        cells=np.ravel_multi_index((rows, columns), truth.shape)[seen].astype(np.int64),
    )


def places_in_map(
    sightings: Sightings,
    ground_truth: Trajectory,
    believed: Trajectory,
    stamps: NDArray[np.float64],
) -> Pose:
    """Where a mapper draws each piece ``(n, 3)`` at a time of its own ``(n,)`` [s].

    Columns are x, y [m], and by how much the wall is turned there [rad].
    """
    true = poses_at(ground_truth, stamps)
    error = compose(poses_at(believed, stamps), inverse(true))
    upright = np.column_stack((sightings.places, np.zeros(len(sightings))))
    return compose(error, upright)


def are_drawn(
    sightings: Sightings, in_map: Pose, occupied: NDArray[np.float64], resolution: float
) -> NDArray[np.bool_]:
    """Whether a map has an occupied cell where each piece must be ``(n,)``.

    Args:
        sightings: The pieces.
        in_map: Their places, of ``places_in_map``.
        occupied: Centres of the map's occupied cells ``(m, 2)`` [m].
        resolution: Edge of these cells [m].
    """
    if len(sightings) == 0 or len(occupied) == 0:
        return np.zeros(len(sightings), dtype=np.bool_)
    along = ALONG + 0.5 * resolution
    across = max(ACROSS, along)
    near = KDTree(occupied).query_ball_point(in_map[:, :2], float(np.hypot(along, across)))
    drawn = np.zeros(len(sightings), dtype=np.bool_)
    for i, indices in enumerate(near):
        x, y, yaw = in_map[i]
        gap = occupied[indices] - (x, y)
        cos, sin = np.cos(yaw), np.sin(yaw)
        dx, dy = gap @ (cos, sin), gap @ (-sin, cos)
        ahead, aside = (dy, dx) if sightings.along_y[i] else (dx, dy)
        drawn[i] = bool(np.any((np.abs(ahead) <= along) & (np.abs(aside) <= across)))
    return drawn


def pose_error(ground_truth: Trajectory, believed: Trajectory, stamp: float) -> Pose:
    """The error ``(3,)`` of a mapper's pose at a time, seen from the true pose: x, y [m], yaw."""
    at = [stamp]
    error: Pose = between(poses_at(ground_truth, at)[0], poses_at(believed, at)[0])
    error[2] = wrap_to_pi(error[2])
    return error


def _ends(
    scan: LaserScan, lidar_pose_base: tuple[float, float, float], ground_truth: Trajectory
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Where the beams of a scan really ended ``(n, 2)`` [m], and their ranges ``(n,)``."""
    ranges = scan.ranges.astype(np.float64)
    hits = np.isfinite(ranges) & (ranges >= scan.range_min) & (ranges <= scan.range_max)
    sensor = compose(poses_at(ground_truth, scan.beam_stamps[hits]), lidar_pose_base)
    angles = sensor[:, 2] + scan.angles[hits]
    rays = np.column_stack((np.cos(angles), np.sin(angles)))
    return sensor[:, :2] + ranges[hits, None] * rays, ranges[hits]


def _runs_along_y(
    truth: TruthMap, rows: NDArray[np.int64], columns: NDArray[np.int64]
) -> NDArray[np.bool_]:
    """Whether wall cells have free floor to their left or right."""
    free = np.pad(truth.visible_free, 1)
    return np.asarray(free[rows + 1, columns] | free[rows + 1, columns + 2])
