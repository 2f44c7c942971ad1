"""Legs: which points are of one, and which legs are of one body."""

import math

import numpy as np
import pytest

from nav.legs import LEG_BEHIND, parted
from nav.movers import Mover, Movers
from tests.nav.scans import Room, views_of
from tests.nav.test_movers import (
    EMPTY,
    HALL,
    POSE_ERROR,
    fresh,
    seen_after,
    standing,
    walk,
    with_leg,
)


def test_a_thing_of_one_beam_may_have_been_missed_before() -> None:
    """A chair's leg 2.5 m away lies between two beams as often as not."""
    one, other = with_leg(EMPTY, 90, 90, 2.5), with_leg(EMPTY, 94, 94, 2.5)
    assert seen_after(EMPTY, one).known == []
    assert seen_after(EMPTY, np.minimum(one, other)).known == []
    assert len(seen_after(EMPTY, with_leg(EMPTY, 90, 91, 2.5)).known) == 1


def test_two_legs_of_chairs_one_behind_the_other_are_not_one_leg() -> None:
    now = with_leg(with_leg(EMPTY, 90, 90, 2.2), 91, 91, 2.5)
    assert seen_after(EMPTY, now).known == []


def test_a_leg_straight_ahead_is_met_by_the_first_and_the_last_beam() -> None:
    now = with_leg(with_leg(EMPTY, 0, 0, 2.0), 359, 359, 2.0)
    (mover,) = seen_after(EMPTY, now).known
    assert mover.place == pytest.approx([2.0 + LEG_BEHIND, 0.0], abs=0.02)


def test_two_legs_in_stride_are_one_thing_and_two_people_are_two() -> None:
    stride = with_leg(with_leg(EMPTY, 80, 83, 2.0), 97, 100, 2.0)
    assert len(seen_after(EMPTY, stride).known) == 1
    people = with_leg(with_leg(EMPTY, 70, 73, 2.0), 110, 113, 2.0)
    assert len(seen_after(EMPTY, people).known) == 2


def test_the_middle_lies_between_the_legs_however_little_one_hides_of_the_other() -> None:
    stride = with_leg(with_leg(EMPTY, 79, 83, 1.3), 90, 91, 1.4)
    (mover,) = seen_after(EMPTY, stride).known
    legs = [
        (away + LEG_BEHIND) * np.array([math.cos(angle), math.sin(angle)])
        for away, angle in ((1.3, math.radians(81.0)), (1.4, math.radians(90.5)))
    ]
    assert mover.place == pytest.approx(np.mean(legs, axis=0), abs=0.01)


def test_two_who_pass_each_other_stay_two() -> None:
    """Half a metre apart they would be one, did nobody know where each was going."""
    rng = np.random.default_rng(2)
    up = walk(np.array([2.0, 2.6]), np.array([0.0, 0.6]), 1.6)
    down = walk(np.array([2.4, 4.6]), np.array([0.0, -0.6]), 1.6)
    movers, apart = Movers(), []
    for view in views_of(Room(walls=HALL, legs=(up, down)), standing(5.0), rng, POSE_ERROR):
        movers.update(view)
        known = fresh(movers, view)
        if view.stamp > 2.4:
            apart.append(float(np.hypot(*(up(view.stamp) - down(view.stamp)))))
            assert len(known) == 2, f"at {view.stamp:.1f} s, {apart[-1]:.2f} m apart"
    assert min(apart) < 0.5


def test_nobody_has_a_third_leg_while_another_stands_there_with_one() -> None:
    """Two beside each other: a leg that strides to the first one's side is still the second's."""
    expected = np.array([[0.0, 0.0], [0.5, 0.0]])
    legs = np.array([[-0.1, 0.0], [0.1, 0.0], [0.22, 0.0], [0.6, 0.0]])
    first, second = parted(legs, expected, gate=0.3)
    assert first.tolist() == legs[:2].tolist()
    assert second.tolist() == legs[2:].tolist()


def test_legs_that_nobody_is_left_for_are_of_the_nearest() -> None:
    expected = np.array([[0.0, 0.0], [0.5, 0.0]])
    legs = np.array([[-0.1, 0.0], [0.0, 0.1], [0.1, 0.0], [0.4, 0.0], [0.6, 0.0]])
    first, second = parted(legs, expected, gate=0.3)
    assert len(first) == 3
    assert len(second) == 2


def test_who_turns_on_the_spot_keeps_the_pace_for_a_while() -> None:
    mover = Mover(
        place=np.zeros(2), velocity=np.array([0.9, 0.0]), stamp=0.0, sightings=9, pace=0.9
    )
    movers = Movers()
    movers.known = [mover]
    for k in range(1, 8):
        movers._follow(0.2 * k, [np.array([0.18 - 0.18 * k, 0.0])])
        assert 0.6 < mover.pace < 1.3
    assert mover.velocity[0] < -0.5
