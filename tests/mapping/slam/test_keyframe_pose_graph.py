import numpy as np
import pytest

from mapping.geometry import between
from mapping.occ_grid_mapp import OccGridMapp
from mapping.slam.graph_slam import GraphSlam
from mapping.slam.keyframe_graph import KeyframeGraph, edge_between
from mapping.slam.keyframe_pose_graph import keyframe_pose_graph, pose_graph_of
from mapping.slam.pose_graph_optimizer import chi2_of
from mapping.slam.scan_cloud import ScanCloud
from tests.mapping.arena import circling, drive

EMPTY = ScanCloud(
    points=np.empty((0, 2)),
    normals=np.empty((0, 2)),
    weights=np.empty(0),
    surface=np.empty((0, 5), dtype=np.float32),
)


def test_every_keyframe_is_a_vertex_and_every_match_an_edge_with_its_inverse_covariance() -> None:
    graph = KeyframeGraph()
    poses = np.array([[0.0, 0.0, 0.0], [1.0, 0.2, 0.5], [1.5, 1.0, 1.2]])
    for pose in poses:
        graph.add(pose, EMPTY)
    covariance = np.array([[4e-4, 1e-4, 0.0], [1e-4, 9e-4, 2e-5], [0.0, 2e-5, 1e-4]])
    for a, b in ((0, 1), (1, 2), (0, 2)):
        graph.connect(edge_between(a, b, poses[a], poses[b], covariance, is_loop=b - a > 1))
    written = keyframe_pose_graph(graph)
    assert written.ids.tolist() == [0, 1, 2]
    assert written.fixed == (0,)
    assert written.edges.tolist() == [[0, 1], [1, 2], [0, 2]]
    assert np.array_equal(written.poses, poses)
    assert np.allclose(written.relative_poses, between(poses[[0, 1, 0]], poses[[1, 2, 2]]))
    for edge, information in zip(graph.edges, written.information, strict=True):
        assert np.allclose(information @ edge.covariance, np.eye(3))
    assert chi2_of(written) == pytest.approx(0.0, abs=1e-12)
    graph.correct(poses + 1.0)
    assert np.array_equal(written.poses, poses), "a copy: the mapper goes on without changing it"


def test_only_a_mapper_with_a_pose_graph_has_one() -> None:
    mapper = GraphSlam()
    assert pose_graph_of(mapper) is None, "nothing seen yet"
    assert pose_graph_of(OccGridMapp()) is None
    for scan, odometry in drive(circling(), 2.0):
        mapper.update(scan, odometry)
    graph = pose_graph_of(mapper)
    assert graph is not None
    assert len(graph.ids) == len(mapper.graph) > 0
