"""Whole pose graphs optimised; SciPy's least squares and a known answer are the oracles."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray
from scipy.linalg import expm
from scipy.optimize import least_squares

from mapping.errors import TestbedError
from mapping.geometry import Pose, between, compose
from mapping.pose_graph import PoseGraph
from mapping.slam.pose_graph_optimizer import chi2_of, optimize_pose_graph

EDGES = np.array([[0, 1], [1, 2], [2, 3], [3, 4], [4, 0], [1, 4], [3, 0]])


def loop(seed: int, noise: float) -> PoseGraph:
    """Five vertices measured with noise, with information of every direction, and a rough guess."""
    rng = np.random.default_rng(seed)
    poses = np.column_stack((rng.uniform(-3.0, 3.0, (5, 2)), rng.uniform(-3.0, 3.0, 5)))
    ids = np.array([-7, 900, 3, 10**12, 40])
    roots = rng.normal(size=(len(EDGES), 3, 3)) + 3.0 * np.eye(3)
    information = roots @ roots.transpose(0, 2, 1)
    true = between(poses[EDGES[:, 0]], poses[EDGES[:, 1]])
    guess = compose(poses, rng.normal(scale=0.05, size=(5, 3)))
    guess[0] = poses[0]
    return PoseGraph(
        ids=ids,
        poses=guess,
        edges=ids[EDGES],
        relative_poses=compose(true, rng.normal(scale=noise, size=true.shape)),
        information=(information + information.transpose(0, 2, 1)) / 2.0,
    )


def log_of(pose: Pose) -> NDArray[np.float64]:
    """The logarithm of a pose: the velocity that leads there in one second, yaw rate last."""
    half = 0.5 * pose[2]
    along = half / np.tan(half) if abs(half) > 1e-6 else 1.0
    return np.array([along * pose[0] + half * pose[1], along * pose[1] - half * pose[0], pose[2]])


def misses(graph: PoseGraph, poses: Pose) -> NDArray[np.float64]:
    """What each edge is missed by, weighed with its information ``(3 m,)``."""
    rows = [[graph.ids.tolist().index(v) for v in edge] for edge in graph.edges.tolist()]
    seen = between(poses[[a for a, _ in rows]], poses[[b for _, b in rows]])
    missed = between(graph.relative_poses, seen)
    roots = np.linalg.cholesky(graph.information).transpose(0, 2, 1)
    return np.concatenate([root @ log_of(each) for root, each in zip(roots, missed, strict=True)])


@settings(max_examples=8)
@given(seed=st.integers(0, 2**32))
def test_the_best_poses_and_chi2_are_those_of_least_squares(seed: int) -> None:
    graph = loop(seed, noise=0.03)
    found, chi2 = optimize_pose_graph(graph)
    best = least_squares(
        lambda rest: misses(graph, np.vstack((graph.poses[0], rest.reshape(-1, 3)))),
        graph.poses[1:].ravel(),
        xtol=1e-12,
        ftol=1e-12,
    )
    assert chi2 == pytest.approx(2.0 * best.cost, rel=1e-6)
    assert chi2 == chi2_of(found)
    away = between(np.vstack((graph.poses[0], best.x.reshape(-1, 3))), found.poses)
    assert np.abs(away).max() < 1e-4
    assert chi2_of(graph) == pytest.approx(np.sum(misses(graph, graph.poses) ** 2), rel=1e-9)


def test_measurements_without_error_are_met_exactly() -> None:
    graph = loop(3, noise=0.0)
    found, chi2 = optimize_pose_graph(graph)
    assert chi2 < 1e-12
    assert np.abs(misses(graph, found.poses)).max() < 1e-6
    for name in ("ids", "edges", "relative_poses", "information"):
        assert getattr(found, name) is getattr(graph, name)


def test_the_error_is_the_logarithm_of_the_pose() -> None:
    graph = PoseGraph(
        ids=np.arange(2),
        poses=np.array([[0.0, 0.0, 0.0], [1.0, 0.5, 0.7]]),
        edges=np.array([[0, 1]]),
        relative_poses=np.zeros((1, 3)),
        information=np.eye(3)[None],
    )
    velocity = log_of(graph.poses[1])
    turn = np.array([[0.0, -velocity[2], velocity[0]], [velocity[2], 0.0, velocity[1]], [0, 0, 0]])
    assert np.allclose(expm(turn)[:2, 2], graph.poses[1, :2]), "the oracle's own check"
    assert chi2_of(graph) == pytest.approx(float(velocity @ velocity))


def test_fixed_vertices_stay_where_they_are() -> None:
    graph = replace(loop(5, noise=0.1), fixed=(3, 40))
    found, _ = optimize_pose_graph(graph)
    assert np.array_equal(found.poses[[2, 4]], graph.poses[[2, 4]])
    assert np.abs(found.poses[0] - graph.poses[0]).max() > 1e-3
    first, _ = optimize_pose_graph(loop(5, noise=0.1))
    assert np.array_equal(first.poses[0], graph.poses[0]), "the first one, when none is fixed"


NO_EDGE = {
    "edges": np.empty((0, 2), dtype=np.int64),
    "relative_poses": np.empty((0, 3)),
    "information": np.empty((0, 3, 3)),
}


def test_a_vertex_alone_is_where_it_is() -> None:
    alone = PoseGraph(ids=np.array([9]), poses=np.array([[1.0, 2.0, 3.0]]))
    found, chi2 = optimize_pose_graph(alone)
    assert found.poses.tolist() == [[1.0, 2.0, 3.0]]
    assert chi2 == 0.0


@pytest.mark.parametrize(
    ("broken", "told"),
    [
        ({"ids": np.empty(0, dtype=np.int64), "poses": np.empty((0, 3)), **NO_EDGE}, "no vertex"),
        (NO_EDGE, "no edges lead from vertex 900 to vertex -7"),
        ({"edges": np.tile([900, 900], (7, 1))}, "edge 900 900"),
        ({"information": np.zeros((7, 3, 3))}, "left open"),
        ({"information": np.tile(np.diag([1.0, 1.0, 0.0]), (7, 1, 1))}, "left open"),
    ],
)
def test_a_graph_that_leaves_a_pose_open_is_refused(broken: dict[str, object], told: str) -> None:
    graph = replace(loop(1, noise=0.0), **broken)  # type: ignore[arg-type]
    with pytest.raises(TestbedError, match=told):
        optimize_pose_graph(graph)
