"""Kernels for poles, beside slow plain versions of themselves."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from mapping.aimed_beams import AimedBeams
from mapping.pole_kernels import belief, lone_hits, looks_at
from tests.mapping.finished_maps import aimed, scans_in
from tests.mapping.slam.rooms import random_room

THICKEST, GAP, GAP_SIGMAS = 0.1, 0.06, 3.0


def random_beams(seed: int) -> AimedBeams:
    """A noisy scan in a room with posts, of which some beams failed."""
    rng = np.random.default_rng(seed)
    pose = np.array([[*rng.uniform(-0.3, 0.3, 2), rng.uniform(-np.pi, np.pi)]])
    (scan,) = scans_in(random_room(rng), pose, seed)
    for _ in range(8):  # legs
        scan.ranges[rng.integers(360) :][: rng.integers(1, 4)] = rng.uniform(0.3, 1.2)
    scan.ranges[rng.random(360) < 0.1 * (seed % 3)] = 0.0
    (beams,) = aimed([scan], pose)
    return beams


def plain_lone_hits(beams: AimedBeams) -> list[list[int]]:
    """The runs' beams: from a hit that begins behind a step nearer, to a step farther."""

    def step(i: int, j: int) -> float:
        """How much farther j goes than i, beyond what noise may do; 0 within it."""
        least = GAP + GAP_SIGMAS * math.hypot(beams.sigmas[i], beams.sigmas[j])
        apart = beams.lengths[j] - beams.lengths[i]
        return 0.0 if abs(apart) < least else apart

    count, runs = len(beams.lengths), []
    for first in range(count):
        before = (first - 1) % count
        if not beams.hits[first] or not beams.pairs[before] or step(first, before) <= 0.0:
            continue
        run = [first]
        while beams.pairs[run[-1]] and len(run) < count:
            after = (run[-1] + 1) % count
            if step(run[-1], after) > 0.0:
                runs.append(run)
                break
            width = beams.lengths[first] * np.cross(
                [*beams.directions[first], 0.0], [*beams.directions[after], 0.0]
            )
            if not beams.hits[after] or step(run[-1], after) < 0.0 or width[2] > THICKEST:
                break
            run.append(after)
    return runs


@settings(max_examples=60, deadline=None)
@given(seed=st.integers(0, 10_000))
def test_runs_that_stand_alone_are_those_of_the_plain_version(seed: int) -> None:
    beams = random_beams(seed)
    found = lone_hits(
        beams.origins,
        beams.directions,
        beams.lengths,
        beams.sigmas,
        beams.hits,
        beams.pairs,
        THICKEST,
        GAP,
        GAP_SIGMAS,
    )
    runs = plain_lone_hits(beams)
    assert len(found) == len(runs)
    ends = beams.origins + beams.lengths[:, None] * beams.directions
    for row, run in zip(found, runs, strict=True):
        heading = beams.directions[run].sum(axis=0)
        assert row[:2] == pytest.approx(ends[run].mean(axis=0))
        assert row[2:4] == pytest.approx(heading / np.linalg.norm(heading))
        assert row[4] == pytest.approx(beams.sigmas[run].mean() / math.sqrt(len(run)))


def test_the_rooms_of_these_tests_have_such_runs() -> None:
    assert np.mean([len(plain_lone_hits(random_beams(seed))) for seed in range(20)]) > 3.0


@settings(max_examples=60, deadline=None)
@given(seed=st.integers(0, 10_000))
def test_looks_are_those_of_the_plain_version(seed: int) -> None:
    beams = random_beams(seed)
    rng = np.random.default_rng(seed)
    places = rng.uniform(-2.0, 2.0, (30, 2))
    half, tolerance, sigmas = 0.08, 0.05, 3.0
    expected = []
    for number in range(0, 30, 2):
        ahead = places[number] - beams.origins
        along = np.sum(ahead * beams.directions, axis=1)
        aside = np.abs(ahead[:, 0] * beams.directions[:, 1] - ahead[:, 1] * beams.directions[:, 0])
        near = (along > 0.0) & (aside <= half)
        beyond = beams.lengths - along
        reach = tolerance + sigmas * beams.sigmas
        if np.any(near & (beyond < -reach)):
            continue
        met = near & beams.hits & (np.abs(beyond) <= reach)
        told = met | (near & (beyond > reach))
        if np.any(told):
            expected.append((number, np.count_nonzero(told), np.count_nonzero(met)))
    found = looks_at(
        places,
        np.arange(0, 30, 2),
        beams.origins,
        beams.directions,
        beams.lengths,
        beams.sigmas,
        beams.hits,
        half,
        tolerance,
        sigmas,
    )
    assert [tuple(look) for look in found.tolist()] == expected


@given(
    looks=st.lists(st.tuples(st.booleans(), st.floats(0.0, 3.0)), max_size=30),
    mistaken=st.floats(0.01, 0.2),
)
def test_belief_is_that_of_bayes_rule_in_probabilities(
    looks: list[tuple[bool, float]], mistaken: float
) -> None:
    met = np.array([look[0] for look in looks], dtype=np.bool_)
    chances = np.array([look[1] for look in looks])
    odds, stayed = belief(met, chances, mistaken, -4.0, 6.0)
    probability, since, course = 0.5, False, []
    lowest, highest = (1.0 / (1.0 + math.exp(-bound)) for bound in (-4.0, 6.0))
    for seen, chance in looks:
        there = min(max(chance, mistaken), 1.0 - mistaken)
        if_there, if_not = (there, mistaken) if seen else (1.0 - there, 1.0 - mistaken)
        taken = probability * if_there
        probability = taken / (taken + (1.0 - probability) * if_not)
        probability = min(max(probability, lowest), highest)
        since = since or seen
        if since:
            course.append(probability)
    assert 1.0 / (1.0 + math.exp(-odds)) == pytest.approx(probability, abs=1e-9)
    if course and min(abs(each - 0.5) for each in course) > 1e-9:
        assert stayed == pytest.approx(np.mean(np.array(course) > 0.5))


def test_where_nothing_was_ever_met_no_pole_stayed() -> None:
    odds, stayed = belief(np.zeros(5, dtype=np.bool_), np.full(5, 0.5), 0.05, -4.0, 6.0)
    assert odds < 0.0
    assert stayed == 0.0
