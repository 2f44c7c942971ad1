"""Small frontiers wait, never more than a share of the floor, and never for ever."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mapping.errors import TestbedError
from nav.frontier import Frontier
from nav.put_off import PutOff, PutOffConfig
from nav.viewpoint import Viewpoint

FLOOR = 100.0
MAY_WAIT = PutOffConfig().share * FLOOR


def viewpoint_at(x: float, gain: float) -> Viewpoint:
    frontier = Frontier(cells=np.zeros((4, 2), dtype=np.int64), middle=np.array([x, 0.0]), size=0.2)
    return Viewpoint(place=np.array([x, 1.0]), frontier=frontier, gain=gain, cost=1.0)


def gains_of(viewpoints: list[Viewpoint]) -> list[float]:
    return [item.gain for item in viewpoints]


def test_the_smallest_wait_and_the_large_ones_do_not() -> None:
    crumbs, rooms = [viewpoint_at(1.0, 0.5), viewpoint_at(2.0, 0.8)], [viewpoint_at(9.0, 4.0)]
    assert PutOff().worth_now([*crumbs, *rooms], FLOOR) == rooms


@given(gains=st.lists(st.floats(0.01, 6.0), min_size=1, max_size=12))
def test_what_waits_is_no_more_than_the_share_and_never_all(gains: list[float]) -> None:
    everything = [viewpoint_at(2.0 * k, gain) for k, gain in enumerate(gains)]
    now = PutOff().worth_now(everything, FLOOR)
    assert now
    waiting = sum(gains) - sum(gains_of(now))
    assert waiting <= MAY_WAIT + 1e-9
    assert not waiting or max(set(gains) - set(gains_of(now)), default=0.0) <= min(gains_of(now))


def test_what_may_hide_a_room_does_not_wait_however_large_the_floor() -> None:
    door, room = viewpoint_at(1.0, 1.2), viewpoint_at(9.0, 4.0)
    assert PutOff().worth_now([door, room], 10.0 * FLOOR) == [door, room]


def test_when_nothing_else_is_left_all_are_worth_going_to_and_stay_so() -> None:
    put_off, crumb = PutOff(), viewpoint_at(1.0, 0.5)
    assert put_off.worth_now([crumb, viewpoint_at(9.0, 4.0)], FLOOR) != [crumb]
    assert put_off.worth_now([crumb], FLOOR) == [crumb]
    both = [crumb, viewpoint_at(9.0, 4.0)]
    assert put_off.worth_now(both, FLOOR) == both, "no going back and forth"


def test_what_was_put_off_waits_while_others_come_and_go() -> None:
    """Else two frontiers about as large would be put off by turns."""
    put_off = PutOff()
    first, second, room = viewpoint_at(1.0, 0.8), viewpoint_at(5.0, 0.9), viewpoint_at(9.0, 4.0)
    assert put_off.worth_now([first, second, room], FLOOR / 2.0) == [second, room]
    shrunk = viewpoint_at(5.0, 0.75)
    assert put_off.worth_now([first, shrunk, room], FLOOR / 2.0) == [shrunk, room]


def test_one_that_turned_out_larger_waits_no_longer() -> None:
    put_off, room = PutOff(), viewpoint_at(9.0, 4.0)
    assert put_off.worth_now([viewpoint_at(1.0, 1.0), room], FLOOR) == [room]
    grown = viewpoint_at(1.2, 3.5)
    assert put_off.worth_now([grown, room], FLOOR) == [grown, room]


def test_all_viewpoints_of_a_frontier_wait_together_by_the_one_that_shows_most() -> None:
    frontier = viewpoint_at(1.0, 0.1).frontier
    small, large = (
        Viewpoint(place=np.array([1.0, 1.0]), frontier=frontier, gain=gain, cost=1.0)
        for gain in (0.1, 3.5)
    )
    assert PutOff().worth_now([small, large, viewpoint_at(9.0, 4.0)], FLOOR)[:2] == [small, large]


def test_without_a_share_nothing_waits() -> None:
    everything = [viewpoint_at(1.0, 0.01), viewpoint_at(9.0, 4.0)]
    assert PutOff(PutOffConfig(share=0.0)).worth_now(everything, FLOOR) == everything


@pytest.mark.parametrize("wrong", [{"share": -0.1}, {"share": 1.1}, {"grown": 0.9}, {"most": -1.0}])
def test_figures_that_are_no_share_or_no_growth_are_refused(wrong: dict[str, float]) -> None:
    with pytest.raises(TestbedError):
        PutOffConfig(**wrong)
