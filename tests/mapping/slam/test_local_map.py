import numpy as np

from mapping.geometry import Pose
from mapping.slam.hit_field import HitField
from mapping.slam.keyframe_graph import KeyframeGraph, edge_between
from mapping.slam.local_map import LocalMap, LocalMapConfig
from tests.mapping.slam.rooms import cloud_of, random_room, scan_of

ROOM = random_room(np.random.default_rng(3))
SURE = np.diag([1e-4, 1e-4, 1e-5])
CONFIG = LocalMapConfig(resolution=0.05, reach=3.5, keyframes=4, way=3.0)


def chain(count: int, step: float = 0.5) -> KeyframeGraph:
    """Keyframes one behind the other along x, each tied to the one before."""
    graph = KeyframeGraph()
    for k in range(count):
        pose = np.array([step * k, 0.0, 0.0])
        graph.add(pose, cloud_of(scan_of(ROOM, np.array([0.1 * (k % 3), 0.0, 0.0]))))
        if k:
            graph.connect(edge_between(k - 1, k, graph.poses[k - 1], pose, SURE))
    return graph


def filled(graph: KeyframeGraph, center: Pose, keyframes: list[int]) -> HitField:
    """The field that these keyframes make, in this order."""
    field = LocalMap(KeyframeGraph(), CONFIG).field
    field.clear(center)
    for k in keyframes:
        field.add(graph.poses[k], graph.clouds[k].surface)
    return field


def test_the_nearest_views_make_the_field() -> None:
    graph = chain(12)
    local = LocalMap(graph, CONFIG)
    local.gather(6, graph.views[6])
    nearest = np.argsort(np.abs(graph.views[:, 0] - graph.views[6, 0]), kind="stable")[:4]
    assert sorted(local.keyframes) == sorted(nearest.tolist())
    field = filled(graph, graph.poses[6, :2], local.keyframes)
    assert np.array_equal(local.field.density, field.density)
    assert np.array_equal(local.field.corner, field.corner)


def test_keyframes_far_along_the_way_are_left_out_though_they_are_near() -> None:
    graph = chain(12)
    back = graph.add(np.array([0.1, 0.0, 0.0]), graph.clouds[0])  # after a round, on the first one
    graph.connect(edge_between(11, back, graph.poses[11], graph.poses[back], SURE))
    local = LocalMap(graph, CONFIG)
    local.gather(back, graph.views[back])
    ways, _ = graph.ways(back)
    assert 0 not in local.keyframes
    assert all(ways[k] <= CONFIG.way for k in local.keyframes)


def test_keyframes_that_must_not_be_in_it_are_not() -> None:
    graph = chain(6)
    local = LocalMap(graph, CONFIG)
    local.gather(3, graph.views[3], {2, 3})
    assert {2, 3}.isdisjoint(local.keyframes)
    assert len(local.keyframes) == 4


def test_the_field_holds_no_old_poses_after_a_correction() -> None:
    graph = chain(6)
    local = LocalMap(graph, CONFIG)
    local.follow(2, graph.views[2])
    graph.correct(graph.poses + [0.0, 0.3, 0.1])
    local.follow(2, graph.views[2])
    field = filled(graph, graph.poses[2, :2], local.keyframes)
    assert np.array_equal(local.field.density, field.density)


def test_following_step_by_step_keeps_what_is_near() -> None:
    graph = chain(20)
    local = LocalMap(graph, CONFIG)
    for near in range(20):
        local.follow(near, graph.views[near])
        nearest = np.argsort(np.abs(graph.views[:, 0] - graph.views[near, 0]), kind="stable")[:4]
        assert set(nearest.tolist()) <= set(local.keyframes)
        # and no more than half as many that are not asked for any more
        assert len(local.keyframes) <= 4 + 2
        assert np.hypot(*(local.field.center - graph.poses[near, :2])) < 0.25 * CONFIG.reach + 0.05
        density = filled(graph, local.field.center, local.keyframes).density
        assert np.allclose(local.field.density, density, atol=1e-4)


def test_without_keyframes_near_the_field_is_empty() -> None:
    graph = chain(3)
    local = LocalMap(graph, CONFIG)
    local.gather(1, graph.views[1], {0, 1, 2})
    assert local.keyframes == []
    assert not local.field.density.any()
