"""Odometry that slips by more than it says: a scan that does not fit is looked for farther away."""

from collections.abc import Callable

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from mapping.geometry import between, compose, inverse
from mapping.mapper import Mapper
from mapping.messages import Odometry
from mapping.slam.graph_slam import GraphSlam
from mapping.slam.hit_field import HitField
from mapping.slam.scan_match import ScanMatch
from mapping.slam.scan_matcher import MatcherConfig, match_scan, match_twice
from tests.mapping.slam.fields import field_of
from tests.mapping.slam.rooms import (
    RING_WAY,
    Period,
    cloud_of,
    drive,
    fed,
    random_room,
    ring,
    scan_of,
)

CELL = 0.03
CONFIG = MatcherConfig()
SURE = np.diag(np.square([0.02, 0.02, 0.05]))
"""Covariance of a prediction that is believed to be 2 cm and 3 degrees off, typically."""
SEEDS = st.integers(0, 300)


def field_seen(walls: np.ndarray) -> HitField:
    """The field of a scan from the origin."""
    return field_of([cloud_of(scan_of(walls, np.zeros(3)), CELL)], [np.zeros(3)], CELL)


@given(seed=SEEDS, slip=st.floats(0.19, 0.24), sign=st.sampled_from([-1.0, 1.0]))
@settings(max_examples=40)
def test_a_scan_far_outside_what_was_predicted_is_found(
    seed: int, slip: float, sign: float
) -> None:
    rng = np.random.default_rng(seed)
    walls = random_room(rng)
    pose = np.array([*rng.uniform(-0.1, 0.1, 2), rng.uniform(-0.2, 0.2)])
    cloud = cloud_of(scan_of(walls, pose, rng), CELL)
    predicted = compose(pose, [0.03, -0.02, sign * slip])
    match = match_twice(field_seen(walls), cloud, predicted, SURE, CONFIG)
    apart = between(pose, match.pose)
    assert not match.refused
    # the map is one scan from elsewhere: two cells
    assert np.hypot(*apart[:2]) < 2.0 * CELL
    assert abs(apart[2]) < 0.03


@given(seed=SEEDS)
@settings(max_examples=40)
def test_in_another_room_the_second_look_finds_no_more_than_the_first(seed: int) -> None:
    rng = np.random.default_rng(seed)
    field = field_seen(random_room(rng))
    cloud = cloud_of(scan_of(random_room(rng), np.zeros(3), rng), CELL)
    first = match_scan(field, cloud, np.zeros(3), SURE, CONFIG)
    second = match_twice(field, cloud, np.zeros(3), SURE, CONFIG)
    is_alike = second.score >= CONFIG.sure_score  # rooms of one size and a few posts may be
    assert is_alike or np.array_equal(first.pose, second.pose)
    assert is_alike or first.refused == second.refused


def slipped(periods: list[Period], at: list[int], by: list[float]) -> list[Period]:
    """The same drive, with the odometry turned by so much [rad] at the beginning of some scans."""
    turned: list[Period] = []
    frame = np.zeros(3)
    for number, (scan, odometry) in enumerate(periods):
        if number in at:
            place = odometry[0].pose_odom
            slip = compose(compose(place, [0.0, 0.0, by[at.index(number)]]), inverse(place))
            frame = compose(frame, slip)
        moved = [
            Odometry(stamp=each.stamp, pose_odom=compose(frame, each.pose_odom), twist=each.twist)
            for each in odometry
        ]
        turned.append((scan, moved))
    return turned


@pytest.mark.parametrize("make", [ScanMatch, GraphSlam])
def test_wheels_that_slip_in_a_turn_do_not_turn_the_map(make: Callable[..., Mapper]) -> None:
    run = drive(ring(), RING_WAY[:3], np.random.default_rng(5))
    count = len(run.periods)
    periods = slipped(run.periods, [count // 3, 2 * count // 3], [0.25, -0.25])
    mapper = fed(make(start_pose_map=run.start), periods)
    off = between(run.truth, mapper.trajectory.poses)
    # the scan in which they slip is bent itself
    assert np.max(np.abs(off[-20:, 2])) < 0.02
    assert np.max(np.hypot(off[-20:, 0], off[-20:, 1])) < 0.05
