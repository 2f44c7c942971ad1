"""Turns a scan into the points it saw, placed where its first beam was shot, and their worth."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mapping.deskew_kernels import aim
from mapping.geometry import Pose
from mapping.messages import LaserScan
from mapping.sensor_model import Beams, RangeNoise, range_sigma
from mapping.slam.surface_kernels import normals_of, surface_of

IDENTITY = np.zeros(3)

LOOSE_WORTH = 0.2
"""What a point counts that lies on no wall: on a corner or a leg, of which every place shows
another side, and to which its neighbours on unseen sides are drawn."""

ALL_AROUND = 1.5 * np.pi
"""A lidar with a wider field of view than this [rad] looks to all sides."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class ScanCloud:
    """What a scan saw, in the frame of base_footprint at the time of its first beam."""

    points: NDArray[np.float64]
    """Where beams ended at something ``(n, 2)`` [m]."""
    normals: NDArray[np.float64]
    """Directions that the walls they lie on face ``(n, 2)``; zeros where there is no wall."""
    weights: NDArray[np.float64]
    """How much each point tells ``(n,)``: 1 for a near one, less where readings are noisy."""
    surface: NDArray[np.float32]
    """The walls that the points lie on ``(m, 5)``, evenly spaced along them: x, y [m], weight, and
    the direction that they face."""
    looks_around: bool = True
    """Whether the lidar sees to all sides, so that turning shows it nothing new."""

    def __len__(self) -> int:
        return len(self.weights)


def make_cloud(
    scan: LaserScan,
    beams: Beams,
    poses_base: Pose,
    *,
    lidar_pose_base: tuple[float, float, float],
    range_noise: RangeNoise,
    resolution: float,
    reach: float,
) -> ScanCloud:
    """Place the hits of a scan.

    Args:
        scan: The scan.
        beams: The beams of it that tell something.
        poses_base: Where the robot was at each of those beams, seen from where it was at the first
            beam of the scan ``(len(beams.indices), 3)``.
        lidar_pose_base: The lidar in base_footprint.
        range_noise: How far its readings scatter.
        resolution: Spacing along walls [m]; readings with a standard deviation up to this are
            worth most.
        reach: Farther hits are left out [m].
    """
    kept = beams.hits & (beams.lengths <= reach)
    lengths, indices = beams.lengths[kept], beams.indices[kept]
    _, _, ends = aim(IDENTITY, poses_base[kept], lidar_pose_base, scan.angles[indices], lengths)
    weights = np.minimum(1.0, (resolution / range_sigma(lengths, range_noise)) ** 2)
    increment = abs(scan.angle_increment)
    normals = normals_of(ends, lengths, indices, increment)
    loose = weights * np.where((normals != 0.0).any(axis=1), 1.0, LOOSE_WORTH)
    return ScanCloud(
        points=ends,
        normals=normals,
        weights=loose,
        surface=surface_of(ends, lengths, indices, weights, normals, increment, resolution),
        looks_around=increment * len(scan.ranges) > ALL_AROUND,
    )
