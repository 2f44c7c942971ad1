"""Finds the poses that agree best with all matches, by GTSAM: step by step, or a whole file's.

While mapping, iSAM2 takes what is new and weighs loop edges robustly. A pose graph from a file is
optimised by Levenberg-Marquardt and all its edges alike: files do not say which to doubt.

An edge's error is the logarithm of the pose by which its measurement is missed (g2o takes that
pose's x, y and yaw as they are, which is the same for small errors); chi2 is the sum of the squared
errors, each weighed with the edge's information.

GTSAM is imported when it is first needed: it takes 40 MB, which mappers without a graph save.
"""

import re
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_matrix
from scipy.sparse.csgraph import connected_components

from mapping.errors import TestbedError
from mapping.geometry import Pose
from mapping.pose_graph import PoseGraph
from mapping.slam.keyframe_graph import Edge

if TYPE_CHECKING:
    import gtsam

START_SIGMA = 1e-4
"""The first keyframe stays where it is, to this [m, rad]."""

HUBER_WIDTH = 2.0
"""A loop edge pulls no harder than one this many standard deviations off (Huber's loss): a wrong
one cannot bend the map much. Losses that let go of far edges, such as Cauchy's, never close a loop
that is metres open: it is as far off as a wrong one."""

RELINEARIZE_ABOVE = 0.01
"""iSAM2 linearises a pose anew when it has moved by more than this [m, rad]."""

CONVERGED = 1e-10
"""Steps that lower chi2 by a smaller share than this end the search of Levenberg-Marquardt."""


class PoseGraphOptimizer:
    """Keeps the factor graph between optimisations and adds only what is new."""

    def __init__(self) -> None:
        import gtsam

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
        import gtsam

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


def factor_of(edge: Edge) -> "gtsam.BetweenFactorPose2":
    """The factor that an edge makes."""
    import gtsam

    noise: gtsam.noiseModel.Base = gtsam.noiseModel.Gaussian.Covariance(edge.covariance)
    if edge.is_loop:
        huber = gtsam.noiseModel.mEstimator.Huber.Create(HUBER_WIDTH)
        noise = gtsam.noiseModel.Robust.Create(huber, noise)
    return gtsam.BetweenFactorPose2(edge.a, edge.b, gtsam.Pose2(*edge.pose), noise)


def optimize_pose_graph(graph: PoseGraph) -> tuple[PoseGraph, float]:
    """The graph with its poses where they agree best, and its chi2 there.

    The search starts from the graph's poses. Its fixed vertices stay where they are, or the first
    one when none is fixed.

    Raises:
        TestbedError: There is no vertex, an edge lies between a vertex and itself, or the edges
            leave a pose open.
    """
    import gtsam

    values = _values(graph)
    factors = _factors(graph)
    hold = gtsam.noiseModel.Constrained.All(3)
    for row in _held(graph).tolist():
        factors.add(gtsam.PriorFactorPose2(row, values.atPose2(row), hold))
    parameters = gtsam.LevenbergMarquardtParams()
    parameters.setRelativeErrorTol(CONVERGED)
    try:
        factors.linearize(values).optimize()  # undamped: fails where the edges leave a pose open
        found = gtsam.LevenbergMarquardtOptimizer(factors, values, parameters).optimize()
    except RuntimeError as error:
        near = re.search(r"variable\s+(\d+)", str(error))
        vertex = f" near vertex {graph.ids[int(near[1])]}" if near else ""
        raise TestbedError(
            f"pose graph: a pose{vertex} is left open; x, y and yaw of every vertex must be tied "
            "by the information of its edges"
        ) from None
    optimized = replace(graph, poses=np.asarray(gtsam.utilities.extractPose2(found)))
    return optimized, chi2_of(optimized)


def chi2_of(graph: PoseGraph) -> float:
    """How badly the poses of a graph miss its measurements; 0 when they agree with all."""
    return float(2.0 * _factors(graph).error(_values(graph)))


def _held(graph: PoseGraph) -> NDArray[np.int64]:
    """Rows of the vertices to hold; makes sure that edges lead from every other one to them."""
    if len(graph.ids) == 0:
        raise TestbedError("pose graph: there is no vertex; must have at least one")
    held = np.flatnonzero(np.isin(graph.ids, graph.fixed or graph.ids[:1]))
    rows, count = _rows(graph), len(graph.ids)
    ties = csr_matrix((np.ones(len(rows)), (rows[:, 0], rows[:, 1])), shape=(count, count))
    _, parts = connected_components(ties, directed=False)
    loose = np.flatnonzero(~np.isin(parts, parts[held]))
    if loose.size:
        raise TestbedError(
            f"pose graph: no edges lead from vertex {graph.ids[loose[0]]} to vertex "
            f"{graph.ids[held[0]]}, which is held; every vertex must hang together with a held one"
        )
    return held


def _rows(graph: PoseGraph) -> NDArray[np.int64]:
    """The rows of the edges' vertices ``(m, 2)``: GTSAM's keys, which ids may not fit."""
    if np.any(graph.edges[:, 0] == graph.edges[:, 1]):
        vertex = graph.edges[graph.edges[:, 0] == graph.edges[:, 1]][0, 0]
        raise TestbedError(f"pose graph: edge {vertex} {vertex}; must join two vertices")
    order = np.argsort(graph.ids)
    return order[np.searchsorted(graph.ids, graph.edges, sorter=order)]


def _factors(graph: PoseGraph) -> "gtsam.NonlinearFactorGraph":
    """A factor for each edge."""
    import gtsam

    eigenvalues, axes = np.linalg.eigh(graph.information)
    scales = np.sqrt(np.maximum(eigenvalues, 0.0))
    roots = scales[:, :, None] * axes.transpose(0, 2, 1)  # also where there is no inverse
    factors = gtsam.NonlinearFactorGraph()
    for (first, second), pose, root in zip(
        _rows(graph).tolist(), graph.relative_poses, roots, strict=True
    ):
        noise = gtsam.noiseModel.Gaussian.SqrtInformation(root)
        factors.add(gtsam.BetweenFactorPose2(first, second, gtsam.Pose2(*pose), noise))
    return factors


def _values(graph: PoseGraph) -> "gtsam.Values":
    """The poses by their rows."""
    import gtsam

    values = gtsam.Values()
    for row, pose in enumerate(graph.poses):
        values.insert(row, gtsam.Pose2(*pose))
    return values
