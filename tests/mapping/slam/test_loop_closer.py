from itertools import pairwise

import numpy as np
import pytest

from mapping.errors import TestbedError
from mapping.geometry import Pose, between, compose
from mapping.slam.keyframe_graph import Edge, KeyframeGraph, edge_between
from mapping.slam.local_map import LocalMapConfig
from mapping.slam.loop_closer import LoopCloser, LoopConfig
from mapping.slam.scan_matcher import MatcherConfig
from tests.mapping.slam.rooms import RING_WAY, Walls, box, cloud_of, corridor, ring, scan_of

LOCAL = LocalMapConfig(resolution=0.05, reach=3.5, keyframes=10, way=8.0)
STEP = 0.4


def poses_along(way: list[tuple[float, float]]) -> Pose:
    """Poses a step apart along a way, looking ahead."""
    poses = []
    for (x0, y0), (x1, y1) in pairwise(way):
        length = np.hypot(x1 - x0, y1 - y0)
        heading = np.arctan2(y1 - y0, x1 - x0)
        for share in np.arange(0.0, length, STEP) / length:
            poses.append([x0 + share * (x1 - x0), y0 + share * (y1 - y0), heading])
    return np.array(poses)


def walked(
    walls: Walls, true: Pose, drift: tuple[float, float, float], variance: float
) -> tuple[KeyframeGraph, list[Edge]]:
    """Keyframes along a way that drifts with each step, and every edge that closes a loop."""
    rng, graph = np.random.default_rng(0), KeyframeGraph()
    closer = LoopCloser(graph, LOCAL, MatcherConfig(), LoopConfig())
    covariance = np.diag([variance, variance, 0.1 * variance])
    loops = []
    pose = true[0]
    for k, at in enumerate(true):
        if k:
            pose = compose(compose(pose, between(true[k - 1], at)), drift)
        graph.add(pose, cloud_of(scan_of(walls, at, rng)))
        if k:
            graph.connect(edge_between(k - 1, k, graph.poses[k - 1], pose, covariance))
        found = closer.edges(k, [])
        for edge in found:
            graph.connect(edge)
        loops += found
    return graph, loops


AROUND = poses_along([*RING_WAY, (1.0, -1.9)])


def assert_true_loops(loops: list[Edge], true: Pose) -> None:
    for edge in loops:
        missed = between(between(true[edge.a], true[edge.b]), edge.pose)
        # two cells of the field
        assert np.hypot(missed[0], missed[1]) < 0.1
        assert abs(missed[2]) < 0.05
        assert edge.is_loop
        assert edge.a < edge.b
        assert np.all(np.linalg.eigvalsh(edge.covariance) > 0.0)


@pytest.mark.parametrize(
    ("drift", "variance"), [((0.003, 0.002, 0.001), 2e-5), ((0.02, 0.0, 0.006), 1e-3)]
)
def test_a_place_seen_before_is_found_where_it_is(
    drift: tuple[float, float, float], variance: float
) -> None:
    graph, loops = walked(ring(), AROUND, drift, variance)
    assert len(loops) >= 2
    assert_true_loops(loops, AROUND)
    off = between(AROUND[-1], graph.poses[-1])
    assert np.hypot(*off[:2]) > 0.1  # else nothing is shown


def test_a_way_that_never_comes_back_closes_no_loop() -> None:
    way = [(-2.9, -1.9), (2.9, -1.9), (2.9, 1.9), (-2.9, 1.9)]
    _, loops = walked(ring(), poses_along(way), (0.01, 0.0, 0.002), 1e-3)
    assert loops == []


@pytest.mark.parametrize("drift", [0.002, 0.01, 0.03])
def test_a_bare_corridor_closes_no_false_loop_along_it(drift: float) -> None:
    # a corridor to and fro: it looks the same everywhere, ends and all out of sight
    true = poses_along([(-6.0, 0.0), (6.0, 0.0)])
    true = np.vstack((true, compose(true[::-1], (0.0, 0.0, np.pi))))
    graph, loops = walked(corridor(), true, (drift, 0.0, 0.0), 5.0 * drift**2)
    assert len(graph) == len(true)
    assert loops or drift > 0.002, "a narrow search holds it across and in yaw"
    for edge in loops:
        missed = between(between(true[edge.a], true[edge.b]), edge.pose)
        assert np.all(np.abs(missed) < 3.0 * np.sqrt(np.diag(edge.covariance)))


def test_rooms_that_look_alike_are_not_taken_for_one() -> None:
    # two equal rooms 9 m apart: farther than any search goes
    rooms = np.concatenate((box(-1.5, 1.5, -1.0, 1.0), box(7.5, 10.5, -1.0, 1.0)))
    one = poses_along([(-1.0, -0.5), (1.0, -0.5), (1.0, 0.5)])
    other = compose([9.0, 0.0, 0.0], one)
    _, loops = walked(rooms, np.vstack((one, other)), (0.0, 0.0, 0.0), 1e-3)
    assert loops == []


@pytest.mark.parametrize("name", LoopConfig.__slots__)
def test_settings_that_make_no_search_are_told_by_name(name: str) -> None:
    for value in (0.0, -1.0, float("nan")):
        with pytest.raises(TestbedError, match=name):
            LoopConfig(**{name: value})
