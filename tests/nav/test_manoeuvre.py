"""The way out of pockets: in every slot that the robot got into, and never touching a wall."""

import heapq
import math

import numpy as np
import pytest
from hypothesis import assume, example, given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray
from shapely import MultiPoint, Point

from mapping.errors import TestbedError
from mapping.geometry import Pose
from mapping.grid import OccupancyGrid
from nav.gap_kernels import bucket_points, gaps_at, occupied_near, worth_minding
from nav.manoeuvre import ManoeuvreConfig, plan_manoeuvre, turning_radius
from nav.manoeuvre_drive import ManoeuvreDrive
from nav.manoeuvre_kernels import BACKWARD, NO_MOVE, search_way
from nav.outline import BURGER_OUTLINE
from nav.recovery import Recovery
from nav.safety import Safety, SafetyConfig
from nav.safety_kernels import outline_distance
from tests.nav.slots import Slot, driven, outline_at

PERIOD = 0.1
SCAN_EVERY = 2
"""Periods from scan to scan."""
NOISE = 0.0033
"""Standard deviation of the lidar close by [m]."""
ROOM = turning_radius(BURGER_OUTLINE) + SafetyConfig().margin


@given(
    width=st.floats(0.26, 0.32),
    depth=st.floats(0.25, 1.1),
    turned=st.floats(-3.0, 3.0),
    slant=st.floats(-0.5, 0.5),
    ahead=st.floats(0.1, 1.05),
    aside=st.floats(-0.04, 0.04),
    yaw=st.floats(-0.6, 0.6),
    seed=st.integers(0, 1000),
)
@example(0.275, 1.1, 0.0, 0.0, 1.0, 0.0, 0.1, 1)
@settings(max_examples=60, deadline=None)
def test_it_gets_out_of_any_slot_that_it_got_into_without_touching(
    width: float,
    depth: float,
    turned: float,
    slant: float,
    ahead: float,
    aside: float,
    yaw: float,
    seed: int,
) -> None:
    slot = Slot(width, depth, turned, slant)
    pose = slot.pose(ahead, aside, yaw)
    start = outline_at(pose)
    assume(start.distance(slot.lines) > 0.012)
    assume(ahead < depth)
    end, nearest = drive_out(slot, pose, np.random.default_rng(seed))
    assert nearest > 0.004
    assert slot.lines.distance(Point(end[:2])) > ROOM - 0.01


def drive_out(slot: Slot, pose: Pose, rng: np.random.Generator) -> tuple[Pose, float]:
    """Where the robot ends, and how near it came to the walls, with a lidar that is noisy."""
    drive, safety, grid, walls = ManoeuvreDrive(), Safety(), OccupancyGrid(), slot.lines
    points = seen(slot, rng)
    drive.begin(pose, points, grid)
    nearest = math.inf
    for k in range(1200):
        if k % SCAN_EVERY == 0:
            points = seen(slot, rng)
        twist = drive.command(pose, points, grid, PERIOD)
        if twist is None:
            break
        pose = driven(pose, safety.limit(twist, pose, points, grid), PERIOD)
        nearest = min(nearest, outline_at(pose).distance(walls))
    assert not drive.active
    return pose, nearest


def seen(slot: Slot, rng: np.random.Generator) -> NDArray[np.float64]:
    points = slot.points
    return points + rng.normal(0.0, NOISE / math.sqrt(2.0), points.shape)


def test_where_the_robot_can_turn_no_manoeuvre_is_needed() -> None:
    angles = np.linspace(0.0, 2.0 * np.pi, 200)
    ring = 0.16 * np.column_stack((np.cos(angles), np.sin(angles)))
    assert plan(np.zeros(3), ring) == ()


def test_from_a_closed_cell_there_is_no_way_out() -> None:
    angles = np.linspace(0.0, 2.0 * np.pi, 200)
    ring = np.column_stack((-0.03 + 0.145 * np.cos(angles), 0.145 * np.sin(angles)))
    assert plan(np.zeros(3), ring) == ()


def test_a_wall_that_only_the_map_knows_is_kept_clear_of() -> None:
    slot = Slot(0.28, 0.5, 0.0, 0.0)
    pose, grid = slot.pose(0.3, 0.0, 0.0), OccupancyGrid()
    assert plan(pose, slot.points)[-1].x < 0.2
    rows, columns = grid.world_to_cell([[0.05, y] for y in np.linspace(-0.14, 0.14, 29)]).T
    grid.log_odds[rows, columns] = 5.0
    assert plan_manoeuvre(pose, slot.points, grid, ManoeuvreConfig(), SafetyConfig()) == ()


