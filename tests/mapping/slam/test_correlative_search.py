import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from mapping.geometry import compose, transform_points
from mapping.slam.correlative_kernels import FULL
from mapping.slam.correlative_search import FAR_SHARE, SHIFT_PULL, TURN_PULL, search_window
from mapping.slam.hit_field import HitField
from mapping.slam.scan_cloud import ScanCloud
from tests.mapping.slam.rooms import cloud_of, random_room, scan_of

EDGE = 0.05
SEEDS = st.integers(0, 10_000)


def share_on_walls(field: HitField, cloud: ScanCloud, pose: NDArray[np.float64]) -> float:
    """Share of a scan, far points counting more, that lies on walls from a pose in cells."""
    points = cloud.points / EDGE
    arms = np.hypot(points[:, 0], points[:, 1])
    worth = cloud.weights * np.minimum(arms, max(np.percentile(arms, FAR_SHARE), 1.0))
    columns, rows = np.floor(transform_points(pose, points)).astype(int).T
    height, width, _ = field.density.shape
    known = field.maxima((0, height, 0, width), 1)[0][rows, columns] / FULL
    return float(worth @ known / worth.sum())


def seen(seed: int) -> tuple[HitField, ScanCloud, NDArray[np.float64], np.random.Generator]:
    """The field of a scan in a random room, another scan from the same pose, and the pose."""
    rng = np.random.default_rng(seed)
    walls = random_room(rng)
    pose = np.array([*rng.uniform(-0.3, 0.3, 2), rng.uniform(-np.pi, np.pi)])
    field = HitField(EDGE, 4.4, 1.0)
    field.clear(pose[:2])
    field.add(pose, cloud_of(scan_of(walls, pose, rng), EDGE).surface)
    return field, cloud_of(scan_of(walls, pose, rng), EDGE), pose, rng


@given(seed=SEEDS, turn=st.sampled_from([0.2, 1.5, np.pi]))
@settings(max_examples=40)
def test_the_best_pose_scores_no_worse_than_the_true_one(seed: int, turn: float) -> None:
    field, cloud, pose, rng = seen(seed)
    shift = 0.3
    # the truth is one of the poses tried: whole cells away, and at an end of the turns
    cells, end = rng.integers(-6, 7, 2), float(rng.choice([-turn, turn]))
    truth = field.to_cells(pose)
    found = search_window(field, cloud, truth - [*cells, end], shift, turn)
    cost = SHIFT_PULL * (cells @ cells) / 6**2 + TURN_PULL
    # shares are added up in float32
    assert found.score >= share_on_walls(field, cloud, truth) - cost - 1e-5
    offset = found.pose - truth + [*cells, end]
    own_cost = SHIFT_PULL * (offset[:2] @ offset[:2]) / 6**2 + TURN_PULL * (offset[2] / turn) ** 2
    score = share_on_walls(field, cloud, found.pose) - own_cost
    assert abs(found.score - score) < 1e-5


@given(seed=SEEDS)
@settings(max_examples=25)
def test_a_pose_within_the_window_is_found(seed: int) -> None:
    field, cloud, pose, rng = seen(seed)
    start = compose(pose, rng.uniform(-0.25, 0.25, 3))
    found = field.to_metres(search_window(field, cloud, field.to_cells(start), 0.4, 0.3).pose)
    # two cells: what costs less from afar may win over what fits a little better
    assert np.hypot(*(found - pose)[:2]) < 2.0 * EDGE
    assert abs(np.angle(np.exp(1j * (found - pose)[2]))) < 0.05


def test_a_window_beyond_the_fields_edge_finds_nothing() -> None:
    field, cloud, _, _ = seen(2)
    for center in ([-1e4, 50.0, 0.3], [50.0, 1e4, 0.3]):
        found = search_window(field, cloud, np.array(center), 0.3, 0.2)
        assert found.score == 0.0
        assert np.array_equal(found.pose, center)


def test_what_scores_below_the_floor_is_not_found() -> None:
    field, cloud, pose, _ = seen(0)
    center = field.to_cells(pose)
    best = search_window(field, cloud, center, 0.2, 0.1)
    assert search_window(field, cloud, center, 0.2, 0.1, best.score - 0.01).score == best.score
    none = search_window(field, cloud, center, 0.2, 0.1, best.score + 0.01)
    assert none.score == 0.0
    assert np.array_equal(none.pose, center)


def test_in_an_empty_field_the_middle_of_the_window_stays() -> None:
    field, cloud, pose, _ = seen(0)
    field.clear(pose[:2])
    center = field.to_cells(pose)
    assert np.array_equal(search_window(field, cloud, center, 0.3, 0.2).pose, center)


def test_a_window_without_turns_tries_the_yaw_alone() -> None:
    field, cloud, pose, _ = seen(1)
    center = field.to_cells(pose)
    assert search_window(field, cloud, center, 0.1, 0.0).pose[2] == center[2]
