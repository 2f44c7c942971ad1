"""Measures what a pose that drifts does to a map: it bends, and walls stand in it twice."""

from functools import lru_cache

import numpy as np
from scipy.spatial import KDTree

from evaluation.thesis.drive import Drive
from evaluation.thesis.map_run import MapRun, truth_at
from evaluation.thesis.walls import ACROSS, are_drawn, places_in_map, pose_error, see_walls
from mapping.geometry import between, circular_mean, wrap_to_pi
from mapping.trajectory import poses_at

STRETCH = 5.0
"""A path's direction is that of so much of it [m]."""

TWICE = 0.20
"""Two places of one wall farther apart than this are two walls [m]: the robot, 0.178 m wide, would
fit between, and no noise of readings from near (5 cm) does it."""

TRUTH_CELL = 0.01
"""Edge of a cell of the truth [m]."""


def bend_deg(drive: Drive, run: MapRun) -> float:
    """How far the end of a map is turned against its beginning, as an angle of 0 or more [deg].

    That is the mean error of the heading over the last 5 m of the true path, less that over the
    first 5 m; of a path shorter than 10 m over its halves.
    """
    stamps = run.trajectory.stamps[run.trajectory.stamps <= drive.ground_truth.stamps[-1]]
    if len(stamps) < 2:
        return 0.0
    true, believed = poses_at(drive.ground_truth, stamps), poses_at(run.trajectory, stamps)
    errors = wrap_to_pi(believed[:, 2] - true[:, 2])
    gone = np.concatenate(([0.0], np.cumsum(np.hypot(*np.diff(true[:, :2], axis=0).T))))
    stretch = min(STRETCH, 0.5 * float(gone[-1]))
    first, last = errors[gone <= stretch], errors[gone >= gone[-1] - stretch]
    turned = wrap_to_pi(circular_mean(last) - circular_mean(first))
    return float(abs(np.degrees(turned)))


def end_error_m(drive: Drive, run: MapRun) -> float:
    """How far the mapper's pose is off at the end of what it mapped [m]."""
    stamp = min(float(run.trajectory.stamps[-1]), drive.end)
    return float(np.hypot(*pose_error(drive.ground_truth, run.trajectory, stamp)[:2]))


@lru_cache(maxsize=32)
def doubled_share(drive: Drive, run: MapRun) -> float:
    """Share of the wall seen on the way out and on the way back that the map shows twice.

    A piece of wall is shown twice when the map has it where it was drawn on the way out, and where
    it was drawn on the way back, and the two places are more than 0.2 m apart, across the wall: a
    wall that is only moved along itself is still one.
    """
    truth = truth_at(drive.plan, TRUTH_CELL)
    legs = ((0.0, drive.farthest), (drive.turned, drive.end))
    out, back = (see_walls(drive.log_between(*leg), drive.ground_truth, truth) for leg in legs)
    _, in_out, in_back = np.intersect1d(out.cells, back.cells, return_indices=True)
    if len(in_out) == 0:
        return 0.0
    shown, places = [], []
    for leg, chosen in ((out, in_out), (back, in_back)):
        in_map = places_in_map(leg, drive.ground_truth, run.trajectory, leg.stamps)
        shown.append(are_drawn(leg, in_map, run.occupied, run.map.resolution)[chosen])
        places.append(in_map[chosen])
    from_out_to_back = between(places[0], places[1])
    across = np.where(out.along_y[in_out], from_out_to_back[:, 0], from_out_to_back[:, 1])
    return float(np.mean(shown[0] & shown[1] & (np.abs(across) > TWICE)))


@lru_cache(maxsize=32)
def false_wall_share(drive: Drive, run: MapRun) -> float:
    """Share of the map's occupied cells that are farther than 10 cm from any true wall."""
    occupied = run.occupied
    if len(occupied) == 0:
        return 0.0
    truth = truth_at(drive.plan, TRUTH_CELL)
    solid = (np.argwhere(truth.occupied)[:, ::-1] + 0.5) * truth.resolution
    gaps, _ = KDTree(solid + np.asarray(truth.origin)).query(occupied)
    return float(np.mean(gaps > ACROSS))