def test_a_slot_a_robot_came_into_straight_it_leaves_straight() -> None:
    legs = plan(np.array([0.3, 0.0, 0.0]), Slot(0.26, 0.5, 0.0, 0.0).points)
    assert [leg.turns for leg in legs] == [False]
    assert legs[0].way < 0.0


def test_where_the_first_way_did_not_help_the_next_leads_elsewhere() -> None:
    narrow = np.array([[0.0, y] for y in (-0.14, -0.13, -0.12, 0.12, 0.13, 0.14)])
    drive, pose, grid = ManoeuvreDrive(), np.array([0.04, 0.0, 0.0]), OccupancyGrid()
    ends = []
    for elsewhere in (False, True):
        assert drive.begin(pose, narrow, grid, elsewhere=elsewhere)
        twist = drive.command(pose, narrow, grid, PERIOD)
        assert twist is not None
        ends.append(np.sign(twist.linear_x))
    assert ends == [1.0, -1.0]


def plan(pose: Pose, points: NDArray[np.float64]) -> tuple[object, ...]:
    return plan_manoeuvre(pose, points, OccupancyGrid(), ManoeuvreConfig(), SafetyConfig())


def test_the_second_recovery_in_a_row_manoeuvres_and_the_first_does_not() -> None:
    slot = Slot(0.28, 0.5, 0.0, 0.0)
    pose = slot.pose(0.34, 0.0, 0.25)
    ends = []
    for in_a_row in (1, 2):
        recovery, safety, at = Recovery(), Safety(), pose
        recovery.begin(pose, in_a_row)
        for _ in range(600):
            twist = recovery.command(at, slot.points, OccupancyGrid(), PERIOD)
            if twist is None:
                break
            at = driven(at, safety.limit(twist, at, slot.points, OccupancyGrid()), PERIOD)
        assert not recovery.active
        ends.append(slot.lines.distance(Point(at[:2])))
    assert ends[0] < ROOM - 0.01
    assert ends[1] > ROOM - 0.01


def test_settings_with_which_nothing_is_found_are_refused() -> None:
    with pytest.raises(TestbedError, match="manoeuvre step: 0"):
        ManoeuvreConfig(step=0.0)
    with pytest.raises(TestbedError, match="manoeuvre reserves"):
        ManoeuvreConfig(reserves=())


@given(
    seed=st.integers(0, 10_000),
    x=st.floats(-0.5, 0.5),
    y=st.floats(-0.5, 0.5),
    yaw=st.floats(-3.0, 3.0),
)
@settings(max_examples=40, deadline=None)
def test_the_gaps_equal_shapelys_up_to_a_buckets_size(
    seed: int, x: float, y: float, yaw: float
) -> None:
    points = np.random.default_rng(seed).uniform(-1.0, 1.0, (60, 2))
    size, count = 0.15, 12
    ordered, begins = bucket_points(points, -0.9, -0.9, size, count)
    inside = np.all(np.abs(points) < 0.9, axis=1)
    assert sorted(ordered.tolist()) == sorted(points[inside].tolist())
    to_outline, to_axle = gaps_at(
        ordered, begins, (-0.9, -0.9, size, count), x, y, yaw, BURGER_OUTLINE
    )
    outline = outline_at(np.array([x, y, yaw]))
    cloud = MultiPoint(points[inside])
    assert to_axle == pytest.approx(min(size, cloud.distance(Point(x, y))), abs=1e-9)
    reach = size - turning_radius(BURGER_OUTLINE)
    expected = outline.distance(cloud)
    if expected < reach:
        assert to_outline == pytest.approx(expected, abs=1e-9)
    else:
        assert to_outline >= reach


