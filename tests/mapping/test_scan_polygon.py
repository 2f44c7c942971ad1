import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray
from shapely import Point, Polygon, union_all

from mapping.polygon_fill import lower_inside
from mapping.scan_polygon import (
    AGREE,
    APART,
    DISAGREE,
    STRIP_HALF_WIDTH,
    compare_neighbours,
    free_outline,
)

AMOUNT, LOWEST = np.float32(1.5), np.float32(-4.0)
ROWS, COLUMNS = 40, 44

Array = NDArray[np.float64]


def winding(edges: Array, x: float, y: float) -> int:
    """How often edges wind around a point: by the signed angles they are seen under."""
    a, b = edges[:, :2] - [x, y], edges[:, 2:] - [x, y]
    angles = np.arctan2(a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0], np.sum(a * b, axis=1))
    return round(float(angles.sum() / (2.0 * np.pi)))


def slow_lower(log_odds: NDArray[np.float32], edges: Array) -> None:
    for row in range(log_odds.shape[0]):
        for column in range(log_odds.shape[1]):
            if winding(edges, column + 0.5, row + 0.5) != 0:
                log_odds[row, column] = max(log_odds[row, column] - AMOUNT, LOWEST)


def closed(points: Array) -> Array:
    """The edges of a closed polygon."""
    return np.concatenate((points, np.roll(points, -1, axis=0)), axis=1)


@given(
    corners=st.lists(st.tuples(st.floats(-9, 50), st.floats(-9, 50)), min_size=3, max_size=9),
    seed=st.integers(0, 99),
)
@settings(max_examples=60, deadline=None)
def test_a_filled_outline_equals_the_slow_reference_cell_by_cell(
    corners: list[tuple[float, float]], seed: int
) -> None:
    # a hair off, so that no edge goes exactly through a centre, which belongs to neither side
    edges = closed(np.array(corners) + np.random.default_rng(seed).uniform(1e-4, 2e-4, 2))
    before = np.random.default_rng(seed).normal(0.0, 3.0, (ROWS, COLUMNS)).astype(np.float32)
    fast, slow = before.copy(), before.copy()
    lower_inside(fast, edges, AMOUNT, LOWEST)
    slow_lower(slow, edges)
    assert np.array_equal(fast, slow)


def fan(count: int, lengths: Array, moved: float = 0.0) -> tuple[Array, Array]:
    """Origins, drifting by ``moved`` cells, and directions of beams all round."""
    angles = 2.0 * np.pi * np.arange(count) / count + 0.01
    origins = np.array([22.0, 20.0]) + np.linspace(0.0, moved, count)[:, np.newaxis]
    return origins, np.column_stack((np.cos(angles), np.sin(angles)))


def wedges(origins: Array, directions: Array, lengths: Array, pairs: NDArray[np.uint8]) -> Polygon:
    """The free space of a scan, put together from its pieces: the oracle of the outline."""
    count, pieces, reached = len(lengths), [], np.zeros(len(lengths))
    for i in range(count):
        j = (i + 1) % count
        if pairs[i] == APART:
            continue
        a, b = lengths[i], lengths[j]
        a, b = (a, b) if pairs[i] == AGREE else (min(a, b), min(a, b))
        reached[i], reached[j] = max(reached[i], a), max(reached[j], b)
        ends = [origins[i] + a * directions[i], origins[j] + b * directions[j]]
        pieces.append(Polygon([origins[i], *ends, origins[j]]).buffer(0))
    for i in range(count):
        side = STRIP_HALF_WIDTH * np.array([-directions[i, 1], directions[i, 0]])
        near, far = (origins[i] + s * directions[i] for s in (reached[i], lengths[i]))
        pieces.append(Polygon([near - side, far - side, far + side, near + side]).buffer(0))
    return union_all(pieces, grid_size=1e-9)


@given(seed=st.integers(0, 999), moved=st.sampled_from([0.0, 0.7]))
@settings(max_examples=25, deadline=None)
def test_the_outline_holds_the_wedges_and_strips_of_a_scan(seed: int, moved: float) -> None:
    rng = np.random.default_rng(seed)
    count = 36
    lengths = rng.uniform(3.0, 18.0, count)
    pairs = rng.choice([APART, DISAGREE, AGREE], count, p=[0.2, 0.3, 0.5]).astype(np.uint8)
    if moved > 0.0:
        pairs[-1] = APART  # a moved sensor's last wedge may cross itself: no oracle for its inside
    origins, directions = fan(count, lengths, moved)
    filled = np.zeros((ROWS, COLUMNS), dtype=np.float32)
    lower_inside(filled, free_outline(origins, directions, lengths, pairs), AMOUNT, LOWEST)
    space = wedges(origins, directions, lengths, pairs)
    # Away from every border the two agree; on a border a centre may count as either, and so it may
    # under the robot, where wedges of a moving sensor turn over and cancel one another.
    for row in range(ROWS):
        for column in range(COLUMNS):
            centre = Point(column + 0.5, row + 0.5)
            under_robot = moved > 0.0 and np.hypot(column - 21.5, row - 19.5) < 4.0
            if not under_robot and space.boundary.distance(centre) > 0.05 + 0.1 * moved:
                assert (filled[row, column] < 0.0) == space.contains(centre)


def test_each_cell_is_lowered_once_however_many_beams_cross_it() -> None:
    count = 360
    origins, directions = fan(count, np.full(count, 15.0))
    apart = np.full(count, APART, dtype=np.uint8)
    filled = np.zeros((ROWS, COLUMNS), dtype=np.float32)
    lower_inside(
        filled, free_outline(origins, directions, np.full(count, 15.0), apart), AMOUNT, LOWEST
    )
    assert set(np.unique(filled)) == {np.float32(0.0), -AMOUNT}


def test_beams_that_agree_leave_no_gap_and_free_a_whole_disc() -> None:
    count, radius = 36, 18.0
    origins, directions = fan(count, np.full(count, radius))
    filled = np.zeros((ROWS, COLUMNS), dtype=np.float32)
    pairs = np.full(count, AGREE, dtype=np.uint8)
    lower_inside(
        filled, free_outline(origins, directions, np.full(count, radius), pairs), AMOUNT, LOWEST
    )
    rows, columns = np.indices(filled.shape) + 0.5
    distance = np.hypot(columns - 22.0, rows - 20.0)
    assert np.all(filled[distance < radius * np.cos(np.pi / count) - 1e-6] < 0.0)
    assert np.all(filled[distance > radius] == 0.0)


def compare(lengths: list[float], hits: list[bool], angles_deg: list[float]) -> list[int]:
    angles = np.radians(angles_deg)
    pairs = compare_neighbours(
        np.column_stack((np.cos(angles), np.sin(angles))),
        np.array(lengths),
        0.01 * np.array(lengths),
        np.array(hits),
        float(np.radians(1.5)),
    )
    return [int(pair) for pair in pairs]


def test_neighbours_on_one_wall_agree_and_at_an_edge_they_do_not() -> None:
    pairs = compare([1.0, 1.01, 2.0, 3.5], [True, True, True, False], [0.0, 1.0, 2.0, 3.0])
    assert pairs == [AGREE, DISAGREE, DISAGREE, APART]


def test_beams_around_a_failed_one_are_no_neighbours() -> None:
    assert compare([1.0, 1.0], [True, True], [0.0, 2.0]) == [APART, APART]


def test_two_beams_without_return_agree() -> None:
    assert compare([3.5, 3.5], [False, False], [10.0, 11.0])[0] == AGREE
