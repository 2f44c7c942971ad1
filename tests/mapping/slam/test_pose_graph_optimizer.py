import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray
from scipy.optimize import least_squares

from mapping.geometry import Pose, between, compose, wrap_to_pi
from mapping.slam.keyframe_graph import Edge
from mapping.slam.pose_graph_optimizer import PoseGraphOptimizer

SEEDS = st.integers(0, 10_000)
SIGMAS = np.array([0.02, 0.02, 0.01])


def round_trip(count: int) -> Pose:
    """Keyframes on a circle of 3 m, each looking on to the next."""
    angles = np.linspace(0.0, 2.0 * np.pi, count, endpoint=False)
    places = 3.0 * np.column_stack((np.cos(angles), np.sin(angles)))
    return np.column_stack((places - places[0], wrap_to_pi(angles + 0.5 * np.pi)))


def edge(
    poses: Pose, a: int, b: int, rng: np.random.Generator | None = None, *, is_loop: bool = False
) -> Edge:
    pose = between(poses[a], poses[b])
    if rng is not None:
        pose = compose(pose, rng.normal(0.0, SIGMAS))
    return Edge(a=a, b=b, pose=pose, covariance=np.diag(SIGMAS**2), is_loop=is_loop)


def led(edges: list[Edge], first: Pose, count: int) -> Pose:
    """Poses along the chain of the first edges."""
    poses = [first]
    for each in edges[: count - 1]:
        poses.append(compose(poses[-1], each.pose))
    return np.array(poses)


def residuals(poses: Pose, edges: list[Edge]) -> NDArray[np.float64]:
    """What each edge is missed by, in standard deviations ``(3 m,)``."""
    a, b = [each.a for each in edges], [each.b for each in edges]
    missed = between(np.array([each.pose for each in edges]), between(poses[a], poses[b]))
    return (missed / SIGMAS).ravel()


def dense_best(poses: Pose, edges: list[Edge], first: Pose) -> Pose:
    """Least squares over all poses but the first, by SciPy."""

    def errors(flat: NDArray[np.float64]) -> NDArray[np.float64]:
        return residuals(np.vstack((first, flat.reshape(-1, 3))), edges)

    found = least_squares(errors, poses[1:].ravel(), xtol=1e-12, ftol=1e-12)
    return np.vstack((first, found.x.reshape(-1, 3)))


@given(seed=SEEDS, count=st.integers(3, 8), more=st.integers(1, 5))
@settings(max_examples=20)
def test_the_best_poses_are_those_of_dense_least_squares(seed: int, count: int, more: int) -> None:
    rng = np.random.default_rng(seed)
    true = round_trip(count)
    edges = [edge(true, k, k + 1, rng) for k in range(count - 1)]
    for _ in range(more):
        a, b = rng.choice(count, 2, replace=False).tolist()
        edges.append(edge(true, a, b, rng))
    start = led(edges, true[0], count)
    best = PoseGraphOptimizer().optimize(start, edges, rounds=10)
    expected = dense_best(start, edges, true[0])
    apart = between(expected, best)
    # iSAM2 leaves be what moves by less than 0.01: second orders of that; and the first pose may
    # move by 1e-4
    assert np.max(np.abs(apart)) < 2e-3
    assert np.sum(residuals(best, edges) ** 2) < np.sum(residuals(start, edges) ** 2) + 1e-9


def test_a_chain_that_agrees_with_its_edges_stays() -> None:
    true = round_trip(20)
    edges = [edge(true, k, k + 1) for k in range(19)]
    best = PoseGraphOptimizer().optimize(true, edges)
    assert np.max(np.abs(between(true, best))) < 1e-6


def test_adding_edges_step_by_step_ends_where_all_at_once_do() -> None:
    rng, true = np.random.default_rng(1), round_trip(20)
    edges = [edge(true, k, k + 1, rng) for k in range(19)]
    loops = [edge(true, a, b, rng, is_loop=True) for a, b in ((0, 19), (1, 18), (2, 19))]
    start = led(edges, true[0], 20)
    at_once = PoseGraphOptimizer().optimize(start, edges + loops, rounds=20)
    stepwise, poses = PoseGraphOptimizer(), start[:10]
    poses = stepwise.optimize(poses, edges[:9])
    order = [*edges[:9], *edges[9:], *loops]
    poses = stepwise.optimize(np.vstack((poses, start[10:])), order[:19])
    for count in range(20, len(order) + 1):
        poses = stepwise.optimize(poses, order[:count], rounds=20)
    assert np.max(np.abs(between(at_once, poses))) < 2e-3  # as above


def closed(rng: np.random.Generator) -> tuple[Pose, list[Edge], Pose]:
    """True poses of a round trip, its edges with true loops all along, and where they lead."""
    true = np.vstack((round_trip(30), round_trip(30)))
    edges = [edge(true, k, k + 1, rng) for k in range(59)]
    edges += [edge(true, k, k + 30, rng, is_loop=True) for k in range(0, 30, 3)]
    return true, edges, led(edges, true[0], 60)


def test_true_loops_bring_a_drifted_chain_home() -> None:
    _, edges, start = closed(np.random.default_rng(0))
    best = PoseGraphOptimizer().optimize(start, edges, rounds=10)
    before = np.hypot(*between(start[:30], start[30:])[:, :2].T)
    after = np.hypot(*between(best[:30], best[30:])[:, :2].T)
    # rounds lie on one another to a few sigmas of an edge
    assert np.max(before) > 0.2  # else nothing is shown
    assert np.max(after) < 4.0 * SIGMAS[0]


def test_a_false_loop_bends_the_map_only_a_little() -> None:
    true, edges, start = closed(np.random.default_rng(0))
    honest = PoseGraphOptimizer().optimize(start, edges, rounds=10)
    wrong = between(true[4], compose(true[17], [3.0, 2.0, 1.0]))
    bends = []
    for is_loop in (True, False):
        false = Edge(a=4, b=17, pose=wrong, covariance=np.diag(SIGMAS**2), is_loop=is_loop)
        bent = PoseGraphOptimizer().optimize(start, [*edges, false], rounds=20)
        bends.append(np.max(np.hypot(*between(honest, bent)[:, :2].T)))
    # a tenth of the 3.6 m that it is false by; without the robust loss most of them
    assert bends[0] < 0.36
    assert bends[1] > 2.0


def test_poses_of_one_keyframe_stay() -> None:
    pose = np.array([[1.0, -2.0, 0.5]])
    assert PoseGraphOptimizer().optimize(pose, []) == pytest.approx(pose, abs=1e-6)
