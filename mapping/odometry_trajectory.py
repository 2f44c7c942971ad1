"""Turns odometry messages into a trajectory: a pose for each message, or for each scan."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from mapping.deskew import REACH_S
from mapping.deskew_kernels import interpolate
from mapping.messages import LaserScan, Odometry
from mapping.trajectory import Trajectory


def odometry_trajectory(odometry: Sequence[Odometry]) -> Trajectory:
    """The poses of the messages; one not usable, or no later than one before, is left out."""
    rows = _rows(odometry)
    return Trajectory(stamps=rows[:, 0].copy(), poses=rows[:, 1:4].copy())


def odometry_at_scans(scans: Sequence[LaserScan], odometry: Sequence[Odometry]) -> Trajectory:
    """The pose that odometry tells for the first beam of each scan, as deskewing tells it.

    A scan is left out when its stamp is not finite, no later than one before, or REACH_S or more
    outside of the odometry's time.
    """
    rows = _rows(odometry)
    stamps = np.array([scan.stamp for scan in scans], dtype=np.float64)
    stamps = stamps[_ascending(stamps)]
    if len(rows) == 0:
        return Trajectory(stamps=np.empty(0), poses=np.empty((0, 3)))
    stamps = stamps[(stamps >= rows[0, 0] - REACH_S) & (stamps <= rows[-1, 0] + REACH_S)]
    return Trajectory(stamps=stamps, poses=interpolate(rows, stamps))


def _rows(odometry: Sequence[Odometry]) -> NDArray[np.float64]:
    """Stamp, pose, speed and turn rate of each message that counts ``(n, 6)``."""
    usable = [each.row for each in odometry if each.is_usable]
    rows = np.array(usable, dtype=np.float64).reshape(-1, 6)
    return rows[_ascending(rows[:, 0])]


def _ascending(stamps: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Which stamps ``(n,)`` are finite and later than every one before."""
    known = np.where(np.isfinite(stamps), stamps, -np.inf)
    newest = np.maximum.accumulate(np.concatenate(([-np.inf], known)))[:-1]
    return np.asarray(known > newest)
