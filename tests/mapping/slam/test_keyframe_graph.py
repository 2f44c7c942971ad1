import heapq
from dataclasses import replace

import gtsam
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from mapping.geometry import Pose, between, compose
from mapping.slam.keyframe_graph import (
    FIRST_ROOM,
    STEP_LENGTH,
    TURN_LENGTH,
    Edge,
    KeyframeGraph,
    edge_between,
    look_of,
    sight_of,
)
from mapping.slam.pose_graph_optimizer import factor_of
from mapping.slam.scan_cloud import ScanCloud
from tests.mapping.slam.rooms import box, cloud_of, random_room, scan_of

SEEDS = st.integers(0, 10_000)
CLOUD = cloud_of(scan_of(random_room(np.random.default_rng(0)), np.zeros(3)))
EMPTY = ScanCloud(
    points=np.zeros((0, 2)),
    normals=np.zeros((0, 2)),
    weights=np.zeros(0),
    surface=np.zeros((0, 5), dtype=np.float32),
)


def random_poses(rng: np.random.Generator, count: int) -> Pose:
    return np.column_stack((rng.uniform(-5.0, 5.0, (count, 2)), rng.uniform(-3.0, 3.0, count)))


def random_edge(rng: np.random.Generator, poses: Pose, a: int, b: int) -> Edge:
    """The true edge between two keyframes, with a covariance of its own along the axes."""
    variances = rng.uniform([1e-4, 1e-4, 1e-5], [1e-2, 1e-2, 1e-3])
    pose = between(poses[a], poses[b])
    return Edge(a=a, b=b, pose=pose, covariance=np.diag(variances), is_loop=False)


def random_graph(rng: np.random.Generator, count: int, more: int) -> KeyframeGraph:
    """A graph of a random tree and some more edges, none twice."""
    graph, poses = KeyframeGraph(), random_poses(rng, count)
    pairs = {(int(rng.integers(b)), b) for b in range(1, count)}
    for _ in range(more):
        a, b = sorted(rng.choice(count, 2, replace=False).tolist())
        pairs.add((a, b))
    for pose in poses:
        graph.add(pose, CLOUD)
    for a, b in sorted(pairs):
        graph.connect(random_edge(rng, poses, a, b))
    return graph


def slow_ways(graph: KeyframeGraph, first: int) -> list[float]:
    """Dijkstra's shortest ways with a heap."""
    ways = [np.inf] * len(graph)
    heap = [(0.0, first)]
    while heap:
        way, here = heapq.heappop(heap)
        if way >= ways[here]:
            continue
        ways[here] = way
        for edge in graph.edges:
            x, y, turn = edge.pose
            length = STEP_LENGTH + np.hypot(x, y) + TURN_LENGTH * abs(turn)
            for here_end, there_end in ((edge.a, edge.b), (edge.b, edge.a)):
                if here_end == here:
                    heapq.heappush(heap, (way + length, there_end))
    return ways


@given(seed=SEEDS, count=st.integers(2, 12), more=st.integers(0, 10))
@settings(max_examples=30)
def test_ways_are_the_shortest_along_edges(seed: int, count: int, more: int) -> None:
    rng = np.random.default_rng(seed)
    graph = random_graph(rng, count, more)
    first = int(rng.integers(count))
    ways, before = graph.ways(first)
    assert ways == pytest.approx(slow_ways(graph, first))
    assert before[first] < 0
    for keyframe in set(range(count)) - {first}:
        # the way to the keyframe before it, and on along an edge
        x, y, turn = between(graph.poses[before[keyframe]], graph.poses[keyframe])
        step = STEP_LENGTH + np.hypot(x, y) + TURN_LENGTH * abs(turn)
        assert ways[keyframe] == pytest.approx(ways[before[keyframe]] + step)


def test_a_second_edge_between_two_keyframes_makes_no_way_longer() -> None:
    graph = random_graph(np.random.default_rng(0), 2, 0)
    way = graph.ways(0)[0][1]
    graph.connect(graph.edges[0])
    assert graph.ways(0)[0][1] == pytest.approx(way)


def test_keyframes_beyond_the_limit_or_without_a_way_are_infinitely_far() -> None:
    graph = KeyframeGraph()
    for x in range(4):
        graph.add(np.array([float(x), 0.0, 0.0]), CLOUD)
    assert graph.ways(0)[0].tolist() == [0.0, np.inf, np.inf, np.inf]
    for b in (1, 2):
        graph.connect(random_edge(np.random.default_rng(0), graph.poses, b - 1, b))
    ways, _ = graph.ways(0)
    assert np.isfinite(ways).tolist() == [True, True, True, False]
    ways, _ = graph.ways(0, limit=1.5)
    assert np.isfinite(ways).tolist() == [True, True, False, False]


def marginal(graph: KeyframeGraph, seen: int, seen_from: int) -> NDArray[np.float64]:
    """Covariance ``(3, 3)`` of one keyframe seen from another, by GTSAM; x and y in the map."""
    factors, values = gtsam.NonlinearFactorGraph(), gtsam.Values()
    for key, pose in enumerate(graph.poses):
        values.insert(key, gtsam.Pose2(*pose))
    held = gtsam.noiseModel.Isotropic.Sigma(3, 1e-8)
    factors.add(gtsam.PriorFactorPose2(seen_from, values.atPose2(seen_from), held))
    for edge in graph.edges:
        factors.add(factor_of(edge))
    return np.asarray(gtsam.Marginals(factors, values).marginalCovariance(seen))


