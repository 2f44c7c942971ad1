"""Seeing through a place, against a plain look at the direction of every beam."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from nav.movers_kernels import seen_through

ASIDE, MARGIN, SHARE = 0.10, 0.15, 0.04
ONE_DEGREE = math.radians(1.0)


def plain_seen_through(
    point: NDArray[np.float64],
    origin: NDArray[np.float64],
    bearing: float,
    increment: float,
    ranges: NDArray[np.float64],
) -> bool:
    """Asks every beam by its own direction; whatever none looked at was not seen through."""
    offset = point - origin
    distance, direction = math.hypot(*offset), math.atan2(offset[1], offset[0])
    turns = np.sign(increment) * (direction - bearing) % (2.0 * math.pi)
    step = abs(increment)
    middle = math.floor(turns / step + 0.5)
    span = max(1, math.ceil(min(ASIDE / (distance * step), len(ranges) / 4.0)))
    beams = np.arange(len(ranges)) * step
    for looked_at in np.arange(middle - span, middle + span + 1) * step:
        apart = np.abs((beams - looked_at + math.pi) % (2.0 * math.pi) - math.pi)
        beside = np.flatnonzero(apart <= 0.5 * step + 1e-9)
        if len(beside) == 0:
            return False
        if not ranges[beside[0]] > distance + MARGIN + SHARE * distance:
            return False
    return True


def seen(
    points: NDArray[np.float64],
    ranges: NDArray[np.float64],
    origin: tuple[float, float] = (0.0, 0.0),
    bearing: float = 0.0,
    increment: float = ONE_DEGREE,
) -> list[int]:
    """How many of one scan, or of some alike, saw through each point."""
    rows = np.atleast_2d(ranges)
    count = len(rows)
    counts = seen_through(
        points,
        np.tile(np.array(origin), (count, 1)),
        np.full(count, bearing),
        np.full(count, increment),
        rows,
        ASIDE,
        MARGIN,
        SHARE,
    )
    return [int(each) for each in counts]


@given(
    seed=st.integers(0, 10_000),
    beams=st.sampled_from([360, 270, 90]),
    # what a robot that turns at 2.4 rad/s makes of a degree: a scan overlaps itself, or has a gap
    stretch=st.floats(0.92, 1.08),
    sign=st.sampled_from([1.0, -1.0]),
    bearing=st.floats(-7.0, 7.0),
)
@settings(max_examples=80)
def test_it_equals_a_plain_look_at_the_direction_of_every_beam(
    seed: int, beams: int, stretch: float, sign: float, bearing: float
) -> None:
    rng = np.random.default_rng(seed)
    increment = sign * stretch * ONE_DEGREE
    # mostly long beams, some short, some that met nothing and a few that failed
    ranges = rng.choice([3.4, 2.0, 1.0, math.inf, math.nan], beams, p=[0.7, 0.1, 0.02, 0.17, 0.01])
    origin = rng.uniform(-3.0, 3.0, 2)
    points = origin + rng.uniform(-2.0, 2.0, (40, 2))
    expected = [plain_seen_through(each, origin, bearing, increment, ranges) for each in points]
    found = seen(points, ranges, (origin[0], origin[1]), bearing, increment)
    assert found == [int(each) for each in expected]
    if beams == 360:
        assert 0 < sum(found) < len(found), "an example that tells both"


def test_every_scan_counts_for_itself() -> None:
    ranges = np.full((5, 360), 3.0)
    ranges[1, 90] = 1.0
    ranges[3, 91] = math.nan
    points = np.array([[0.0, 1.0], [0.0, -1.0]])
    assert seen(points, ranges) == [3, 5]


@pytest.mark.parametrize("told", [math.nan, 1.18])
def test_one_beam_beside_the_place_that_failed_or_went_hardly_farther_is_enough_to_doubt(
    told: float,
) -> None:
    # 1.19 m is the least: 1 m, the margin and the share; 10 cm aside are 6 beams at 1 m
    for beam, expected in ((90 + 6, 0), (90 + 7, 1)):
        ranges = np.full(360, 3.0)
        ranges[beam] = told
        assert seen(np.array([[0.0, 1.0]]), ranges) == [expected]


def test_beams_that_met_nothing_saw_through() -> None:
    assert seen(np.array([[1.0, 0.5]]), np.full(360, math.inf)) == [1]


def test_across_the_seam_of_a_whole_turn_the_last_beam_is_beside_the_first() -> None:
    ahead = np.array([[1.0, 0.0]])
    ranges = np.full(360, 3.0)
    assert seen(ahead, ranges) == [1]
    ranges[-3] = 1.0
    assert seen(ahead, ranges) == [0]


def test_a_scan_that_does_not_look_all_round_tells_nothing_beyond_its_ends() -> None:
    ranges = np.full(180, 3.0)
    angles = np.radians([-4.0, 4.0, 10.0, 90.0, 172.0, 176.0, 270.0])
    points = np.column_stack((np.cos(angles), np.sin(angles)))
    assert seen(points, ranges) == [0, 0, 1, 1, 1, 0, 0]


def test_what_a_scan_missed_because_the_robot_turned_back_meanwhile_was_not_seen() -> None:
    """At -1.6 rad/s the last beam ends 18 degrees short of the first."""
    increment = ONE_DEGREE - 1.6 * 0.2 / 360
    gap = np.radians([-9.0, -4.0])
    inside = np.radians([20.0, -40.0])
    points = np.array([[math.cos(each), math.sin(each)] for each in (*gap, *inside)])
    assert seen(points, np.full(360, 3.0), increment=increment) == [0, 0, 1, 1]


def test_a_place_at_the_sensor_itself_does_not_divide_by_zero() -> None:
    assert seen(np.zeros((1, 2)), np.full(360, 3.0)) == [1]
