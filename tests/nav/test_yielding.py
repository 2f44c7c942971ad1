"""Keeping out of people's way: slow, stand, step aside; and never running into anybody."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

from mapping.errors import TestbedError
from mapping.geometry import Pose
from mapping.grid import OccupancyGrid
from mapping.messages import Twist
from nav.movers import LEAST_SCANS, Mover
from nav.safety import Safety
from nav.yielding import Yielding, YieldingConfig
from tests.nav.scans import PERIOD
from tests.nav.walkers import KNOWN_WELL, Walker, moved, random_walker, speed_at_touch

HERE = np.zeros(3)
AHEAD = Twist(linear_x=0.2)
CONFIG = YieldingConfig()

OWN_MOTION = 0.02
"""A robot slower than this towards a leg that it touches stands [m/s]."""


def anywhere(twist: Twist) -> bool:
    return True


def nowhere(twist: Twist) -> bool:
    return False


def person(x: float, y: float, vx: float, vy: float, sightings: int = KNOWN_WELL) -> Mover:
    return Mover(
        place=np.array([x, y]), velocity=np.array([vx, vy]), stamp=0.0, sightings=sightings
    )


def nearest_ever(twist: Twist, walker: Mover, driven_for: float) -> float:
    """Least distance of centres over the next seconds: by small steps, not by arcs."""
    pose, gaps = HERE, []
    for k in range(round(CONFIG.horizon / 0.01)):
        gaps.append(math.dist(pose[:2], walker.at(0.01 * k)))
        pose = moved(pose, twist if 0.01 * k < driven_for else Twist(), 0.01)
    return min(gaps)


@given(linear=st.floats(-0.22, 0.22), angular=st.floats(-2.0, 2.0), time=st.floats(0.0, 1e4))
def test_with_nobody_about_every_twist_stays_as_it_is(
    linear: float, angular: float, time: float
) -> None:
    wanted = Twist(linear_x=linear, angular_z=angular)
    assert Yielding().limit(wanted, HERE, time, [], nowhere) is wanted


@pytest.mark.parametrize(
    "passer_by",
    [
        person(3.0, 0.0, 1.0, 0.0),  # walks away ahead
        person(1.5, 1.0, 0.8, 0.0),  # walks past at a distance
        person(6.0, 0.0, -0.8, 0.0),  # comes, but is 4 s away
        person(0.6, 0.9, 0.0, 1.0),  # has crossed already
    ],
)
def test_whoever_comes_not_near_changes_nothing(passer_by: Mover) -> None:
    assert Yielding().limit(AHEAD, HERE, 0.0, [passer_by], nowhere) == AHEAD


@pytest.mark.parametrize("speed", [0.5, 0.8, 1.2])
@pytest.mark.parametrize("side", [1.0, -1.0])
def test_it_stands_for_one_who_crosses_ahead_and_drives_on_when_they_have_gone(
    speed: float, side: float
) -> None:
    start = np.array([0.55, -2.0 * speed * side])
    walker = Walker(start=start, heading=side * math.pi / 2.0, speed=speed)
    yielding, pose, twists = Yielding(), HERE, []
    for k in range(60):
        time = PERIOD * k
        twists.append(yielding.limit(AHEAD, pose, time, [walker.as_mover(time)], anywhere))
        pose = moved(pose, twists[-1], PERIOD)
        if walker.middle(time)[1] * side < 0.3:
            assert math.dist(walker.middle(time), pose[:2]) > CONFIG.touch
    speeds = [twist.linear_x for twist in twists]
    assert 0.0 in speeds
    assert min(speeds) == 0.0, "to stand is enough: it does not step aside"
    crossed = next(k for k in range(60) if walker.middle(PERIOD * k)[1] * side > 0.0)
    assert twists[crossed].linear_x < AHEAD.linear_x
    gone = next(k for k in range(60) if walker.middle(PERIOD * k)[1] * side > 1.0)
    assert set(speeds[gone:]) == {AHEAD.linear_x}


def test_it_slows_down_where_that_is_enough() -> None:
    # 0.56 m off: after 0.5 s at full speed 0.46 m are left, at half speed 0.51 m; less the doubt
    # after the 1.1 s till then, 0.07 m
    crossing = person(0.56, -0.9, 0.0, 0.8)
    config = YieldingConfig(room=0.42)
    twist = Yielding(config).limit(
        Twist(linear_x=0.2, angular_z=0.1), HERE, 0.0, [crossing], nowhere
    )
    assert twist == Twist(linear_x=0.1, angular_z=0.05)


@given(
    angle=st.floats(-math.pi, math.pi),
    speed=st.floats(0.5, 1.2),
    # who is nearer in time cannot be got out of the way of; who is farther, need not be yet
    meeting=st.floats(1.3, 2.0),
    share=st.floats(0.0, 1.0),
)
def test_it_steps_aside_for_one_who_comes_straight_at_it_and_gains_room(
    angle: float, speed: float, meeting: float, share: float
) -> None:
    out = np.array([math.cos(angle), math.sin(angle)])
    walker = person(*(meeting * speed * out), *(-speed * out))
    wanted = Twist(linear_x=share * AHEAD.linear_x)
    twist = Yielding().limit(wanted, HERE, 0.0, [walker], anywhere)
    assert abs(twist.linear_x) == CONFIG.aside_speed
    gained = nearest_ever(twist, walker, CONFIG.aside_time) - nearest_ever(Twist(), walker, 0.0)
    assert gained > CONFIG.worth


def test_where_there_is_no_room_to_step_aside_it_stands() -> None:
    walker = person(1.2, 0.0, -0.8, 0.0)
    assert Yielding().limit(AHEAD, HERE, 0.0, [walker], nowhere) == Twist()


def test_it_steps_only_where_nothing_stands() -> None:
    """Walls at both sides and behind: one as near as a leg would be leaves a way or none."""
    walker = person(1.2, 0.0, -0.8, 0.0)

    def twist_among(points: NDArray[np.float64]) -> Twist:
        safety, grid = Safety(), OccupancyGrid()

        def allowed(twist: Twist) -> bool:
            return safety.limit(twist, HERE, points, grid) == twist

        twist = Yielding().limit(AHEAD, HERE, 0.0, [walker], allowed)
        assert allowed(twist)
        return twist

    span = np.linspace(-0.3, 0.3, 61)
    behind = np.column_stack((np.full(61, -0.16), span))
    in_front = np.column_stack((np.full(61, 0.10), span))
    assert twist_among(np.zeros((0, 2))).linear_x != 0.0
    assert twist_among(behind).linear_x > 0.0
    assert twist_among(in_front).linear_x < 0.0
    assert twist_among(np.concatenate((behind, in_front))) == Twist()


def test_it_steps_not_into_a_second_person_to_get_out_of_the_first_ones_way() -> None:
    """However close the first will come: who stands runs into nobody."""
    crossing, behind = person(0.0, -1.2, 0.0, 0.8), person(-0.38, 0.0, 0.0, 0.02, sightings=2)

    def straight_back(twist: Twist) -> bool:
        return twist.linear_x < 0.0 and twist.angular_z == 0.0

    assert Yielding().limit(AHEAD, HERE, 0.0, [crossing], straight_back).linear_x < 0.0
    assert Yielding().limit(AHEAD, HERE, 0.0, [crossing, behind], straight_back) == Twist()


def test_a_step_that_gains_too_little_is_not_taken() -> None:
    walker = person(1.2, 0.0, -0.8, 0.0)
    twist = Yielding(YieldingConfig(worth=0.5)).limit(AHEAD, HERE, 0.0, [walker], anywhere)
    assert twist == Twist()


PASSED_BY = person(1.2, 1.5, -0.8, 0.0)


def stepping_aside() -> tuple[Yielding, Twist]:
    """One that has begun to step aside at time 0, and its step."""
    yielding = Yielding()
    step = yielding.limit(AHEAD, HERE, 0.0, [person(1.2, 0.02, -0.8, 0.0)], anywhere)
    assert step.linear_x != 0.0
    return yielding, step


def test_a_step_aside_once_begun_goes_on_for_a_while() -> None:
    yielding, step = stepping_aside()
    assert yielding.limit(AHEAD, HERE, 0.4, [PASSED_BY], anywhere) == step
    assert yielding.limit(AHEAD, HERE, 0.6, [PASSED_BY], anywhere) == AHEAD


def test_a_step_aside_ends_for_good_when_something_turns_out_to_stand_in_its_way() -> None:
    yielding, _ = stepping_aside()
    assert yielding.limit(AHEAD, HERE, 0.2, [PASSED_BY], nowhere) == AHEAD
    assert yielding.limit(AHEAD, HERE, 0.3, [PASSED_BY], anywhere) == AHEAD


def test_a_step_aside_ends_when_it_leads_into_somebody_else() -> None:
    yielding, step = stepping_aside()
    way = math.copysign(1.0, step.linear_x)
    other = person(0.33 * way, 0.0, 0.0, 0.02, sightings=2)
    assert yielding.limit(AHEAD, HERE, 0.2, [PASSED_BY, other], anywhere).linear_x * way <= 0.0


def test_whoever_is_known_to_stand_is_furniture() -> None:
    beside = person(0.3, 0.0, 0.0, 0.05, sightings=LEAST_SCANS + 1)
    assert beside.is_known_to_stand
    assert Yielding().limit(AHEAD, HERE, 0.0, [beside], anywhere) == AHEAD
    assert not person(0.3, 0.0, 0.0, 0.05, sightings=LEAST_SCANS).is_known_to_stand


def test_one_who_was_seen_once_may_go_any_way() -> None:
    """A first sighting tells no velocity; what has been watched is believed."""
    beside = [0.9, 0.9, 0.0, 0.2]
    known, new = person(*beside, sightings=10), person(*beside, sightings=1)
    assert Yielding().limit(AHEAD, HERE, 0.0, [known], nowhere) == AHEAD
    assert Yielding().limit(AHEAD, HERE, 0.0, [new], nowhere) == Twist()


def first_touches(seed: int, people: int) -> list[float]:
    """Speeds [m/s] towards the legs that a robot first touches of each who walks into it.

    It wanders about and knows where everybody is and goes; the space is open.
    """
    rng = np.random.default_rng(seed)
    walkers = [random_walker(rng) for _ in range(people)]
    pose: Pose = np.array([0.0, 0.0, rng.uniform(-math.pi, math.pi)])
    yielding, touched = Yielding(), dict[int, float]()
    for k in range(70):
        if k % 20 == 0:
            wanted = Twist(linear_x=rng.choice([0.21, 0.21, 0.0]), angular_z=rng.uniform(-0.8, 0.8))
        movers = [walker.as_mover(PERIOD * k) for walker in walkers]
        twist = yielding.limit(wanted, pose, PERIOD * k, movers, anywhere)
        for step in range(1, 6):
            pose, time = moved(pose, twist, PERIOD / 5), PERIOD * (k + step / 5)
            for index, walker in enumerate(walkers):
                if index in touched or math.dist(walker.middle(time), pose[:2]) > 1.0:
                    continue
                for foot in walker.feet(time):
                    speed = speed_at_touch(pose, twist, foot)
                    if speed is not None:
                        touched.setdefault(index, speed)
    return list(touched.values())


def test_the_robot_never_runs_into_anybody_by_its_own_motion() -> None:
    """200 meetings with two people who walk past within a metre, at 0.5 to 1.2 m/s."""
    speeds = [speed for seed in range(200) for speed in first_touches(seed, people=2)]
    assert max(speeds, default=0.0) < OWN_MOTION
    # they stop for nothing: some walk into a robot that cannot get away, and few do
    assert len(speeds) <= 8


def test_whoever_does_not_yield_is_run_into_in_the_same_meetings(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """The meetings above are worth something: they need yielding."""
    monkeypatch.setattr(Yielding, "limit", lambda self, wanted, *rest: wanted)
    speeds = [speed for seed in range(50) for speed in first_touches(seed, people=2)]
    assert sum(speed >= OWN_MOTION for speed in speeds) >= 5


@pytest.mark.parametrize("value", [0.0, -1.0, math.nan, math.inf])
def test_figures_that_foresee_nothing_are_refused(value: float) -> None:
    with pytest.raises(TestbedError, match=r"yielding horizon: .*; must be above 0"):
        YieldingConfig(horizon=value)