@given(seed=SEEDS, count=st.integers(2, 8), more=st.integers(0, 6))
@settings(max_examples=30)
def test_the_uncertainty_is_no_less_than_the_marginal_covariance(
    seed: int, count: int, more: int
) -> None:
    graph = random_graph(np.random.default_rng(seed), count, more)
    newest = count - 1
    _, before = graph.ways(newest)
    place, yaw = graph.uncertainty(newest, 0, before)
    covariance = marginal(graph, newest, 0)
    largest = np.linalg.eigvalsh(covariance[:2, :2])[-1]
    assert place >= largest * (1.0 - 1e-6)
    assert yaw >= covariance[2, 2] * (1.0 - 1e-6)


@given(seed=SEEDS)
@settings(max_examples=10)
def test_the_uncertainty_along_a_straight_chain_is_the_marginal_covariance(seed: int) -> None:
    rng, graph = np.random.default_rng(seed), KeyframeGraph()
    for x in np.cumsum(rng.uniform(0.2, 3.0, 6)):
        graph.add(np.array([x, 0.0, 0.0]), CLOUD)
    for b in range(1, 6):
        edge = random_edge(rng, graph.poses, b - 1, b)
        alike = np.diag(edge.covariance)[[0, 0, 2]]
        graph.connect(replace(edge, covariance=np.diag(alike)))
    place, yaw = graph.uncertainty(5, 0, graph.ways(5)[1])
    # every turn of the way moves its end sideways, by what is left of the way
    covariance = marginal(graph, 5, 0)
    assert place == pytest.approx(covariance[1, 1], rel=1e-4)
    assert yaw == pytest.approx(covariance[2, 2], rel=1e-4)


def test_the_uncertainty_grows_along_a_chain() -> None:
    rng, graph = np.random.default_rng(0), KeyframeGraph()
    for x in range(10):
        graph.add(np.array([0.5 * x, 0.1 * x, 0.3 * x]), CLOUD)
    for b in range(1, 10):
        graph.connect(random_edge(rng, graph.poses, b - 1, b))
    _, before = graph.ways(9)
    told = np.array([graph.uncertainty(9, other, before) for other in range(9, -1, -1)])
    assert np.all(np.diff(told, axis=0) > 0.0)
    assert told[0].tolist() == [0.0, 0.0]


@given(seed=SEEDS)
def test_an_edge_holds_the_second_keyframe_seen_from_the_first(seed: int) -> None:
    rng = np.random.default_rng(seed)
    pose_a, pose_b = random_poses(rng, 2)
    root = rng.normal(size=(3, 3))
    edge = edge_between(3, 7, pose_a, pose_b, root @ root.T, is_loop=True)
    apart = between(pose_b, compose(pose_a, edge.pose))
    assert apart == pytest.approx([0.0, 0.0, 0.0], abs=1e-9)
    # a small shift weighs the same in the map and in the second keyframe's own frame
    shift = rng.normal(size=3) * 1e-6
    own = between(pose_b, pose_b + shift)
    in_map = shift @ np.linalg.solve(root @ root.T, shift)
    assert own @ np.linalg.solve(edge.covariance, own) == pytest.approx(in_map, rel=1e-4)
    assert (edge.a, edge.b, edge.is_loop) == (3, 7, True)


def test_tables_grow_beyond_their_first_room() -> None:
    rng, graph = np.random.default_rng(0), KeyframeGraph()
    poses = random_poses(rng, 2 * FIRST_ROOM + 3)
    for number, pose in enumerate(poses):
        assert graph.add(pose, CLOUD) == number
        if number:
            graph.connect(random_edge(rng, poses, number - 1, number))
    assert np.array_equal(graph.poses, poses)
    assert len(graph) == len(graph.edges) + 1 == len(poses)
    assert np.isfinite(graph.ways(0)[0]).all()


def test_corrected_poses_move_the_views_but_not_newer_keyframes() -> None:
    graph, poses = KeyframeGraph(), random_poses(np.random.default_rng(0), 3)
    half = ScanCloud(
        points=np.array([[1.0, 0.0], [3.0, 1.0]]),
        normals=np.zeros((2, 2)),
        weights=np.ones(2),
        surface=CLOUD.surface,
    )
    for pose in poses:
        graph.add(pose, half)
    before = graph.views.copy()
    graph.correct(poses[:2] + [1.0, -2.0, 0.0])
    assert graph.corrections == 1
    assert graph.views - before == pytest.approx(np.array([[1.0, -2.0], [1.0, -2.0], [0.0, 0.0]]))
    assert graph.views[2] == pytest.approx(compose(poses[2], [2.0, 0.5, 0.0])[:2])


def test_a_scan_that_saw_nothing_has_no_look() -> None:
    assert look_of(EMPTY) == pytest.approx([0.0, 0.0])
    assert sight_of(EMPTY) == 0.0


def test_a_scan_in_the_middle_of_a_room_looks_all_around() -> None:
    cloud = cloud_of(scan_of(box(-1.0, 1.0, -1.0, 1.0), np.array([0.032, 0.0, 0.0])))
    assert look_of(cloud) == pytest.approx([-0.032, 0.0], abs=0.01)
    # beams at 22.5 degrees and the like from a wall: half are longer
    assert sight_of(cloud) == pytest.approx(1.0 / np.cos(np.pi / 8), abs=0.03)
