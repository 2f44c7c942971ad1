"""Measures holes in a map's walls, what filling them closes, and the trash can in the corner."""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage
from scipy.spatial import KDTree

from envs.floor_plan import Cylinder
from evaluation.thesis.drift import TRUTH_CELL
from evaluation.thesis.drive import Drive
from evaluation.thesis.map_run import MapRun, truth_at
from evaluation.thesis.walls import Sightings, are_drawn, places_in_map, see_walls
from mapping.gap_filling import GapFilling, fill_gaps
from mapping.geometry import Pose, compose, inverse, transform_points
from mapping.grid import OCCUPIED
from mapping.trajectory import poses_at

HALF_WIDTH = 0.089
"""Half the Burger's width [m] (0.178 m, ROBOTIS e-manual)."""

CAN_BLUR = 0.05
"""A cell this near to the can's edge, or to the wall, belongs to it [m]: the spread of readings."""

CORNER = 0.7
"""Side of the square in the bottom left corner that holds the can and its walls [m]."""

LOOKED_FOR = 1.0
"""Step in which times are tried at which the can was drawn [s]."""

EIGHT = np.ones((3, 3), dtype=np.bool_)
"""Cells that share a corner are connected."""

Mask = NDArray[np.bool_]


@dataclass(frozen=True, slots=True, kw_only=True)
class Filling:
    """What a rule of gap filling did to a map."""

    filled: Mask
    """Cells that it made occupied, of the map's shape."""
    holes: float
    """Share of the wall seen from near that is not drawn even so."""
    pieces: float
    """Groups of occupied cells per metre of wall that are left."""
    on_the_way: int
    """How many of the filled cells lie where the robot drove."""


def hole_share(drive: Drive, run: MapRun, filled: Mask | None = None) -> float:
    """Share of the wall that the lidar hit from within 1.5 m and that the map does not show.

    Args:
        drive: The drive.
        run: A map of it.
        filled: Cells that count as occupied besides, of the map's shape.

    Returns:
        1 when no wall was seen.
    """
    sightings = walls_seen(drive, run)
    if len(sightings) == 0:
        return 1.0
    if filled is None:
        return _holes_left(drive, run)
    return 1.0 - float(np.mean(_drawn(drive, run, sightings, filled)))


@lru_cache(maxsize=8)
def fill(drive: Drive, run: MapRun, rule: GapFilling) -> Filling:
    """Fill a map's gaps by a rule, and see what is left and what was closed."""
    filled = fill_gaps(run.map.states, run.map.resolution, rule)
    cells, way = run.centres(filled), run.trajectory.poses[:, :2]
    gaps = KDTree(way).query(cells)[0] if len(cells) else np.empty(0)
    return Filling(
        filled=filled,
        holes=hole_share(drive, run, filled),
        pieces=pieces_per_metre(drive, run, filled),
        on_the_way=int(np.count_nonzero(gaps < HALF_WIDTH)),
    )


def walls_seen(drive: Drive, run: MapRun) -> Sightings:
    """The pieces of wall that the part of the drive that was mapped saw from near."""
    return _walls_seen_until(drive, getattr(drive, run.spec.until))


def trash_can(drive: Drive) -> Cylinder:
    """The round thing nearest to the bottom left corner of a room, which lies at the origin."""
    return min(drive.plan.cylinders, key=lambda each: float(np.hypot(*each.center)))


def pieces_per_metre(drive: Drive, run: MapRun, filled: Mask | None = None) -> float:
    """Groups of occupied cells that do not touch one another, per metre of wall seen from near.

    Cells touch at edges and corners. Where no wall was seen there are 0.
    """
    cells = run.map.states == OCCUPIED
    _, count = ndimage.label(cells if filled is None else cells | filled, EIGHT)
    length = len(walls_seen(drive, run)) * TRUTH_CELL
    return count / length if length > 0.0 else 0.0


def can_share(drive: Drive, run: MapRun) -> float:
    """Share of the can's side seen from near that the map shows; 0 when none was seen."""
    return max((share for share, _ in _can_shares(drive, run)), default=0.0)


def can_joins_wall(drive: Drive, run: MapRun, filled: Mask | None = None) -> bool:
    """Whether connected occupied cells lead from the trash can to a wall of its corner."""
    shares = _can_shares(drive, run)
    if not shares:
        return False
    stamp = max(shares)[1]
    cells = run.map.states == OCCUPIED
    labels, _ = ndimage.label(cells if filled is None else cells | filled, EIGHT)
    label, can = labels[labels > 0], trash_can(drive)
    there = transform_points(_to_true(drive, run, stamp), run.centres(labels > 0))
    in_corner = np.all(np.abs(there) < CORNER, axis=1)
    at_wall = in_corner & np.any(there <= CAN_BLUR, axis=1)
    at_can = in_corner & ~at_wall & _on_can(there, can)
    return bool(np.isin(label[at_can], label[at_wall]).any())


def _can_shares(drive: Drive, run: MapRun) -> list[tuple[float, float]]:
    """How much of the can's side the map shows where it was at some time, and that time [s].

    Which of its drawings outlived the others is not known: every LOOKED_FOR seconds is tried.
    """
    can, sightings = trash_can(drive), walls_seen(drive, run)
    side = sightings.places[_on_can(sightings.places, can)]
    occupied, stamps = run.occupied, run.trajectory.stamps
    if len(side) == 0 or len(occupied) == 0:
        return []
    tree = KDTree(occupied)
    shares = []
    for stamp in np.arange(stamps[0], stamps[-1], LOOKED_FOR).tolist():
        to_map = inverse(_to_true(drive, run, stamp))
        gaps, _ = tree.query(transform_points(to_map, side))
        shares.append((float(np.mean(gaps <= CAN_BLUR)), stamp))
    return shares


def _to_true(drive: Drive, run: MapRun, stamp: float) -> Pose:
    """What takes the map back to the world with the error of the mapper's pose at a time."""
    true, believed = (poses_at(each, [stamp])[0] for each in (drive.ground_truth, run.trajectory))
    return compose(true, inverse(believed))


@lru_cache(maxsize=32)
def _holes_left(drive: Drive, run: MapRun) -> float:
    """The share of a map as it is; kept, since several figures tell it."""
    return 1.0 - float(np.mean(_drawn(drive, run, walls_seen(drive, run), None)))


@lru_cache(maxsize=8)
def _walls_seen_until(drive: Drive, until: float) -> Sightings:
    """The pieces of wall seen up to a time [s]; kept, since every figure asks for them."""
    log = drive.log_between(0.0, until)
    return see_walls(log, drive.ground_truth, truth_at(drive.plan, TRUTH_CELL))


def _drawn(drive: Drive, run: MapRun, sightings: Sightings, filled: Mask | None) -> Mask:
    """Which pieces of wall a map shows ``(n,)``."""
    cells = run.map.states == OCCUPIED
    occupied = run.centres(cells if filled is None else cells | filled)
    drawn = np.zeros(len(sightings), dtype=np.bool_)
    for stamps in (sightings.stamps, sightings.last):
        in_map = places_in_map(sightings, drive.ground_truth, run.trajectory, stamps)
        drawn |= are_drawn(sightings, in_map, occupied, run.map.resolution)
    return drawn


def _on_can(points: NDArray[np.float64], can: Cylinder) -> Mask:
    """Whether points ``(n, 2)`` [m] lie on the can's side, give or take the blur."""
    gaps = np.hypot(*(points - np.asarray(can.center)).T) - can.radius
    return np.asarray(np.abs(gaps) <= CAN_BLUR)
