"""Follows the likeliest hypothesis from scan to scan, matching each scan with the map.

Particles and cells tell which place it is; matching tells exactly where in that place. As long as
the hypothesis stays the one it was, the pose goes on from the last match.
"""

import math

import numpy as np
from numpy.typing import NDArray

from mapping.geometry import Pose, between, compose
from mapping.localization.localizer import LOST_BELOW, Hypothesis
from mapping.localization.pose_refiner import PoseRefiner
from mapping.localization.scan_reader import Reading
from mapping.pose_covariance import carried

NEAR, NEAR_YAW = 0.3, math.radians(15.0)
"""Farther than this from the hypothesis [m, rad] the tracked pose is of another one."""


class HypothesisTracker:
    """The tracked pose and its covariance, while there is a likeliest hypothesis."""

    def __init__(self, refiner: PoseRefiner) -> None:
        self.pose: Pose | None = None
        self.covariance: NDArray[np.float64] = np.zeros((3, 3))
        self.score = 0.0
        """Share of the newest scan that the map explains at the pose, 0..1."""
        self._refiner = refiner

    def follow(self, reading: Reading, best: Hypothesis | None) -> None:
        """Take a reading and the likeliest hypothesis after it, if there is any."""
        if best is None or best.weight < LOST_BELOW:
            self.pose = None
            return
        pose, covariance = best.pose, best.covariance
        if self.pose is not None:
            moved = compose(self.pose, reading.motion)
            x, y, yaw = between(best.pose, moved)
            if math.hypot(x, y) <= NEAR and abs(yaw) <= NEAR_YAW:
                covariance = carried(self.covariance, self.pose, moved, reading.spread)
                pose = moved
        match = self._refiner.refine(reading.cloud, pose, covariance)
        self.pose, self.covariance, self.score = match.pose, match.covariance, match.score
