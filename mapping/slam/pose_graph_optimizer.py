"""Finds the poses that agree best with all matches: GTSAM's iSAM2, loop edges weighed robustly."""

import gtsam
import numpy as np

from mapping.geometry import Pose
from mapping.slam.keyframe_graph import Edge

START_SIGMA = 1e-4
"""The first keyframe stays where it is, to this [m, rad]."""

HUBER_WIDTH = 2.0
"""A loop edge pulls no harder than one this many standard deviations off (Huber's loss): a wrong one
cannot bend the map much. Losses that let go of far edges, such as Cauchy's, never close a loop that
is metres open: it is as far off as a wrong one."""

RELINEARIZE_ABOVE = 0.01
"""iSAM2 linearises a pose anew when it has moved by more than this [m, rad]."""


class PoseGraphOptimizer:
    """Keeps the factor graph between optimisations and adds only what is new."""

    def __init__(self) -> None:
        parameters = gtsam.ISAM2Params()
        parameters.setRelinearizeThreshold(RELINEARIZE_ABOVE)
        parameters.relinearizeSkip = 1
        self._isam = gtsam.ISAM2(parameters)
        self._keyframes = 0
        self._edges = 0

    def optimize(self, poses: Pose, edges: list[Edge], rounds: int = 1) -> Pose:
        """The best poses ``(n, 3)``.

        Args:
            poses: Where the keyframes are thought to be ``(n, 3)``; only those that are new since
                the last call are looked at.
            edges: All edges; only the new ones are looked at.
            rounds: How many steps to take; one is enough unless much has changed.
        """
        factors, values = gtsam.NonlinearFactorGraph(), gtsam.Values()
        for key in range(self._keyframes, len(poses)):
            values.insert(key, gtsam.Pose2(*poses[key]))
        if self._keyframes == 0:
            noise = gtsam.noiseModel.Isotropic.Sigma(3, START_SIGMA)
            factors.add(gtsam.PriorFactorPose2(0, gtsam.Pose2(*poses[0]), noise))
        for edge in edges[self._edges :]:
            factors.add(factor_of(edge))
        self._keyframes, self._edges = len(poses), len(edges)
        self._isam.update(factors, values)
        for _ in range(rounds - 1):
            self._isam.update()
        return np.asarray(gtsam.utilities.extractPose2(self._isam.calculateEstimate()))


def factor_of(edge: Edge) -> gtsam.BetweenFactorPose2:
    """The factor that an edge makes."""
    noise: gtsam.noiseModel.Base = gtsam.noiseModel.Gaussian.Covariance(edge.covariance)
    if edge.is_loop:
        huber = gtsam.noiseModel.mEstimator.Huber.Create(HUBER_WIDTH)
        noise = gtsam.noiseModel.Robust.Create(huber, noise)
    return gtsam.BetweenFactorPose2(edge.a, edge.b, gtsam.Pose2(*edge.pose), noise)
