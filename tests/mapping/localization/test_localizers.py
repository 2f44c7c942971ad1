"""The three localisers on drives through rooms: found, tracked, carried off, honest in doubt."""

import math
from collections.abc import Callable

import numpy as np
import pytest

from mapping.errors import TestbedError
from mapping.geometry import between
from mapping.localization.ekf_localizer import EkfLocalizer
from mapping.localization.histogram_localizer import HistogramLocalizer
from mapping.localization.known_map import KnownMap
from mapping.localization.localizer import Localizer
from mapping.localization.localizers import make_localizer
from mapping.localization.particle_localizer import ParticleLocalizer, ParticleLocalizerConfig
from tests.mapping.localization.places import (
    EVEN_ROOM,
    EVEN_WAY,
    L_ROOM,
    L_ROOM_WAY,
    driven,
    error,
    later,
    map_of,
)
from tests.mapping.slam.rooms import drive

QUICK = ParticleLocalizerConfig(at_start=50_000)
"""A room of 11 m2 needs fewer particles than a building."""

KNOWN = map_of(L_ROOM, (0.5, 0.5))
EVEN = map_of(EVEN_ROOM, (0.5, 0.5))

Maker = Callable[[KnownMap], Localizer]
GLOBAL: dict[str, Maker] = {
    "particle": lambda known: ParticleLocalizer(known, QUICK, seed=3),
    "histogram": HistogramLocalizer,
}


@pytest.mark.parametrize("name", GLOBAL)
def test_from_anywhere_it_finds_itself_and_stays_found(name: str) -> None:
    localizer = GLOBAL[name](KNOWN)
    truth, _ = driven(localizer, L_ROOM, L_ROOM_WAY)
    meters, radians = error(localizer, truth)
    assert meters < 0.25
    assert radians < math.radians(10.0)
    assert not localizer.is_lost
    assert not localizer.is_ambiguous


def test_tracking_is_exact_to_centimetres() -> None:
    run = drive(L_ROOM, L_ROOM_WAY, np.random.default_rng(1))
    localizer = ParticleLocalizer(KNOWN, QUICK, start=run.start, seed=0)
    steps = []
    for k, (scan, odometry) in enumerate(run.periods[:-1]):
        localizer.update(scan, odometry)
        # the newest odometry message is that of the next scan's first beam
        steps.append(between(run.truth[k + 1], localizer.pose_map))
    apart = np.array(steps)
    assert np.sqrt(np.mean(apart[:, 0] ** 2 + apart[:, 1] ** 2)) < 0.05
    assert np.degrees(np.sqrt(np.mean(apart[:, 2] ** 2))) < 1.0


@pytest.mark.parametrize("name", GLOBAL)
def test_carried_off_it_finds_itself_again(name: str) -> None:
    localizer = GLOBAL[name](KNOWN)
    _, periods = driven(localizer, L_ROOM, L_ROOM_WAY[:3])
    assert not localizer.is_lost
    last_scan, last_odometry = periods[-1]
    assert last_scan is not None
    run = drive(L_ROOM, [(1.2, 2.9), (1.4, 1.0), (3.4, 0.9)], np.random.default_rng(5))
    stamp = last_scan.stamp + 0.2
    for scan, odometry in later(run.periods, stamp, last_odometry[-1].pose_odom):
        localizer.update(scan, odometry)
    meters, radians = error(localizer, run.truth[-1])
    assert meters < 0.25
    assert radians < math.radians(10.0)
    assert not localizer.is_lost


@pytest.mark.parametrize("name", GLOBAL)
def test_in_a_room_that_is_the_same_when_turned_it_says_so(name: str) -> None:
    localizer = GLOBAL[name](EVEN)
    truth, _ = driven(localizer, EVEN_ROOM, EVEN_WAY)
    assert localizer.is_ambiguous
    first, second = localizer.hypotheses[:2]
    assert first.weight + second.weight > 0.9
    mirrored = np.array([4.0 - truth[0], 2.4 - truth[1], truth[2] + math.pi])
    for place in (truth, mirrored):
        nearest = min(np.hypot(*between(place, each.pose)[:2]) for each in (first, second))
        assert nearest < 0.3


def test_the_extended_kalman_filter_tracks_by_corners() -> None:
    run = drive(L_ROOM, L_ROOM_WAY, np.random.default_rng(2), scale=0.03, drift=0.05)
    localizer = EkfLocalizer(KNOWN, start=run.start + [0.1, -0.1, 0.05])
    assert localizer.size == 6
    for scan, odometry in run.periods:
        localizer.update(scan, odometry)
    meters, radians = error(localizer, run.truth[-1])
    astray = np.hypot(*(run.odometry_end - run.truth[-1])[:2])
    assert meters < 0.05
    assert radians < math.radians(1.5)
    assert astray > 3.0 * 0.05, "or odometry alone would do"
    assert not localizer.is_lost


def test_the_extended_kalman_filter_refuses_to_start_anywhere() -> None:
    with pytest.raises(TestbedError, match="known"):
        make_localizer("ekf", KNOWN)
    with pytest.raises(TestbedError, match="known"):
        EkfLocalizer(KNOWN, start=None)
    with pytest.raises(TestbedError, match="filter"):
        make_localizer("kalman", KNOWN)


@pytest.mark.parametrize("name", GLOBAL)
def test_before_any_scan_it_is_lost(name: str) -> None:
    localizer = GLOBAL[name](KNOWN)
    assert localizer.is_lost
    assert localizer.is_ambiguous
    assert localizer.pose_map.shape == (3,)
    assert localizer.covariance[0, 0] > 0.1


def test_the_same_seed_gives_the_same_belief() -> None:
    ends = []
    for _ in range(2):
        localizer = ParticleLocalizer(KNOWN, QUICK, seed=7)
        driven(localizer, L_ROOM, L_ROOM_WAY[:2])
        ends.append(localizer.sample.tobytes())
    assert ends[0] == ends[1]


@pytest.mark.parametrize("name", ["particle", "histogram", "ekf"])
@pytest.mark.parametrize("start", [(90.0, 0.0, 0.0), (math.nan, 0.0, 0.0), (1.0, 2.0)])
def test_a_start_that_is_not_on_the_map_is_refused(name: str, start: tuple[float, ...]) -> None:
    with pytest.raises(TestbedError, match="start"):
        make_localizer(name, KNOWN, start=start)


def test_a_histogram_refuses_a_start_where_the_robot_fits_nowhere() -> None:
    row, column = np.argwhere(KNOWN.occupied)[0]
    x, y = (
        KNOWN.origin[k] + (cell + 0.5) * KNOWN.resolution for k, cell in ((0, column), (1, row))
    )
    with pytest.raises(TestbedError, match="must fit there"):
        HistogramLocalizer(KNOWN, start=(x, y, 0.0), start_sigmas=(0.001, 0.001, 0.1))
