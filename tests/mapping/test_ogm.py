import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from mapping.compare import score_map
from mapping.errors import TestbedError
from mapping.geometry import compose
from mapping.grid import FREE, OCCUPIED, GridConfig
from mapping.messages import LaserScan, Odometry, Twist
from mapping.ogm import BEHIND_CELLS, WIDEST_WEDGE, Ogm, OgmConfig
from mapping.scan_polygon import AGREE_SIGMAS, AGREE_SLOPE, STRIP_HALF_WIDTH
from mapping.sensor_model import SICK_LMS, range_sigma
from tests.mapping.arena import arena_truth, circling, drive, scan_at, standing

COARSE = GridConfig(resolution=0.05, origin=(-4.0, -4.0), rows=160, columns=160, grows=False)
STILL = [Odometry(stamp=0.0, pose_odom=np.zeros(3), twist=Twist())]


def still(stamp: float) -> list[Odometry]:
    return [Odometry(stamp=stamp, pose_odom=np.zeros(3), twist=Twist())]


def slow_free_space(
    origin: NDArray[np.float64], angles: NDArray[np.float64], scan: LaserScan, edge: float
) -> shapely.Geometry:
    """What a scan from one place saw free, as the mapper's words have it, piece by piece."""
    config, pieces = OgmConfig(), []
    ranges = np.asarray(scan.ranges, dtype=np.float64)
    told = [bool(r >= scan.range_min) for r in ranges]
    length = np.where(told, np.minimum(ranges, 3.5), 0.0)
    sigma = range_sigma(length)
    blur = np.maximum(sigma - config.sharp_cells * edge, 0.0)
    free = np.maximum(length - config.clear_sigmas * blur, 0.0)
    ray = np.column_stack((np.cos(angles), np.sin(angles)))
    reached = np.zeros(len(ranges))
    for i in range(len(ranges)):
        j = (i + 1) % len(ranges)
        if not (told[i] and told[j]):
            continue
        width = np.sin(angles[j] - angles[i])
        tolerance = AGREE_SIGMAS * np.hypot(sigma[i], sigma[j])
        tolerance += AGREE_SLOPE * width * min(length[i], length[j])
        same = (ranges[i] <= 3.5) == (ranges[j] <= 3.5)
        agree = same and abs(length[i] - length[j]) <= tolerance
        a, b = (free[i], free[j]) if agree else (min(free[i], free[j]),) * 2
        reached[i], reached[j] = max(reached[i], a), max(reached[j], b)
        pieces.append(shapely.Polygon([origin, origin + a * ray[i], origin + b * ray[j]]))
    for i in np.flatnonzero(told):
        side = STRIP_HALF_WIDTH * edge * np.array([-ray[i, 1], ray[i, 0]])
        near, far = origin + reached[i] * ray[i], origin + free[i] * ray[i]
        pieces.append(shapely.Polygon([near - side, far - side, far + side, near + side]))
    # snapped to a nanometre: without a grid GEOS now and then loses a piece among slivers
    return shapely.union_all([piece.buffer(0) for piece in pieces], grid_size=1e-9)


def slow_update(
    log_odds: NDArray[np.float32], scan: LaserScan, pose: NDArray[np.float64]
) -> tuple[NDArray[np.float32], NDArray[np.bool_]]:
    """The map after a scan, and which cells lie clear of the edge of what was seen free."""
    config, edge = OgmConfig(), COARSE.resolution
    sensor = compose(pose, config.lidar_pose_base)
    angles = sensor[2] + scan.angles
    space = slow_free_space(sensor[:2], angles, scan, edge)
    y, x = (np.indices(log_odds.shape) + 0.5) * edge - 4.0
    passed = shapely.contains_xy(space, x, y)
    after = np.where(passed, np.maximum(log_odds - config.miss, config.lowest), log_odds)
    ends, gains = [], []
    for angle, r in zip(angles, scan.ranges.astype(float), strict=True):
        if scan.range_min <= r <= 3.5:
            reach = r + BEHIND_CELLS * edge
            ends.append(sensor[:2] + reach * np.array([np.cos(angle), np.sin(angle)]))
            gains.append(config.hit * min(1.0, edge / float(range_sigma(r))))
    hits = [(end, gain) for end, gain in zip(ends, gains, strict=True)]
    for k, end in enumerate(ends):
        other = (k + 1) % len(ends)
        apart = ends[other] - end
        pieces = int(np.ceil(np.max(np.abs(apart)) / edge))
        if np.hypot(*apart) <= config.link:
            gain = min(gains[k], gains[other])
            hits += [(end + apart * s / pieces, gain) for s in range(1, pieces)]
    for end, gain in hits:
        column, row = np.floor((end + 4.0) / edge).astype(int)
        if 0 <= row < 160 and 0 <= column < 160:
            value = min(float(log_odds[row, column]) + gain, config.highest)
            after[row, column] = max(after[row, column], value)
    clear = shapely.distance(space.boundary, shapely.points(x, y)) > 1e-6
    return after.astype(np.float32), clear


