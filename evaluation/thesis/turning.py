"""Measures what a map shows wrongly around the place where the robot turned round."""

import numpy as np
from scipy import ndimage

from evaluation.thesis.drift import TRUTH_CELL
from evaluation.thesis.drive import Drive
from evaluation.thesis.map_run import MapRun, truth_at
from evaluation.thesis.walls import pose_error
from mapping.burger import LIDAR_RANGE_MAX
from mapping.geometry import compose, inverse, transform_points
from mapping.grid import FREE, OCCUPIED
from mapping.trajectory import poses_at

MARGIN = 0.10
"""What is nearer than this to where it may be is not called wrong [m]: readings scatter."""


def wrong_area_m2(drive: Drive, run: MapRun) -> float:
    """Area drawn wrongly around the turn [m2], with the drift up to there taken off.

    Occupied cells are wrong more than 10 cm from every true wall, free cells more than 10 cm inside
    walls or beyond what can be seen. Counted is what lies within the lidar's range of the place.
    """
    truth = truth_at(drive.plan, TRUTH_CELL)
    stamp = [drive.farthest]
    true, believed = (poses_at(each, stamp)[0] for each in (drive.ground_truth, run.trajectory))
    to_true = compose(true, inverse(believed))
    far_from_wall = ndimage.distance_transform_edt(~truth.occupied) * truth.resolution > MARGIN
    far_from_free = ndimage.distance_transform_edt(~truth.visible_free) * truth.resolution > MARGIN
    count = 0
    for state, is_wrong in ((OCCUPIED, far_from_wall), (FREE, far_from_free)):
        points = transform_points(to_true, run.centres(run.map.states == state))
        points = points[np.hypot(*(points - true[:2]).T) < LIDAR_RANGE_MAX]
        cells = np.floor((points - np.asarray(truth.origin)) / truth.resolution).astype(np.int64)
        inside = np.all((cells >= 0) & (cells < truth.shape[::-1]), axis=1)
        count += int(np.count_nonzero(~inside))
        count += int(np.count_nonzero(is_wrong[cells[inside, 1], cells[inside, 0]]))
    return float(count * run.map.resolution**2)


def heading_error_deg(drive: Drive, run: MapRun) -> float:
    """What the turn added to the error of the heading [deg], with its sign."""
    errors = [
        pose_error(drive.ground_truth, run.trajectory, stamp)[2]
        for stamp in (drive.farthest, min(drive.turned, float(run.trajectory.stamps[-1])))
    ]
    return float(np.degrees(errors[1] - errors[0]))
