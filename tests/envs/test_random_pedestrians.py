"""Random people walk where there is room for them, the same for the same seed."""

import dataclasses
import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from envs.burger_env import BurgerEnv
from envs.floor_plan import FloorPlan, Wall
from envs.pedestrians import LEG_RADIUS, feet_at, gaits_of
from envs.random_pedestrians import SPEEDS, START_ROOM, random_pedestrians
from envs.solids import distance
from envs.worlds import load_world
from mapping.errors import TestbedError

WORLDS = ("lim_room", "narrow_door", "turtlebot3_world", "cluttered_office", "apartment")


@pytest.mark.parametrize("world", WORLDS)
def test_random_people_fit_any_world(world: str) -> None:
    plan = load_world(world)
    people = random_pedestrians(plan, 3, np.random.default_rng(1))
    # A plan refuses walks that touch anything.
    assert len(dataclasses.replace(plan, pedestrians=people).pedestrians) == 3
    assert all(SPEEDS[0] <= person.speed <= SPEEDS[1] for person in people)
    assert all(person.length > 1.5 for person in people)


@given(seed=st.integers(0, 2**31))
@settings(max_examples=8)
def test_no_leg_is_ever_in_a_solid_or_near_the_robot_at_time_0(seed: int) -> None:
    plan = load_world("lim_room")
    gaits = gaits_of(random_pedestrians(plan, 2, np.random.default_rng(seed)))
    feet = [feet_at(gaits, time) for time in np.arange(0.0, 20.0, 0.37).tolist()]
    solids = plan.solids()
    assert all(
        distance(solid, foot) >= LEG_RADIUS for at in feet for foot in at for solid in solids
    )
    assert min(math.dist(foot, plan.start[:2]) for foot in feet[0]) >= START_ROOM


def test_people_walk_in_the_room_that_the_episode_starts_in() -> None:
    rooms = tuple(
        Wall(points=((x, 0.0), (x + 4.0, 0.0), (x + 4.0, 3.0), (x, 3.0)), closed=True)
        for x in (0.0, 5.0)
    )
    env = BurgerEnv(FloorPlan(name="two", start=(1.0, 1.0, 0.0), walls=rooms), people=2)
    for x in (1.0, 6.0):
        _, info = env.reset(seed=1, options={"start": (x, 1.0, 0.0)})
        assert np.all(np.abs(info["pedestrians"][:, 0] - x - 1.0) < 2.0)


def test_the_same_seed_draws_the_same_people() -> None:
    plan = load_world("lim_room")
    first, again, other = (
        random_pedestrians(plan, 2, np.random.default_rng(seed)) for seed in (3, 3, 4)
    )
    assert first == again != other


def test_a_closet_has_no_room_for_a_walk() -> None:
    ring = ((-0.3, -0.3), (0.3, -0.3), (0.3, 0.3), (-0.3, 0.3))
    closet = FloorPlan(
        name="closet", start=(0.0, 0.0, 0.0), walls=(Wall(points=ring, closed=True),)
    )
    with pytest.raises(TestbedError, match="people: no room for a walk in closet"):
        random_pedestrians(closet, 1, np.random.default_rng(0))


@pytest.mark.parametrize("count", [-1, 1000])
def test_a_count_that_is_no_crowd_is_refused(count: int) -> None:
    with pytest.raises(TestbedError, match=r"people: .* must be from 0 to 100"):
        BurgerEnv("lim_room", people=count)


def test_an_environment_with_people_tells_where_they_are_and_repeats_itself() -> None:
    env = BurgerEnv("pedestrian_hall", people=2)
    first, info = env.reset(seed=5)
    assert info["pedestrians"].shape == (5, 2)
    later = env.step(np.zeros(2, np.float32))[4]["pedestrians"]
    moved = np.hypot(*(later - info["pedestrians"]).T)
    assert np.all((moved > 0.02) & (moved < 0.13))  # 0.1 s at 0.5 to 1.2 m/s, less in corners
    again, info_again = env.reset(seed=5)
    assert first["ranges"].tobytes() == again["ranges"].tobytes()
    np.testing.assert_array_equal(info["pedestrians"], info_again["pedestrians"])
    _, info_other = env.reset(seed=6)
    assert not np.array_equal(info["pedestrians"][3:], info_other["pedestrians"][3:])
    np.testing.assert_array_equal(info["pedestrians"][:3], info_other["pedestrians"][:3])


def test_without_people_nothing_is_told_of_any() -> None:
    assert BurgerEnv("empty_room").reset(seed=0)[1]["pedestrians"].shape == (0, 2)