@given(seed=st.integers(0, 10_000))
@settings(max_examples=12, deadline=None)
def test_random_scans_equal_the_slow_reference_cell_by_cell(seed: int) -> None:
    rng = np.random.default_rng(seed)
    smooth = np.interp(np.arange(360), np.arange(0, 361, 12), rng.uniform(0.3, 3.6, 31))
    ranges = np.where(rng.random(360) < 0.15, rng.choice([0.0, np.nan, np.inf], 360), smooth)
    scan = LaserScan(stamp=0.0, ranges=ranges.astype(np.float32))
    pose = np.array([*rng.uniform(-1.5, 1.5, 2), rng.uniform(-3.0, 3.0)])
    mapper = Ogm(grid=COARSE)
    mapper.grid.log_odds[:] = rng.uniform(-6.5, 7.0, COARSE.rows * COARSE.columns).reshape(160, 160)
    before = mapper.grid.log_odds.copy()
    mapper.update(scan, [Odometry(stamp=0.0, pose_odom=pose, twist=Twist())])
    expected, clear = slow_update(before, scan, pose)
    different = clear & ~np.isclose(mapper.grid.log_odds, expected, atol=1e-4)
    # a reading on the very edge of a cell may be rounded into its neighbour
    assert np.count_nonzero(different) <= 2


def test_a_person_who_walked_away_is_gone_within_a_second_however_long_he_stood() -> None:
    mapper = Ogm()
    room = scan_at(0.0, standing()).ranges
    with_person = room.copy()
    with_person[-8:], with_person[:8] = 1.0, 1.0  # a leg 1 m ahead of the lidar
    for k in range(50):
        mapper.update(LaserScan(stamp=0.2 * k, ranges=with_person), still(0.2 * k))
    row, column = mapper.grid.world_to_cell([0.972, 0.0])
    assert mapper.grid.states()[row, column] == OCCUPIED
    for k in range(50, 55):
        mapper.update(LaserScan(stamp=0.2 * k, ranges=room), still(0.2 * k))
    cells = mapper.grid.states()[row - 15 : row + 16, column - 8 : column + 8]
    assert not np.any(cells == OCCUPIED)


def test_a_person_who_comes_is_on_the_map_within_a_second() -> None:
    mapper = Ogm()
    room = scan_at(0.0, standing()).ranges
    for k in range(50):
        mapper.update(LaserScan(stamp=0.2 * k, ranges=room), still(0.2 * k))
    room[0] = 0.8
    for k in range(50, 55):
        mapper.update(LaserScan(stamp=0.2 * k, ranges=room), still(0.2 * k))
    assert mapper.grid.states()[tuple(mapper.grid.world_to_cell([0.772, 0.0]))] == OCCUPIED


def test_a_scan_taken_while_spinning_draws_straight_walls() -> None:
    def spinning(stamps: NDArray[np.float64]) -> NDArray[np.float64]:
        return np.column_stack((0.3 + 0.0 * stamps, 0.0 * stamps, 2.0 * stamps))

    mapper = Ogm()
    for new, messages in drive(spinning, 4.0):
        mapper.update(new, messages)
    drawn = mapper.grid.cell_to_world(np.argwhere(mapper.grid.states() == OCCUPIED))
    right_wall = drawn[(drawn[:, 0] > 1.5) & (np.abs(drawn[:, 1]) < 1.2)]
    # the true wall is at x = 2; from one pose for the whole scan it would be off by 0.4 rad
    assert len(right_wall) > 150
    assert np.all(np.abs(right_wall[:, 0] - 2.0) < 0.03)


def test_a_drive_with_the_datasheets_noise_makes_a_sharp_map() -> None:
    pose_at = circling()
    mapper = Ogm()
    for new, messages in drive(pose_at, 40.0, np.random.default_rng(0)):
        mapper.update(new, messages)
    scores = score_map(mapper.grid, arena_truth())
    # what the whole testbed must reach in turtlebot3_world, from true poses
    assert scores.f1_5cm is not None
    assert scores.f1_5cm >= 0.95
    assert scores.coverage is not None
    assert scores.coverage >= 0.97
    assert scores.free_iou is not None
    assert scores.free_iou >= 0.96


def test_a_far_wall_that_a_precise_lidar_sees_once_is_drawn_as_strongly_as_a_near_one() -> None:
    ranges = np.full(360, np.inf, dtype=np.float32)
    ranges[0], ranges[90] = 6.0, 1.0
    seen = LaserScan(stamp=0.0, ranges=ranges, range_max=81.0)
    config = OgmConfig(max_range=81.0, range_noise=SICK_LMS, lidar_pose_base=(0.0, 0.0, 0.0))
    mapper = Ogm(config, grid=GridConfig(resolution=0.05))
    mapper.update(seen, STILL)
    ahead, left = mapper.grid.world_to_cell([[6.01, 0.0], [0.0, 1.01]])
    assert mapper.grid.log_odds[tuple(ahead)] == pytest.approx(config.hit)
    assert mapper.grid.log_odds[tuple(left)] == pytest.approx(config.hit)


