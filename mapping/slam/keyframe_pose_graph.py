"""Turns the keyframes of a mapper and the matches between them into a pose graph for files."""

import numpy as np

from mapping.mapper import Mapper
from mapping.pose_graph import PoseGraph
from mapping.slam.graph_slam import GraphSlam
from mapping.slam.keyframe_graph import KeyframeGraph
from mapping.slam.metric_scale import grown, scaled


def pose_graph_of(mapper: Mapper) -> PoseGraph | None:
    """The pose graph that a mapper believes in; None for one that keeps none, or has none yet."""
    if not isinstance(mapper, GraphSlam) or len(mapper.graph) == 0:
        return None
    return keyframe_pose_graph(mapper.graph, mapper.painter.scale)


def keyframe_pose_graph(graph: KeyframeGraph, scale: float = 1.0) -> PoseGraph:
    """The keyframes as vertices, numbered as they were taken, and every match as an edge.

    The first keyframe is fixed. A mapper's back end weighs edges that close loops robustly, which
    g2o's files cannot say: optimised without that, poses may come out a little otherwise.

    Args:
        graph: The keyframes, in metres of the lidar.
        scale: What such a metre is believed to be [m].
    """
    edges = graph.edges
    information = np.linalg.inv(np.array([e.covariance for e in edges]).reshape(-1, 3, 3))
    return PoseGraph(
        ids=np.arange(len(graph)),
        poses=grown(graph.poses, graph.poses[:1], scale),
        edges=np.array([(e.a, e.b) for e in edges], dtype=np.int64).reshape(-1, 2),
        relative_poses=scaled(np.array([e.pose for e in edges]).reshape(-1, 3), scale),
        information=(information + information.transpose(0, 2, 1)) / 2.0,
        fixed=(0,) if len(graph) else (),
    )
