"""Turns a scan into beams in the robot's frame, cut as GMapping cuts them."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mapping.deskew_kernels import aim
from mapping.geometry import Pose, inverse
from mapping.messages import LaserScan
from mapping.sensor_model import Beams
from mapping.slam.gmapping_config import GmappingConfig

FREE_CELL_RATIO = 2.0**0.5
"""The cell before a hit lies this many cells back along the beam (GMapping's freeCellRatio): in
every direction that is another cell."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class BaseBeams:
    """The beams of a scan in base_footprint as it was at the scan's first beam."""

    origins: NDArray[np.float64]
    """Where each starts ``(n, 2)`` [m]."""
    ends: NDArray[np.float64]
    """Where each ends, or is cut ``(n, 2)`` [m]."""
    is_hit: NDArray[np.bool_]
    """Whether it met something there ``(n,)``."""
    directions: NDArray[np.float64]
    """Unit vectors ``(n, 2)``."""

    def points(self, delta: float, skip: int) -> NDArray[np.float64]:
        """What is matched: ends of hits, and from there to the cell before ``(m, 4)`` [cells].

        Args:
            delta: Edge of a cell [m].
            skip: Hits left out after each one taken.
        """
        hits = np.flatnonzero(self.is_hit)[:: skip + 1]
        return np.hstack((self.ends[hits] / delta, -FREE_CELL_RATIO * self.directions[hits]))


def beams_in_base(
    scan: LaserScan, beams: Beams, poses_odom: Pose, pose_odom: Pose, config: GmappingConfig
) -> BaseBeams:
    """Place every beam where the robot was at its own time, seen from the first beam's.

    Readings beyond ``maxUrange`` are cut there, beams without a return at ``clear_range``.

    Args:
        scan: The scan.
        beams: Those of its beams that tell something.
        poses_odom: The robot's pose at each of them ``(n, 3)``.
        pose_odom: The robot's pose at the scan's first beam ``(3,)``.
        config: The mapper's settings.
    """
    usable = config.max_range if config.maxUrange is None else config.maxUrange
    cut = np.where(beams.hits, usable, min(usable, config.clear_range))
    origins, directions, ends = aim(
        inverse(pose_odom),
        poses_odom,
        config.lidar_pose_base,
        scan.angles[beams.indices],
        np.minimum(beams.lengths, cut),
    )
    is_hit = beams.hits & (beams.lengths <= usable)
    return BaseBeams(origins=origins, ends=ends, is_hit=is_hit, directions=directions)