def test_a_lidar_that_reaches_80_m_frees_no_more_without_a_return_than_an_lds_01() -> None:
    nothing = LaserScan(stamp=0.0, ranges=np.full(360, np.inf, dtype=np.float32), range_max=81.0)
    config = OgmConfig(max_range=81.0, range_noise=SICK_LMS)
    mapper = Ogm(config, grid=GridConfig(resolution=0.05))
    mapper.update(nothing, STILL)
    y, x = np.nonzero(mapper.grid.log_odds)
    reached = np.hypot(*(mapper.grid.cell_to_world(np.column_stack((y, x))) + [0.032, 0.0]).T)
    assert reached.max() == pytest.approx(3.5, abs=0.05), "a cell's edge"


def test_the_grid_grows_no_more_than_the_scan_needs() -> None:
    mapper = Ogm()
    mapper.update(scan_at(0.0, standing()), STILL)
    left, right, bottom, top = mapper.grid.extent
    assert (left, right, bottom, top) == pytest.approx((-2.56, 2.56, -2.56, 2.56))
    assert np.any(mapper.grid.states() == OCCUPIED) or mapper.updates == 1


def test_a_wall_seen_twice_is_occupied_and_the_floor_before_it_free() -> None:
    mapper = Ogm()
    for k in range(3):
        mapper.update(scan_at(0.2 * k, standing()), still(0.2 * k))
    states = mapper.grid.states()
    assert states[tuple(mapper.grid.world_to_cell([0.5, 0.0]))] == FREE
    assert states[tuple(mapper.grid.world_to_cell([0.0, 0.351]))] == OCCUPIED


def test_beams_clockwise_make_the_same_map() -> None:
    ahead = scan_at(0.0, standing())
    back = LaserScan(
        stamp=0.0,
        ranges=ahead.ranges[::-1].copy(),
        angle_min=ahead.angle_max,
        angle_increment=-ahead.angle_increment,
        time_increment=0.0,
    )
    one, other = Ogm(), Ogm()
    one.update(ahead, STILL)
    other.update(back, STILL)
    assert np.allclose(one.grid.log_odds, other.grid.log_odds, atol=1e-5)


@pytest.mark.parametrize(
    "ranges",
    [
        np.empty(0),
        np.zeros(360),
        np.full(360, np.nan),
        np.full(360, -np.inf),
    ],
)
def test_a_scan_that_tells_nothing_is_dropped(ranges: NDArray[np.float64]) -> None:
    mapper = Ogm()
    mapper.update(LaserScan(stamp=0.0, ranges=ranges.astype(np.float32)), STILL)
    assert (mapper.updates, mapper.scans_dropped) == (0, 1)
    assert not mapper.grid.log_odds.any()


def test_a_scan_of_one_beam_is_drawn() -> None:
    mapper = Ogm()
    mapper.update(LaserScan(stamp=0.0, ranges=np.array([1.0], dtype=np.float32)), STILL)
    assert mapper.updates == 1
    beside = mapper.grid.world_to_cell([[0.5, -0.005], [0.5, 0.005]])  # the beam runs between
    assert mapper.grid.log_odds[tuple(beside.T)].min() < 0.0


def test_broken_messages_do_no_harm() -> None:
    mapper = Ogm()
    good = scan_at(0.0, standing())
    mapper.update(None, [])
    mapper.update(good, [])  # no odometry yet
    nan = Odometry(stamp=0.1, pose_odom=np.full(3, np.nan), twist=Twist())
    mapper.update(LaserScan(stamp=0.2, ranges=good.ranges), [nan])
    mapper.update(LaserScan(stamp=0.4, ranges=good.ranges), still(0.4))
    mapper.update(LaserScan(stamp=0.3, ranges=good.ranges), still(0.3))  # back in time
    mapper.update(LaserScan(stamp=np.nan, ranges=good.ranges), still(0.5))
    mapper.update(LaserScan(stamp=9.0, ranges=good.ranges), still(0.6))  # far from odometry
    assert (mapper.updates, mapper.scans_dropped) == (1, 5)
    assert np.isfinite(mapper.grid.log_odds).all()


def test_the_widest_wedge_is_wider_than_beams_of_a_fast_turn() -> None:
    degree = np.radians(1.0)
    assert degree + 2.84 * 0.2 / 360 < WIDEST_WEDGE * degree


@pytest.mark.parametrize(
    "broken",
    [{"miss": 0.0}, {"hit": np.nan}, {"link": -1.0}, {"clear_sigmas": np.inf}, {"lowest": 1.0}],
)
def test_settings_that_make_no_mapper_are_told(broken: dict[str, float]) -> None:
    with pytest.raises(TestbedError, match=next(iter(broken))):
        OgmConfig(**broken)
