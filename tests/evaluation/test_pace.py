"""Control periods begin when wall time says so, and lost time is made up for a little only."""

import pytest

from evaluation.pace import MOST_LAG, Pace
from mapping.errors import TestbedError


class Clock:
    """Wall time that passes when told to."""

    def __init__(self) -> None:
        self.now = 100.0

    def __call__(self) -> float:
        return self.now


def run_periods(pace: Pace, clock: Clock, number: int, work: float) -> None:
    """Wait as told, begin, then work so long [s]."""
    for _ in range(number):
        clock.now += pace.left()
        pace.begin()
        clock.now += work


@pytest.mark.parametrize("speed", [0.5, 1.0, 8.0])
def test_periods_take_their_time_whatever_is_done_in_them(speed: float) -> None:
    clock = Clock()
    pace = Pace(0.1, speed, clock)
    assert pace.left() == 0.0, "the first may begin at once"
    run_periods(pace, clock, 101, 0.4 * 0.1 / speed)
    began_last = clock.now - 0.4 * 0.1 / speed
    assert began_last - 100.0 == pytest.approx(10.0 / speed)
    assert pace.speed == pytest.approx(speed)
    assert not pace.is_too_slow


def test_a_long_period_is_made_up_for() -> None:
    clock = Clock()
    pace = Pace(0.1, clock=clock)
    run_periods(pace, clock, 10, 0.0)
    clock.now += 0.3
    run_periods(pace, clock, 10, 0.0)
    assert clock.now - 100.0 == pytest.approx(1.9)


def test_a_pause_that_was_asked_for_is_not_the_machines_fault() -> None:
    clock = Clock()
    pace = Pace(0.1, clock=clock)
    run_periods(pace, clock, 10, 0.0)
    clock.now += 60.0
    pace.restart()
    run_periods(pace, clock, 11, 0.0)
    assert clock.now == pytest.approx(100.0 + 0.9 + 60.0 + 1.0)
    assert not pace.is_too_slow


def test_what_is_lost_beyond_half_a_second_stays_lost() -> None:
    clock = Clock()
    pace = Pace(0.1, clock=clock)
    run_periods(pace, clock, 10, 0.0)
    clock.now += 60.0
    run_periods(pace, clock, 50, 0.0)
    assert clock.now - 160.0 > 50 * 0.1 - MOST_LAG - 0.21


def test_a_machine_that_is_too_slow_is_told_by_how_much() -> None:
    clock = Clock()
    pace = Pace(0.1, clock=clock)
    run_periods(pace, clock, 50, 0.2)
    assert pace.is_too_slow
    assert pace.speed == pytest.approx(0.5)


@pytest.mark.parametrize("speed", [0.0, -1.0, 1e6, float("nan"), float("inf")])
def test_a_speed_that_nobody_can_drive_at_is_refused(speed: float) -> None:
    with pytest.raises(TestbedError, match=r"speed: .*must be"):
        Pace(0.1, speed)
