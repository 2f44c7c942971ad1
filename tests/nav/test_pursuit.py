"""Going to and fro after one frontier ends."""

import pytest

from nav.pursuit import BASE_TIME, LEAST_PACE, Pursuit
from tests.nav.test_choices import viewpoint_at

PERIOD = 4.0


def time_after(pursuit: Pursuit, places: list[tuple[float, float]], growth: float = 0.0) -> float:
    """How long the robot is after places in turn until that is in vain, or an hour [s]."""
    time, area = 0.0, 10.0
    while time < 3600.0:
        x, y = places[round(time / PERIOD) % len(places)]
        pursuit.take_up(viewpoint_at(x, y, 1.0), time, area)
        if pursuit.is_in_vain(time):
            break
        time, area = time + PERIOD, area + growth
    return time


def test_two_sides_of_one_frontier_by_turns_are_in_vain_after_three_times_the_way() -> None:
    cost = viewpoint_at(6.0, 5.0, 1.0).cost
    longest = BASE_TIME + cost / LEAST_PACE
    time = time_after(Pursuit(), [(6.0, 5.0), (6.4, 5.0)])
    assert longest < time <= longest + PERIOD


def test_as_long_as_more_floor_is_seen_nothing_is_in_vain() -> None:
    assert time_after(Pursuit(), [(6.0, 5.0)], growth=0.1) >= 3600.0


def test_another_frontier_begins_anew() -> None:
    assert time_after(Pursuit(), [(6.0, 5.0), (8.0, 5.0)]) >= 3600.0
    pursuit = Pursuit()
    assert pursuit.take_up(viewpoint_at(6.0, 5.0, 1.0), 0.0, 10.0)
    assert not pursuit.take_up(viewpoint_at(6.4, 5.0, 1.0), 1.0, 10.0)
    assert pursuit.take_up(viewpoint_at(8.0, 5.0, 1.0), 2.0, 10.0)


@pytest.mark.parametrize("time", [0.0, 1e6])
def test_without_a_target_nothing_is_in_vain(time: float) -> None:
    assert not Pursuit().is_in_vain(time)
