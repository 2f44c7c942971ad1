"""People's legs are a function of time, clear of everything solid, and step instead of sliding."""

import dataclasses
import math
import re

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

from envs.floor_plan import Box, Cylinder, FloorPlan, Pedestrian, Polygon, Wall
from envs.pedestrians import HIP_WIDTH, LEG_RADIUS, feet_at, gaits_of, positions_at
from envs.plan_yaml import read_plan, write_plan
from envs.solids import Disc, distance
from envs.walking_room import gaps_to, swings_of
from envs.worlds import load_world
from mapping.errors import TestbedError

HALL = FloorPlan(
    name="hall",
    start=(0.0, 0.0, 0.0),
    walls=(Wall(points=((-5.0, -5.0), (5.0, -5.0), (5.0, 5.0), (-5.0, 5.0)), closed=True),),
)
places = st.tuples(st.floats(-20.0, 20.0), st.floats(-20.0, 20.0))
people = st.builds(
    Pedestrian,
    waypoints=st.lists(places, min_size=2, max_size=6, unique=True)
    .map(tuple)
    .filter(lambda points: max(math.dist(points[0], point) for point in points) > 1.0),
    speed=st.floats(0.1, 2.0),
    phase=st.floats(0.0, 1.0),
    there_and_back=st.booleans(),
)
times = st.floats(0.0, 600.0)


def slow_feet(person: Pedestrian, time: float) -> np.ndarray:
    """Left and right foot by the words of the docstring, one step at a time."""
    footsteps, count = person.footsteps(), person.step_count
    taken = time / (person.length / person.speed / count) + person.phase * count
    step = math.floor(taken)
    share = 3.0 * (taken - step) ** 2 - 2.0 * (taken - step) ** 3
    before, here, after = (footsteps[(step + k) % count] for k in (-1, 0, 1))
    feet = [here, (1.0 - share) * before + share * after]
    return np.array(feet if step % 2 == 0 else feet[::-1])


@given(person=people, time=times)
@settings(max_examples=60)
def test_the_legs_are_where_the_slow_reference_has_them(person: Pedestrian, time: float) -> None:
    feet = feet_at(gaits_of([person]), time)
    np.testing.assert_allclose(feet, slow_feet(person, time), atol=1e-7)
    assert feet.tobytes() == feet_at(gaits_of([person]), time).tobytes()


def test_several_people_walk_as_each_would_alone() -> None:
    crowd = load_world("pedestrian_hall").pedestrians
    together = feet_at(gaits_of(crowd), 12.3)
    alone = [feet_at(gaits_of([person]), 12.3) for person in crowd]
    np.testing.assert_array_equal(together, np.concatenate(alone))


@given(person=people, time=times)
@settings(max_examples=60)
def test_one_foot_stands_still_while_the_other_swings_at_three_times_the_speed_at_most(
    person: Pedestrian, time: float
) -> None:
    count = person.step_count
    step_time = person.length / person.speed / count
    gaits, dt = gaits_of([person]), 1e-4 * step_time
    within = (time / step_time + person.phase * count) % 1.0
    if within + 1e-4 >= 1.0:
        return
    moved = np.hypot(*(feet_at(gaits, time + dt) - feet_at(gaits, time)).T)
    # A swing spans two steps along the way, and at a turn up to a hip's width to the side.
    fastest = 1.5 * (2.0 * person.length / count + 2.0 * HIP_WIDTH) / step_time
    assert moved.min() < 1e-9
    assert moved.max() / dt <= fastest * 1.001


@given(person=people, time=times)
@settings(max_examples=60)
def test_the_legs_stay_beside_the_body(person: Pedestrian, time: float) -> None:
    (middle,) = positions_at([person], time)
    step = person.length / person.step_count
    away = np.hypot(*(feet_at(gaits_of([person]), time) - middle).T)
    # Half a step of way since the standing foot was passed; a step and a half for the other.
    assert away.max() <= 1.5 * step + 0.5 * HIP_WIDTH + 1e-6


def test_on_a_straight_way_the_steps_are_those_of_the_walk_ratio_and_a_hip_apart() -> None:
    person = Pedestrian(waypoints=((0.0, 0.0), (100.0, 0.0)), speed=1.2)
    footsteps = person.footsteps()[10:40]
    lengths = np.diff(footsteps[:, 0])
    # 0.0065 m min at 1.2 m/s: 105 steps a minute of 0.684 m
    np.testing.assert_allclose(lengths, 0.684, atol=0.003)
    np.testing.assert_allclose(footsteps[::2, 1], HIP_WIDTH / 2, atol=1e-9)
    np.testing.assert_allclose(footsteps[1::2, 1], -HIP_WIDTH / 2, atol=1e-9)


def test_there_and_back_leads_through_every_waypoint_twice() -> None:
    points = ((0.0, 0.0), (3.0, 0.0), (3.0, 2.0))
    assert Pedestrian(waypoints=points, there_and_back=True).length == pytest.approx(10.0)
    assert Pedestrian(waypoints=points).length == pytest.approx(5.0 + math.sqrt(13.0))


