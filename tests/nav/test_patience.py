"""How long the robot has given way in one place."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mapping.geometry import Pose
from mapping.messages import Twist
from nav.movers import Mover
from nav.patience import LONGEST_SILENCE, Patience
from nav.yielding import Yielding, YieldingConfig
from tests.nav.scans import PERIOD

CONFIG = YieldingConfig()
AHEAD = Twist(linear_x=0.2)


def patience() -> Patience:
    return Patience(reach=CONFIG.progress, limit=CONFIG.patience)


def spend(counted: Patience, place: tuple[float, float], begin: float, seconds: float) -> None:
    for k in range(round(seconds / PERIOD)):
        counted.note(np.array(place), begin + k * PERIOD, gives_way=True)


def test_it_runs_out_after_its_limit_in_one_place_and_not_before() -> None:
    counted = patience()
    spend(counted, (3.0, 1.0), 0.0, CONFIG.patience)
    assert not counted.is_out
    spend(counted, (3.0, 1.0), CONFIG.patience, 0.3)
    assert counted.is_out


def test_what_passes_without_giving_way_neither_spends_nor_forgives() -> None:
    counted = patience()
    spend(counted, (0.0, 0.0), 0.0, 6.0)
    for k in range(300):
        counted.note(np.zeros(2), 6.0 + k * PERIOD, gives_way=False)
    assert not counted.is_out
    spend(counted, (0.0, 0.0), 36.0, 5.0)
    assert counted.is_out


@given(st.floats(-math.pi, math.pi))
def test_it_begins_anew_where_the_robot_has_got_on(direction: float) -> None:
    counted = patience()
    spend(counted, (1.0, 1.0), 0.0, 11.0)
    near, far = (
        (1.0 + way * math.cos(direction), 1.0 + way * math.sin(direction))
        for way in (CONFIG.progress - 0.01, CONFIG.progress + 0.01)
    )
    spend(counted, near, 11.0, 0.1)
    assert counted.is_out
    spend(counted, far, 11.1, 0.1)
    assert not counted.is_out


@pytest.mark.parametrize("gap", [-1e3, 1e3, math.inf])
def test_time_that_jumps_spends_a_second_at_most(gap: float) -> None:
    counted = Patience(reach=1.0, limit=LONGEST_SILENCE + 0.01)
    counted.note(np.zeros(2), 0.0, gives_way=True)
    counted.note(np.zeros(2), gap, gives_way=True)
    assert not counted.is_out


def test_a_robot_that_got_nowhere_by_stepping_aside_only_stands() -> None:
    """Somebody comes straight at it, again and again."""
    yielding, here = Yielding(), np.zeros(3)
    steps = [
        yielding.limit(AHEAD, here, time, [coming_at(time)], lambda twist: True)
        for time in np.arange(0.0, CONFIG.patience + 5.0, PERIOD).tolist()
    ]
    last = next(k for k in range(len(steps) - 1, 0, -1) if steps[k].linear_x < 0.0)
    assert last * PERIOD == pytest.approx(CONFIG.patience, abs=CONFIG.kept_for)
    assert set(steps[last + 1 :]) == {Twist()}
    elsewhere = here + (CONFIG.progress + 0.1, 0.0, 0.0)
    time = CONFIG.patience + 5.0
    assert yielding.limit(AHEAD, elsewhere, time, [coming_at(time)], lambda twist: True) == Twist()
    after = yielding.limit(
        AHEAD, elsewhere, time + PERIOD, [coming_at(time, elsewhere)], lambda twist: True
    )
    assert after.linear_x < 0.0


def coming_at(time: float, pose: Pose | None = None) -> Mover:
    """Somebody 1.2 m ahead who comes straight at the robot."""
    x = 0.0 if pose is None else float(pose[0])
    return Mover(
        place=np.array([x + 1.2, 0.02]), velocity=np.array([-0.8, 0.0]), stamp=time, sightings=20
    )
