"""Whatever the sensors say, no mapper crashes, and none puts a NaN in its map or its poses."""

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from mapping.geometry import between
from mapping.grid import UNKNOWN, GridConfig
from mapping.mapper import Mapper
from mapping.mappers import MAPPERS, make_mapper
from mapping.messages import Imu, LaserScan, Odometry
from tests.mapping.slam.rooms import Period, Run, drive, fed, ring

EVERY = pytest.mark.parametrize("name", MAPPERS)
MATCHING = pytest.mark.parametrize("name", ["scan_match", "graph", "gmapping"])
RELIABLE = drive(
    ring(), [(-2.9, -1.9), (-1.6, -1.9), (-1.6, -1.7)], np.random.default_rng(0), scale=0.02
)
"""Eleven seconds with a turn in them; gentle, so that all mappers agree."""

Edit = Callable[[int, LaserScan, list[Odometry]], tuple[LaserScan | None, list[Odometry]]]


def edited(edit: Edit, run: Run = RELIABLE) -> list[Period]:
    periods: list[Period] = []
    for k, (scan, odometry) in enumerate(run.periods):
        assert scan is not None
        periods.append(edit(k, scan, odometry))
    return periods


def made(name: str) -> Mapper:
    """The mapper with a small grid, and for GMapping few particles: it is about crashes."""
    settings: dict[str, Any] = {"particles": 3} if name == "gmapping" else {}
    grid = GridConfig(resolution=0.05, origin=(-5.0, -5.0), rows=200, columns=200)
    return make_mapper(name, start_pose_map=RELIABLE.start, grid=grid, settings=settings)


def assert_sound(mapper: Mapper) -> None:
    assert np.all(np.isfinite(mapper.grid.log_odds))
    assert np.all(np.isfinite(mapper.pose_map))
    assert np.all(np.isfinite(mapper.trajectory.poses))
    assert np.all(np.isfinite(mapper.trajectory.stamps))
    assert mapper.trajectory.poses.shape == (len(mapper.trajectory), 3)


def ranges_of(value: float, beams: int = 360) -> Edit:
    """Every third scan shows the value only."""
    ranges = np.full(beams, value, dtype=np.float32)
    return lambda k, scan, odometry: (
        replace(scan, ranges=ranges) if k % 3 == 1 else scan,
        odometry,
    )


def only(value: float, beams: int = 360) -> Edit:
    ranges = np.full(beams, value, dtype=np.float32)
    return lambda _, scan, odometry: (replace(scan, ranges=ranges), odometry)


def shifted(odometry: Sequence[Odometry], *shift: float) -> list[Odometry]:
    return [replace(each, pose_odom=each.pose_odom + shift) for each in odometry]


def at(odometry: Sequence[Odometry], stamp: float) -> list[Odometry]:
    return [replace(each, stamp=stamp) for each in odometry]


def noise(k: int, scan: LaserScan, odometry: list[Odometry]) -> Period:
    """Ranges of any kind, of any number of beams."""
    rng = np.random.default_rng(k)
    kinds = [rng.uniform(-1.0, 5.0), np.nan, np.inf, -np.inf, 0.0, 1e30, 1e-30]
    beams = int(rng.choice([0, 1, 2, 3, 10, 360, 1000]))
    return replace(scan, ranges=rng.choice(kinds, beams).astype(np.float32)), odometry


