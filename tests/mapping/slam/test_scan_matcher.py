from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from mapping.errors import TestbedError
from mapping.geometry import Pose, between, compose
from mapping.messages import LaserScan
from mapping.slam.hit_field import HitField
from mapping.slam.scan_cloud import ScanCloud
from mapping.slam.scan_matcher import Match, MatcherConfig, match_scan
from tests.mapping.slam.fields import field_of
from tests.mapping.slam.rooms import cloud_of, corridor, post, random_room, scan_of

Array = NDArray[np.float64]
CONFIG = MatcherConfig()
SEEDS = st.integers(0, 300)
FINE_CELL, COARSE_CELL = 0.03, 0.05
CELLS = st.sampled_from([FINE_CELL, COARSE_CELL])
UNSURE = np.diag(np.square([0.1, 0.1, 0.1]))
"""Covariance of a prediction that is 10 cm and 6 degrees off, typically."""


def sigmas(covariance: Array) -> Array:
    return np.asarray(np.sqrt(np.diag(covariance)))


@given(seed=SEEDS, cell=CELLS, is_noisy=st.booleans())
@settings(max_examples=60)
def test_a_scan_matched_with_its_own_map_returns_its_pose(
    seed: int, cell: float, is_noisy: bool
) -> None:
    rng = np.random.default_rng(seed)
    walls = random_room(rng)
    pose = np.array([*rng.uniform(-0.3, 0.3, 2), rng.uniform(-np.pi, np.pi)])
    cloud = cloud_of(scan_of(walls, pose, rng if is_noisy else None), cell)
    # within the search window of three standard deviations, and so near that the three together
    # are no surprise
    predicted = compose(pose, rng.uniform(-0.19, 0.19, 3))
    match = match_scan(field_of([cloud], [pose], cell), cloud, predicted, UNSURE, CONFIG)
    apart = between(pose, match.pose)
    assert not match.refused
    assert np.hypot(*apart[:2]) < 0.1 * cell
    # a tenth of a cell at the end of a beam of the typical 1.5 m
    assert abs(apart[2]) < 0.1 * cell / 1.5
    assert np.all(sigmas(match.covariance) < sigmas(UNSURE))


@given(seed=SEEDS, cell=CELLS)
@settings(max_examples=20)
def test_a_pose_found_is_as_far_off_as_its_covariance_says(seed: int, cell: float) -> None:
    rng = np.random.default_rng(seed)
    walls = random_room(rng)
    poses = [np.array([*rng.uniform(-0.2, 0.2, 2), rng.uniform(-3.0, 3.0)]) for _ in range(6)]
    clouds = [cloud_of(scan_of(walls, pose, rng), cell) for pose in poses]
    field = field_of(clouds[1:], poses[1:], cell)
    predicted = poses[0] + rng.normal(0.0, 0.05, 3)
    match = match_scan(field, clouds[0], predicted, UNSURE, CONFIG)
    off = match.pose - poses[0]
    off[2] = np.angle(np.exp(1j * off[2]))
    # chi-square of three: 22 is exceeded by one in 15 000; five scans make a map with errors too,
    # and the lidar sees the edges of posts from elsewhere: twice that
    assert off @ np.linalg.solve(match.covariance, off) < 44.0


@given(seed=SEEDS, cell=CELLS)
@settings(max_examples=20)
def test_along_a_bare_corridor_the_prediction_stays_and_is_no_surer(seed: int, cell: float) -> None:
    rng = np.random.default_rng(seed)
    poses = [np.array([x, rng.normal(0.0, 0.1), rng.uniform(-3.0, 3.0)]) for x in (-1.0, -0.5, 0.0)]
    clouds = [cloud_of(scan_of(corridor(), pose, rng), cell) for pose in poses]
    predicted = poses[2] + rng.uniform(-1.0, 1.0, 3) * (0.1, 0.05, 0.05)
    covariance = np.diag(np.square([0.1, 0.05, 0.05]))
    field = field_of(clouds[:2], poses[:2], cell)
    match = match_scan(field, clouds[2], predicted, covariance, CONFIG)
    assert not match.refused
    # noisy walls are aslant by thousandths, so that a shift across moves a little along
    assert abs(match.pose[0] - predicted[0]) < 3e-3
    assert match.covariance[0, 0] >= covariance[0, 0] * (1.0 - 1e-3)
    assert abs(match.pose[1] - poses[2][1]) < 0.2 * cell
    assert abs(match.pose[2] - poses[2][2]) < 0.01
    assert np.all(sigmas(match.covariance)[1:] < 0.2 * sigmas(covariance)[1:])


@given(seed=SEEDS, cell=CELLS)
@settings(max_examples=20)
def test_in_the_middle_of_a_round_room_the_yaw_is_left_to_the_prediction(
    seed: int, cell: float
) -> None:
    rng = np.random.default_rng(seed)
    room = post(0.0, 0.0, 2.0, 720)
    poses = [np.array([0.0, 0.0, rng.uniform(-3.0, 3.0)]) for _ in range(3)]
    clouds = [cloud_of(scan_of(room, pose, rng), cell) for pose in poses]
    predicted = poses[2] + rng.uniform(-0.08, 0.08, 3)
    match = match_scan(field_of(clouds[:2], poses[:2], cell), clouds[2], predicted, UNSURE, CONFIG)
    assert not match.refused
    # the robot turns about the middle of the room, 3 cm from its own: only the prediction weighs
    # that small shift against the turn
    assert match.pose[2] == pytest.approx(predicted[2], abs=0.005)
    assert match.covariance[2, 2] >= 0.95 * UNSURE[2, 2]
    # the lidar, 3 cm behind the middle, swings with the yaw that is off by 0.08: 3 mm; as much
    # again as the maps were taken with it at other places
    assert np.hypot(*(match.pose - poses[2])[:2]) < 0.2 * cell + 0.006


