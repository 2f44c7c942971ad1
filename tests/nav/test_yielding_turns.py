"""Whoever turns on the spot finds a robot that stands, or goes straight away from him."""

import math
from dataclasses import replace

from hypothesis import given
from hypothesis import strategies as st

from mapping.messages import Twist
from nav.movers import Mover
from nav.yielding import Yielding
from tests.nav.test_yielding import AHEAD, CONFIG, HERE, anywhere, nowhere, person
from tests.nav.walkers import moved


def test_it_turns_not_a_corner_into_one_who_stands_close_by() -> None:
    crossing, abeam = person(-1.2, 0.0, 0.8, 0.0), person(0.0, 0.3, 0.0, 0.16)

    def round_to_the_right(twist: Twist) -> bool:
        return twist.linear_x > 0.0 and twist.angular_z < 0.0

    def step(people: list[Mover]) -> Twist:
        return Yielding().limit(AHEAD, HERE, 0.0, people, round_to_the_right)

    assert step([crossing]).angular_z < 0.0
    assert step([crossing, abeam]) == Twist()
    assert Yielding().limit(Twist(angular_z=2.4), HERE, 0.0, [abeam], nowhere) == Twist()


@given(
    away=st.floats(0.7, 1.5),
    bearing=st.floats(-math.pi, math.pi),
    heading=st.floats(-math.pi, math.pi),
    speed=st.floats(0.3, 1.2),
    pace=st.floats(0.0, 1.2),
)
def test_whoever_turns_on_the_spot_finds_the_robot_standing_or_going_away(
    away: float, bearing: float, heading: float, speed: float, pace: float
) -> None:
    walker = person(
        away * math.cos(bearing),
        away * math.sin(bearing),
        speed * math.cos(heading),
        speed * math.sin(heading),
    )
    walker.pace = max(speed, pace)
    twist = Yielding().limit(AHEAD, HERE, 0.0, [walker], anywhere)
    turned = replace(walker, velocity=-walker.pace / away * walker.place)
    for k in range(11):
        pose = moved(HERE, twist, 0.05 * k)
        is_touched = math.dist(pose[:2], turned.at(0.05 * k)) < CONFIG.touch - 0.005
        is_nearer = math.dist(moved(pose, twist, 0.01)[:2], walker.place) < math.dist(
            pose[:2], walker.place
        )
        assert not (is_touched and is_nearer)


def test_straight_away_from_somebody_it_goes_but_not_from_among_his_feet() -> None:
    behind = person(-0.6, 0.0, 0.0, 0.8)
    behind.pace = 1.2
    assert Yielding().limit(AHEAD, HERE, 0.0, [behind], nowhere).linear_x > 0.0
    at_its_heels = person(-0.33, 0.0, 0.0, 0.16)
    assert Yielding().limit(AHEAD, HERE, 0.0, [at_its_heels], nowhere) == Twist()
