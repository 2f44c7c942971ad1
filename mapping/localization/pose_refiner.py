"""Turns a pose that is about right into the one where the scan fits the map best.

Scan matching against the map's walls, with the same search and the same Newton's method as the
mappers use against their keyframes (``mapping.slam.scan_matcher``).
"""

import numpy as np
from numpy.typing import NDArray

from mapping.burger import LIDAR_RANGE_MAX
from mapping.geometry import Pose
from mapping.localization.known_map import KnownMap
from mapping.localization.map_surface import map_surface
from mapping.slam.hit_field import HitField
from mapping.slam.scan_cloud import ScanCloud
from mapping.slam.scan_match_config import FINE_CELL
from mapping.slam.scan_matcher import Match, MatcherConfig, match_scan

WALL_WORTH = 10.0
"""A wall of the map counts as one that so many scans saw: few of a scan's readings are of things
that the map does not show."""

ROOM_TO_MOVE = 1.0
"""The field reaches farther than the lidar by this much [m] and is laid anew when the robot has
left its middle by half of it."""


class PoseRefiner:
    """Keeps the walls around the last pose smeared into a field."""

    def __init__(
        self,
        known: KnownMap,
        *,
        reach: float = LIDAR_RANGE_MAX,
        matcher: MatcherConfig | None = None,
    ) -> None:
        self._surface = map_surface(known, FINE_CELL)
        self._surface[:, 2] *= WALL_WORTH
        self._reach = reach + ROOM_TO_MOVE
        self._field = HitField(FINE_CELL, self._reach, outlier=1.0)
        self._matcher = matcher or MatcherConfig()
        self._is_laid = False

    def refine(self, cloud: ScanCloud, pose: Pose, covariance: NDArray[np.float64]) -> Match:
        """Match a scan near a pose ``(3,)`` that is this sure ``(3, 3)``, in the map frame."""
        away = np.max(np.abs(self._field.center - pose[:2]))
        if not self._is_laid or away > 0.5 * ROOM_TO_MOVE:
            self._lay(pose[:2])
        return match_scan(self._field, cloud, pose, covariance, self._matcher)

    def _lay(self, center: NDArray[np.float64]) -> None:
        """Smear the walls around a place ``(2,)``."""
        self._field.clear(center)
        near = np.max(np.abs(self._surface[:, :2] - center), axis=1) <= self._reach
        self._field.add(np.zeros(3), self._surface[near])
        self._is_laid = True
