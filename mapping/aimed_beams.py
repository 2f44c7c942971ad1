"""Turns a scan's beams into where each starts, points and ends in the map."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mapping.deskew_kernels import aim
from mapping.geometry import Pose
from mapping.ogm import WIDEST_WEDGE, OgmConfig
from mapping.scan_polygon import compare_neighbours
from mapping.sensor_model import Beams, range_sigma


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class AimedBeams:
    """The beams of one scan in the map frame, counter-clockwise one after another."""

    origins: NDArray[np.float64]
    """Where each starts ``(n, 2)`` [m]."""
    directions: NDArray[np.float64]
    """Their unit vectors ``(n, 2)``."""
    lengths: NDArray[np.float64]
    """How far each is known to have gone ``(n,)`` [m]."""
    sigmas: NDArray[np.float64]
    """Standard deviations of the lengths ``(n,)`` [m]."""
    hits: NDArray[np.bool_]
    """Whether each met something there ``(n,)``."""
    pairs: NDArray[np.uint8]
    """How each and the next go together ``(n,)``, of ``compare_neighbours``."""
    increment: float
    """Angle between neighbours, above 0 [rad]."""


def aim_beams(
    config: OgmConfig,
    beams: Beams,
    angles: NDArray[np.float64],
    increment: float,
    start_pose_map: Pose,
    poses: Pose,
) -> AimedBeams:
    """Aim the beams of one scan.

    Args:
        config: Where the lidar sits, and how far its readings scatter.
        beams: What its beams saw, at least one.
        angles: Their directions in the sensor frame ``(n,)`` [rad].
        increment: Angle between neighbours [rad]; below 0 the scan runs clockwise.
        start_pose_map: The frame of ``poses``, in the map ``(3,)``.
        poses: Pose of base_footprint at each beam's time ``(n, 3)``.
    """
    order = slice(None) if increment > 0.0 else slice(None, None, -1)
    lengths, hits = beams.lengths[order], np.ascontiguousarray(beams.hits[order])
    origins, directions, _ = aim(
        start_pose_map,
        np.ascontiguousarray(poses[order]),
        config.lidar_pose_base,
        angles[order],
        lengths,
    )
    sigmas = range_sigma(lengths, config.range_noise)
    return AimedBeams(
        origins=origins,
        directions=directions,
        lengths=lengths,
        sigmas=sigmas,
        hits=hits,
        pairs=compare_neighbours(directions, lengths, sigmas, hits, WIDEST_WEDGE * abs(increment)),
        increment=abs(increment),
    )