@given(person=people)
@settings(max_examples=40)
def test_swings_are_as_far_from_solids_as_shapely_has_them(person: Pedestrian) -> None:
    swings = swings_of(person)[:40]
    parts = (
        Box(center=(2.0, 1.0), size=(3.0, 0.5), yaw=0.7),
        Cylinder(center=(-4.0, 3.0), radius=0.8),
        Polygon(vertices=((0.0, -9.0), (6.0, -4.0), (1.0, -3.0))),
    )
    for solid in (solid for part in parts for solid in part.solids()):
        if isinstance(solid, Disc):
            shape, reach = shapely.Point(solid.center), solid.radius
        else:
            shape, reach = shapely.Polygon(solid.vertices), 0.0
        apart = shapely.distance(shapely.linestrings(swings), shape) - reach
        np.testing.assert_allclose(gaps_to(solid, swings), np.maximum(apart, 0.0), atol=1e-9)


def test_legs_in_the_hall_are_never_in_a_solid() -> None:
    plan = load_world("pedestrian_hall")
    gaits = gaits_of(plan.pedestrians)
    for time in np.arange(0.0, 60.0, 0.13):
        for foot in feet_at(gaits, float(time)):
            assert min(distance(solid, foot) for solid in plan.solids()) >= LEG_RADIUS


@pytest.mark.parametrize(
    ("fields", "told"),
    [
        ({"waypoints": ((0.0, 2.0), (0.0, 8.0))}, "waypoints: near .* a leg goes through walls[0]"),
        ({"waypoints": ((-3.0, 4.8), (3.0, 4.8))}, "m past walls[0]; legs need 0.06 m"),
        (
            {"waypoints": ((0.0, 0.0), (0.3, 0.0))},
            "waypoints: 0.6 m round; a loop must be at least",
        ),
        ({"waypoints": ((1.0, 2.0),)}, "waypoints: 0 m round"),
        ({"waypoints": ()}, "waypoints: 0 m round"),
        ({"waypoints": ((1.0, 2.0), (math.nan, 3.0))}, "waypoints: (nan, 3.0) m"),
        ({"speed": 0.05}, "speed: 0.05 m/s; must be from 0.1 to 2"),
        ({"speed": 2.5}, "speed: 2.5 m/s"),
        ({"speed": math.nan}, "speed: nan"),
        ({"phase": -0.1}, "phase: -0.1; must be a share"),
        ({"waypoints": ((0.0, 0.0), (3.0, 0.0))}, "stands on the robot's start at time 0"),
    ],
)
def test_a_walk_that_nobody_can_walk_is_refused_in_one_line(
    fields: dict[str, object], told: str
) -> None:
    def hall_with_person() -> FloorPlan:
        person = Pedestrian(**{"waypoints": ((2.0, 2.0), (3.0, 3.0)), **fields})
        return dataclasses.replace(HALL, pedestrians=(person,))

    with pytest.raises(TestbedError) as raised:
        hall_with_person()
    pattern = re.escape(told).replace(re.escape(".*"), ".*")
    assert re.search(pattern, str(raised.value))
    assert "\n" not in str(raised.value)


HEAD = "name: p\nstart: [0, 0, 0]\nboxes: [{center: [3, 3], size: [1, 1]}]\n"


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("pedestrians: 3\n", "pedestrians: 3; must be a list"),
        ("pedestrians: [3]\n", "pedestrians[0]: 3; must be keys and values: waypoints, speed"),
        ("pedestrians: [{speed: 1}]\n", "pedestrians[0]: waypoints: missing"),
        (
            "pedestrians: [{waypoints: [[1, 1], 2]}]\n",
            "pedestrians[0]: waypoints[1]: 2; must be two",
        ),
        ("pedestrians: [{waypoints: [[1, 1], [2, 2]], speed: fast}]\n", "speed: 'fast'; must be a"),
        ("pedestrians: [{waypoints: [[1, 1], [2, 2]], speed: 9}]\n", "pedestrians[0]: speed: 9.0"),
        ("pedestrians: [{waypoints: [[1, 1], [2, 2]], yaw_deg: 9}]\n", "yaw_deg: unknown key"),
        ("pedestrians: [{waypoints: [[1, 1], [5, 5]]}]\n", "pedestrians[0]: waypoints: near"),
    ],
)
def test_a_wrong_pedestrian_in_a_file_is_told_with_file_and_place(text, told, tmp_path) -> None:
    path = tmp_path / "bad.yaml"
    path.write_text(HEAD + text)
    with pytest.raises(TestbedError) as raised:
        read_plan(path)
    assert str(raised.value).startswith(f"{path}: ")
    assert told in str(raised.value)
    assert "\n" not in str(raised.value)


def test_people_are_written_and_read_back_equal(tmp_path) -> None:
    plan = load_world("pedestrian_hall")
    write_plan(plan, tmp_path / "hall.yaml")
    assert read_plan(tmp_path / "hall.yaml") == plan
    assert len(plan.pedestrians) == 3
    assert all(0.5 <= person.speed <= 1.2 for person in plan.pedestrians)
