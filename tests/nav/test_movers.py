"""What moves is noticed and followed; what stands is never taken for it."""

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from mapping.errors import TestbedError
from mapping.geometry import Pose, transform_points
from nav.legs import LEG_BEHIND
from nav.movers import LEAST_SCANS, Mover, Movers, MoversConfig
from nav.scan_points import ScanView
from tests.nav.rooms import drive_through, furnished_room
from tests.nav.scans import Room, Way, box, views_of

SCAN_TIME = 0.2
HALL = box(-1.0, -1.0, 8.0, 8.0)
MIDDLE = np.array([3.0, 3.0, 0.3])
POSE_ERROR = (0.01, math.radians(0.5))
"""What matched poses are wrong by from scan to scan: 1 cm and half a degree."""

NOT_YET = np.array([99.0, 99.0])


def walk(start: NDArray[np.float64], velocity: NDArray[np.float64], since: float) -> Way:
    """A leg that is set down at a time [s] and walks off straight at once."""
    return lambda time: start + (time - since) * velocity if time >= since else NOT_YET


def standing(seconds: float) -> Pose:
    return np.tile(MIDDLE, (round(10 * seconds) + 1, 1))


def fresh(movers: Movers, view: ScanView) -> list[Mover]:
    """Those that the newest scan has seen."""
    return [each for each in movers.known if each.stamp == view.stamp]


def bare_view(stamp: float, ranges: NDArray[np.float64], origin: Pose | None = None) -> ScanView:
    """A scan of a degree a beam from one place, the first beam along x."""
    x, y, yaw = np.zeros(3) if origin is None else origin
    beams = np.flatnonzero(np.isfinite(ranges))
    angles = yaw + np.radians(beams)
    along = np.column_stack((np.cos(angles), np.sin(angles)))
    return ScanView(
        stamp=stamp,
        points=np.array([x, y]) + ranges[beams, None] * along,
        beams=beams,
        origin=np.array([x, y]),
        bearing=float(yaw),
        increment=math.radians(1.0),
        ranges=ranges,
    )


def seen_after(before: NDArray[np.float64], now: NDArray[np.float64], scans: int = 8) -> Movers:
    """The movers after some scans alike and a last one."""
    movers = Movers()
    for k in range(scans):
        movers.update(bare_view(SCAN_TIME * k, before))
    movers.update(bare_view(SCAN_TIME * scans, now))
    return movers


def with_leg(
    ranges: NDArray[np.float64], first: int, last: int, away: float
) -> NDArray[np.float64]:
    """The same scan with something in front of its beams from ``first`` to ``last``."""
    changed = ranges.copy()
    changed[first : last + 1] = away
    return changed


EMPTY = np.full(360, 3.0)


@given(seed=st.integers(0, 10_000))
@settings(max_examples=15)
def test_a_leg_set_down_where_scans_saw_free_floor_is_noticed_and_its_velocity_found(
    seed: int,
) -> None:
    rng = np.random.default_rng(seed)
    # not straight ahead: what walks across a scan's first and last beam may slip through there
    angle, set_down = MIDDLE[2] + rng.uniform(0.45, 1.55) * np.pi, 1.6
    start = MIDDLE[:2] + rng.uniform(1.0, 1.8) * np.array([math.cos(angle), math.sin(angle)])
    # nor past the sensor: the side of the leg that it sees would turn round it
    heading = angle + rng.choice([-1.0, 1.0]) * rng.uniform(0.25, 0.75) * np.pi
    velocity = rng.uniform(0.5, 1.2) * np.array([math.cos(heading), math.sin(heading)])
    leg = walk(start, velocity, set_down)
    movers = Movers()
    for view in views_of(Room(walls=HALL, legs=(leg,)), standing(3.0), rng, POSE_ERROR):
        movers.update(view)
        if set_down < view.stamp < set_down + 1.0:
            (mover,) = fresh(movers, view)
            # half a stride of a fast walker: it is expected where it went till the last scan
            assert np.hypot(*(mover.place - leg(view.stamp))) < 0.25
    since = view.stamp - set_down
    assert 1.2 <= since <= 1.4
    (mover,) = fresh(movers, view)
    assert np.hypot(*(mover.velocity - velocity)) < 0.2
    # the near side of the leg is seen, 6 cm from its middle; the rest is noise
    assert np.hypot(*(mover.at(view.stamp + 0.3) - leg(view.stamp + 0.3))) < 0.15