@pytest.mark.parametrize("barred", [NO_MOVE, BACKWARD])
@pytest.mark.parametrize(("width", "yaw"), [(0.26, 0.0), (0.28, 0.3), (0.30, -0.2)])
def test_the_search_costs_what_a_plain_one_costs(width: float, yaw: float, barred: int) -> None:
    slot = Slot(width, 0.5, 0.0, 0.2)
    points, start = slot.points, np.array([0.2, 0.0, yaw])
    clear, room, reach, step, prices = 0.021, 0.15, 0.4, (0.02, 48), (0.02, 0.02, 0.08)
    buckets = (-1.2, -1.2, 0.15, 16)
    ordered, begins = bucket_points(points, *buckets)
    moves = search_way(
        *(ordered, begins, buckets, start, BURGER_OUTLINE, clear, room),
        *(np.zeros((0, 2)), 0.3, np.zeros((0, 2)), 0.2, barred, reach, step, prices, 20_000),
    )
    kinds = moves.tolist()
    assert not kinds or kinds[0] != barred
    switches = sum(a != b for a, b in zip([-1, *kinds], kinds, strict=False))
    cost = 0.02 * len(kinds) + 0.08 * switches
    expected = plain_search(points, start, clear, room, reach, barred)
    assert cost == pytest.approx(expected, abs=1e-9)


def plain_search(
    points: NDArray[np.float64],
    start: Pose,
    clear: float,
    room: float,
    reach: float,
    barred: int,
) -> float:
    """The cost that ``search_way`` should come to, by dictionaries and all points."""

    def gap(x: float, y: float, turn: float) -> float:
        yaw = start[2] + math.radians(7.5 * turn)
        return float(outline_distance(points, x, y, yaw, BURGER_OUTLINE))

    heap = [(0.0, 0, float(start[0]), float(start[1]), 0, -1, gap(start[0], start[1], 0))]
    closed, number = set(), 0
    while heap:
        cost, _, x, y, turn, last, now = heapq.heappop(heap)
        offset = np.array([x - start[0], y - start[1]]) * math.sqrt(2.0) / 0.02
        cell = (*np.floor(offset + 0.5).astype(int).tolist(), turn % 48)
        if cell in closed or max(abs(cell[0]), abs(cell[1])) > math.ceil(reach * 2**0.5 / 0.02):
            continue
        closed.add(cell)
        if np.hypot(*(points - [x, y]).T).min() >= room:
            return cost
        yaw = start[2] + math.radians(7.5 * turn)
        for kind, along, turned in ((0, 0.02, 0), (1, -0.02, 0), (2, 0.0, 1), (3, 0.0, -1)):
            to = (x + along * math.cos(yaw), y + along * math.sin(yaw), turn + turned)
            if last == -1 and kind == barred:
                continue
            half_way = gap(to[0], to[1], turn + 0.5 * turned)
            least = min(gap(*to), half_way if turned else math.inf)
            if least >= min(clear, now) - 1e-6:
                number += 1
                price = 0.02 + (0.08 if kind != last else 0.0)
                heapq.heappush(heap, (cost + price, number, *to, kind, least))
    return math.nan


@given(seed=st.integers(0, 10_000), x=st.floats(-0.3, 0.3), y=st.floats(-0.3, 0.3))
@settings(max_examples=20, deadline=None)
def test_what_the_map_adds_equals_a_plain_list(seed: int, x: float, y: float) -> None:
    rng = np.random.default_rng(seed)
    log_odds = rng.choice([-5.0, 5.0], (30, 20), p=[0.3, 0.7]).astype(np.float32)
    cells = occupied_near(log_odds, (-0.1, -0.15, 0.01), 3.0, x, y, 0.08)
    padded = np.pad(log_odds > 3.0, 1)
    expected = []
    for i, j in np.argwhere(log_odds > 3.0).tolist():
        center = (-0.1 + (j + 0.5) * 0.01, -0.15 + (i + 0.5) * 0.01)
        around = padded[i, j + 1], padded[i + 2, j + 1], padded[i + 1, j], padded[i + 1, j + 2]
        if all(around) or max(abs(center[0] - x), abs(center[1] - y)) >= 0.09:
            continue
        if max(abs(center[0] - x), abs(center[1] - y)) < 0.07:
            assert center in [pytest.approx(cell) for cell in cells.tolist()]
        expected.append(center)
    assert all(cell in [pytest.approx(each) for each in expected] for cell in cells.tolist())
    points = rng.uniform(-0.1, 0.1, (5, 2))
    apart = np.hypot(*(cells[:, None] - points[None]).transpose(2, 0, 1))
    assert worth_minding(cells, points, 0.05).tolist() == (apart.min(axis=1) >= 0.05).tolist()