WRONG: dict[str, Edit] = {
    "scans of no beams": ranges_of(1.0, 0),
    "scans of one beam": ranges_of(1.0, 1),
    "scans of three beams": only(1.0, 3),
    "scans of NaN": ranges_of(np.nan),
    "nothing but NaN": only(np.nan),
    "scans that failed": ranges_of(0.0),
    "nothing but failures": only(0.0),
    "scans without a return": ranges_of(np.inf),
    "nothing but open space": only(np.inf),
    "scans of minus infinity": ranges_of(-np.inf),
    "nothing but minus infinity": only(-np.inf),
    "a circle all the time": only(1.5),
    "ranges of any kind": noise,
    "time running backwards": lambda k, s, o: (
        replace(s, stamp=9.0 - s.stamp),
        [replace(each, stamp=9.0 - each.stamp) for each in o],
    ),
    "scans from the past": lambda k, s, o: (replace(s, stamp=s.stamp - 3.0 * (k % 2)), o),
    "repeated stamps": lambda k, s, o: (replace(s, stamp=0.8 * (k // 4)), at(o, 0.8 * (k // 4))),
    "one stamp only": lambda k, s, o: (replace(s, stamp=1.0), at(o, 1.0)),
    "scans without a stamp": lambda k, s, o: (replace(s, stamp=np.nan) if k % 3 == 1 else s, o),
    "scans at infinity": lambda k, s, o: (replace(s, stamp=np.inf) if k == 20 else s, o),
    "odometry without a stamp": lambda k, s, o: (s, at(o, np.nan) if k % 5 == 2 else o),
    "odometry at infinity": lambda k, s, o: (s, at(o, np.inf) if k == 20 else o),
    "odometry of NaN": lambda k, s, o: (s, shifted(o, np.nan, 0.0, 0.0) if k % 5 == 2 else o),
    "odometry of infinity": lambda k, s, o: (s, shifted(o, 0.0, np.inf, 0.0) if k > 20 else o),
    "jumps of 5 m": lambda k, s, o: (s, shifted(o, 5.0 * (k // 10), 0.0, 0.0)),
    "jumps of half a turn": lambda k, s, o: (s, shifted(o, 0.0, 0.0, np.pi * (k // 10))),
    "odometry that jumps to and fro": lambda k, s, o: (s, shifted(o, 5.0 * (k % 2), 0.0, 0.0)),
    "no odometry at first": lambda k, s, o: (s, o if k > 15 else []),
    "no odometry any more": lambda k, s, o: (s, o if k < 15 else []),
    "no odometry at all": lambda k, s, o: (s, []),
    "no scans at all": lambda k, s, o: (None, o),
    "no angle": lambda k, s, o: (replace(s, angle_min=np.nan) if k % 3 == 1 else s, o),
    "no increment": lambda k, s, o: (replace(s, angle_increment=np.nan) if k % 3 == 1 else s, o),
    "an increment of 0": lambda k, s, o: (replace(s, angle_increment=0.0) if k % 3 == 1 else s, o),
    "no time between beams": lambda k, s, o: (
        replace(s, time_increment=np.nan) if k % 3 == 1 else s,
        o,
    ),
    "a lidar of NaN range": lambda k, s, o: (replace(s, range_max=np.nan, range_min=np.nan), o),
}


@EVERY
@pytest.mark.parametrize("wrong", WRONG)
def test_wrong_data_makes_no_nan_and_no_crash(name: str, wrong: str) -> None:
    mapper = made(name)
    for scan, odometry in edited(WRONG[wrong]):
        mapper.update(scan, odometry)
        assert np.all(np.isfinite(mapper.pose_map))
    assert_sound(mapper)
    mapper.finish()
    assert_sound(mapper)


@EVERY
def test_scans_without_a_beam_that_tells_anything_draw_nothing(name: str) -> None:
    for value in (np.nan, 0.0, -np.inf):
        mapper = fed(made(name), edited(only(value)))
        assert not mapper.grid.log_odds.any()
        assert mapper.updates == 0
        assert mapper.scans_dropped == len(RELIABLE.periods)


@pytest.mark.parametrize("name", ["scan_match", "graph"])
@pytest.mark.parametrize("wrong", ["no angle", "no increment"])
def test_scans_that_look_nowhere_are_dropped(name: str, wrong: str) -> None:
    mapper = fed(made(name), edited(WRONG[wrong]))
    assert mapper.scans_dropped == len(range(1, len(RELIABLE.periods), 3))


@EVERY
def test_a_gyroscope_of_nan_changes_nothing(name: str) -> None:
    plain, mapper = made(name), made(name)
    for scan, odometry in RELIABLE.periods:
        stamp = odometry[-1].stamp
        nothing = np.full(4, np.nan)
        broken = Imu(
            stamp=stamp,
            orientation=nothing,
            angular_velocity=nothing[:3],
            linear_acceleration=nothing[:3],
        )
        plain.update(scan, odometry)
        mapper.update(scan, odometry, [broken])
    assert_sound(mapper)
    apart = between(plain.pose_map, mapper.pose_map)
    assert np.hypot(*apart[:2]) < 0.02


@MATCHING
def test_a_jump_of_the_odometry_moves_the_robot_by_no_more_than_it_can_drive(name: str) -> None:
    mapper = fed(made(name), edited(WRONG["jumps of 5 m"]))
    # three jumps of 5 m; what is lost is the way of as many odometry periods, a third of a second
    apart = between(RELIABLE.truth[-1], mapper.trajectory.poses[-1])
    assert np.hypot(*apart[:2]) < 0.15


def states_of(name: str, periods: list[Period]) -> tuple[NDArray[np.int8], Mapper]:
    mapper = fed(made(name), periods)
    return mapper.grid.states(), mapper


def counted_from_behind(k: int, scan: LaserScan, odometry: list[Odometry]) -> Period:
    """The beams from -pi to pi."""
    return replace(scan, ranges=np.roll(scan.ranges, 180), angle_min=-np.pi), odometry


def upside_down(k: int, scan: LaserScan, odometry: list[Odometry]) -> Period:
    """The beams in clockwise order."""
    return (
        replace(
            scan,
            ranges=scan.ranges[::-1].copy(),
            angle_min=scan.angle_max,
            angle_increment=-scan.angle_increment,
        ),
        odometry,
    )


def a_turn_on(k: int, scan: LaserScan, odometry: list[Odometry]) -> Period:
    """The beams from 4 pi on."""
    return replace(scan, angle_min=4.0 * np.pi), odometry


@EVERY
@pytest.mark.parametrize("edit", [counted_from_behind, upside_down, a_turn_on])
def test_the_order_in_which_beams_are_counted_changes_no_map(name: str, edit: Edit) -> None:
    way = [(-2.9, -1.9), (-1.6, -1.9), (-1.6, -1.7)]
    run = drive(ring(), way, np.random.default_rng(0), scale=0.02, rolls=False)
    states, mapper = states_of(name, run.periods)
    others, other = states_of(name, edited(edit, run))
    apart = between(mapper.trajectory.poses, other.trajectory.poses)
    # walls across the seam are not joined; matches then differ by millimetres
    assert np.max(np.hypot(apart[:, 0], apart[:, 1])) < 0.02
    assert np.max(np.abs(apart[:, 2])) < 0.01
    known = (states != UNKNOWN) | (others != UNKNOWN)
    assert np.count_nonzero(known) > 1000
    # of cells of 5 cm, those at walls may change with millimetres
    assert np.mean(states[known] != others[known]) < 0.04