@given(seed=st.integers(0, 10_000))
@settings(max_examples=25)
def test_nothing_that_stands_is_taken_for_moving_by_a_robot_that_drives_and_turns(
    seed: int,
) -> None:
    """Chair legs, corners, doors and grazing walls, with noise and errors of the pose."""
    rng = np.random.default_rng(seed)
    room, size = furnished_room(rng)
    poses = drive_through(room, size, 15.0, rng)
    movers = Movers()
    for view in views_of(room, poses, rng, POSE_ERROR):
        movers.update(view)
        assert movers.known == []


def test_what_was_hidden_before_is_not_taken_for_moving() -> None:
    """Driving past the end of a wall shows a post behind it, bit by bit."""
    room = Room(
        walls=np.concatenate((HALL, box(0.5, 3.6, 2.5, 0.1))), posts=np.array([[2.2, 4.4, 0.06]])
    )
    x = np.linspace(2.0, 4.0, 96)
    poses = np.column_stack((x, np.full(96, 3.0), np.zeros(96)))
    views = views_of(room, poses, np.random.default_rng(3), POSE_ERROR)
    hidden = [np.hypot(*(view.points - (2.2, 4.4)).T).min() > 0.15 for view in views]
    assert hidden[0]
    assert not hidden[-1]
    movers = Movers()
    for view in views:
        movers.update(view)
        assert movers.known == []


@pytest.mark.parametrize(
    ("away", "before", "noticed"),
    [
        (1.0, 3.0, True),
        (1.0, math.inf, True),
        (1.0, math.nan, False),  # beams that failed tell nothing
        (1.0, 1.0, False),
        (1.0, 1.1, False),  # no farther than the pose may err by
        (2.5, 2.7, False),  # nor than the lidar may err by as well
        (2.5, 2.8, True),
    ],
)
def test_only_beams_that_went_farther_tell_that_nothing_was_there(
    away: float, before: float, noticed: bool
) -> None:
    earlier = with_leg(EMPTY, 80, 100, before)
    movers = seen_after(earlier, with_leg(earlier, 87, 93, away))
    assert len(movers.known) == noticed
    if noticed:
        assert movers.known[0].place == pytest.approx([0.0, away + LEG_BEHIND], abs=0.02)


def test_it_takes_enough_scans_that_are_old_enough() -> None:
    now = with_leg(EMPTY, 87, 93, 1.0)
    # the last scan before is 0.2 s old: younger than 0.4 s, it may have seen the same thing
    assert seen_after(EMPTY, now, scans=LEAST_SCANS).known == []
    assert len(seen_after(EMPTY, now, scans=LEAST_SCANS + 1).known) == 1


def test_beyond_reach_nobody_is_of_any_concern() -> None:
    far = np.full(360, math.inf)
    reach = MoversConfig().reach
    assert seen_after(far, with_leg(far, 87, 93, reach + 0.05)).known == []
    assert len(seen_after(far, with_leg(far, 87, 93, reach - 0.05)).known) == 1


def test_one_that_stops_is_known_to_stand_and_then_belongs_to_the_furniture() -> None:
    def leg(time: float) -> NDArray[np.float64]:
        return walk(np.array([1.5, 4.0]), np.array([0.8, 0.0]), 1.6)(min(time, 2.8))

    movers, stood, known = Movers(), [], []
    room = Room(walls=HALL, legs=(leg,))
    for view in views_of(room, standing(8.0), np.random.default_rng(1), POSE_ERROR):
        movers.update(view)
        if view.stamp > 1.6:
            stood.append(any(each.is_known_to_stand for each in movers.known))
            known.append(len(movers.known))
    assert not any(stood[:6]), "it walks for 1.2 s"
    assert any(stood[6:12])
    assert known[:6] == [1] * 6
    # it has stood for longer than scans are remembered
    assert known[-1] == 0