@pytest.mark.parametrize("value", [np.nan, np.inf, 0.0, -np.inf])
def test_a_scan_that_met_nothing_is_refused(value: float) -> None:
    room = cloud_of(scan_of(random_room(np.random.default_rng(0)), np.zeros(3)))
    field = field_of([room], [np.zeros(3)], COARSE_CELL)
    empty = cloud_of(LaserScan(stamp=0.0, ranges=np.full(360, value, dtype=np.float32)))
    _assert_refused(field, empty)


def test_a_scan_that_nothing_in_the_map_explains_is_refused() -> None:
    walls = random_room(np.random.default_rng(0))
    cloud = cloud_of(scan_of(walls, np.zeros(3)))
    _assert_refused(field_of([], [], COARSE_CELL), cloud)
    # a map of something else: one short wall
    other = replace(cloud, surface=cloud.surface[:20])
    _assert_refused(field_of([other], [np.zeros(3)], COARSE_CELL), cloud)


def _assert_refused(field: HitField, cloud: ScanCloud) -> None:
    predicted = np.array([0.1, -0.2, 0.3])
    match = match_scan(field, cloud, predicted, UNSURE, CONFIG)
    assert match.refused
    assert np.array_equal(match.pose, predicted)
    assert np.array_equal(match.covariance, UNSURE)
    assert 0.0 <= match.score < CONFIG.least_score


def matches_here_and_there(seed: int, turn: Pose) -> tuple[Match, Match]:
    """A noisy scan matched with another one, and the same with both moved, seen from there."""
    rng = np.random.default_rng(seed)
    walls, cell = random_room(rng), FINE_CELL
    clouds = [cloud_of(scan_of(walls, np.zeros(3), rng), cell) for _ in range(2)]
    predicted = rng.uniform(-0.05, 0.05, 3)
    found = []
    for frame in (np.zeros(3), turn):
        field = field_of(clouds[:1], [frame], cell)
        match = match_scan(field, clouds[1], compose(frame, predicted), UNSURE, CONFIG)
        found.append(replace(match, pose=between(frame, match.pose)))
    return found[0], found[1]


@given(seed=SEEDS, quarters=st.integers(0, 3), cells=st.tuples(*[st.integers(-9, 9)] * 2))
@settings(max_examples=15)
def test_quarter_turns_and_whole_cells_turn_and_shift_a_match(
    seed: int, quarters: int, cells: tuple[int, int]
) -> None:
    turn = np.array([*(FINE_CELL * np.array(cells)), quarters * np.pi / 2.0])
    here, there = matches_here_and_there(seed, turn)
    # the field is the same but for rounding; a climb ends within a thousandth of a cell, and the
    # search, to which a point on the edge of two cells may be in either, starts it elsewhere
    assert np.hypot(*between(here.pose, there.pose)[:2]) < 0.1 * FINE_CELL
    assert there.score == pytest.approx(here.score, abs=1e-2)


def test_any_turn_of_the_map_turns_a_match_within_its_covariance() -> None:
    for seed in (*range(20), 566):
        here, there = matches_here_and_there(seed, np.array([0.213, -0.107, 1.0]))
        apart = between(here.pose, there.pose)
        # both saw the same: three sigmas would be far off
        assert apart @ np.linalg.solve(here.covariance, apart) < 9.0


def test_the_yaw_found_is_wrapped() -> None:
    walls = random_room(np.random.default_rng(3))
    pose = np.array([0.0, 0.0, np.pi - 0.01])
    cloud = cloud_of(scan_of(walls, pose))
    field = field_of([cloud], [pose], COARSE_CELL)
    match = match_scan(field, cloud, pose + [0.0, 0.0, 0.03 - 2.0 * np.pi], UNSURE, CONFIG)
    assert match.pose[2] == pytest.approx(pose[2], abs=1e-3)
    assert -np.pi < match.pose[2] <= np.pi


def test_what_the_scan_alone_asks_for_does_not_lean_on_the_prediction() -> None:
    walls = random_room(np.random.default_rng(4))
    cloud = cloud_of(scan_of(walls, np.zeros(3)))
    field = field_of([cloud], [np.zeros(3)], COARSE_CELL)
    sure = np.diag(np.square([1e-3, 1e-3, 5e-4]))
    predicted = np.array([0.01, 0.0, 0.0])
    match = match_scan(field, cloud, predicted, sure, CONFIG)
    # the climb's own prior, 5 cm wide, draws it by less than a fifth of the centimetre
    assert abs(match.seen[0]) < 2e-3
    assert match.pose[0] > 2.0 * abs(match.seen[0])


@pytest.mark.parametrize("name", MatcherConfig.__slots__)
@pytest.mark.parametrize("value", [0.0, -1.0, np.nan, np.inf])
def test_settings_that_make_no_matcher_are_told_by_name(name: str, value: float) -> None:
    with pytest.raises(TestbedError, match=name):
        replace(CONFIG, **{name: value})