def test_one_that_is_gone_is_forgotten() -> None:
    movers = seen_after(EMPTY, with_leg(EMPTY, 87, 93, 1.0))
    counts = []
    for k in range(9, 15):
        movers.update(bare_view(SCAN_TIME * k, EMPTY))
        counts.append(len(movers.known))
    # three scans later, 0.6 s, it may still be hidden behind something
    assert counts == [1, 1, 1, 0, 0, 0]


def test_the_speed_of_what_is_followed_stays_what_is_possible_indoors() -> None:
    movers, speeds = seen_after(EMPTY, with_leg(EMPTY, 87, 93, 0.6)), []
    for k in range(1, 6):
        movers.update(bare_view(SCAN_TIME * (8 + k), with_leg(EMPTY, 87, 93, 0.6 + 0.44 * k)))
        (mover,) = movers.known
        speeds.append(float(np.hypot(*mover.velocity)))
    # 2.2 m/s by the scans
    assert speeds[-1] == pytest.approx(MoversConfig().max_speed)
    assert max(speeds) <= MoversConfig().max_speed + 1e-9


@given(
    jump=st.tuples(st.floats(-2.0, 2.0), st.floats(-2.0, 2.0), st.floats(-3.0, 3.0)),
    after=st.integers(1, 14),
)
@settings(max_examples=12)
def test_a_map_jump_moves_what_is_remembered(jump: tuple[float, float, float], after: int) -> None:
    """As if the map had always lain there, wherever in the walk it jumps."""
    leg = walk(np.array([1.5, 4.0]), np.array([0.8, 0.1]), 1.2)
    views = views_of(Room(walls=box(0.8, 1.8, 3.7, 3.2), legs=(leg,)), standing(3.2))
    frame = np.array(jump)
    steady, jumped = Movers(), Movers()
    for k, view in enumerate(views):
        if k == after:
            jumped.follow_jump(frame)
        steady.update(view)
        jumped.update(moved(view, frame) if k >= after else view)
    assert len(steady.known) == len(jumped.known) == 1
    (a,), (b,) = steady.known, jumped.known
    assert a.sightings == b.sightings
    assert b.place == pytest.approx(transform_points(frame, a.place[None])[0], abs=1e-6)
    turn = np.array([0.0, 0.0, frame[2]])
    assert b.velocity == pytest.approx(transform_points(turn, a.velocity[None])[0], abs=1e-6)


def moved(view: ScanView, frame: Pose) -> ScanView:
    """The same view in a map in which the old one lies at ``frame``."""
    return replace(
        view,
        points=transform_points(frame, view.points),
        origin=transform_points(frame, view.origin[None])[0],
        bearing=view.bearing + float(frame[2]),
    )


def test_a_scan_without_turn_from_beam_to_beam_tells_nothing() -> None:
    movers = seen_after(EMPTY, EMPTY)
    still = bare_view(9.0, with_leg(EMPTY, 87, 93, 1.0))
    movers.update(replace(still, bearing=0.0, increment=0.0))
    assert movers.known == []


def test_a_lidar_that_is_changed_for_another_starts_anew() -> None:
    movers = seen_after(EMPTY, EMPTY)
    half = np.full(180, 3.0)
    movers.update(bare_view(2.0, with_leg(half, 87, 93, 1.0)))
    assert movers.known == []


@pytest.mark.parametrize("value", [0.0, -1.0, math.nan, math.inf])
def test_figures_that_follow_nothing_are_refused(value: float) -> None:
    with pytest.raises(TestbedError, match=r"movers reach: .*; must be above 0"):
        MoversConfig(reach=value)
