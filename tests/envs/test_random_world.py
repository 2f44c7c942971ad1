"""Names of random worlds: what they ask for, how they are refused, ranges of them."""

import pytest

from envs.random_world import RandomWorld, expand_worlds, parse_random_world
from mapping.errors import TestbedError


def test_a_seed_alone_leaves_all_else_to_chance() -> None:
    assert parse_random_world("random:7") == RandomWorld(seed=7)


def test_options_fix_rooms_area_and_style_in_any_order() -> None:
    asked = RandomWorld(seed=7, rooms=6, area=120.5, style="office")
    assert parse_random_world("random:7,rooms=6,area=120.5,style=office") == asked
    assert parse_random_world("random:7,style=office,area=120.5,rooms=6") == asked


def test_different_wishes_have_different_names_fit_for_files() -> None:
    spelt = ("random:7", "random:7,rooms=6", "random:7,area=60", "random:7,style=hall", "random:76")
    names = [parse_random_world(each).name for each in spelt]
    assert len(set(names)) == len(spelt)
    assert not any(set(name) & set(":,=/ ") for name in names)


@pytest.mark.parametrize(
    ("name", "told"),
    [
        ("random:", "seed ''"),
        ("random:x", "seed 'x'"),
        ("random:-1", "seed '-1'"),
        ("random:1.5", "seed '1.5'"),
        ("random:7,", "'' is no option"),
        ("random:7,size=3", "'size=3' is no option"),
        ("random:7,rooms", "'rooms' is no option"),
        ("random:7,rooms=six", "rooms 'six'"),
        ("random:7,rooms=3,rooms=4", "rooms stands twice"),
        ("random:7,rooms=1", "rooms: 1; must be 2 to 15"),
        ("random:7,rooms=16", "rooms: 16; must be 2 to 15"),
        ("random:7,area=29", "area: 29 m2; must be 30 to 450"),
        ("random:7,area=nan", "area 'nan'"),
        ("random:7,style=castle", "style: 'castle'; must be one of apartment, office, hall"),
        ("random:7,rooms=15,area=40", "must be 60 m2 or more for 15 rooms"),
        ("random:7,area=40,style=hall", "must be 50 m2 or more for style hall"),
        ("random:0..9", "a range is for burger sweep"),
    ],
)
def test_what_cannot_be_read_is_refused_in_one_line(name: str, told: str) -> None:
    with pytest.raises(TestbedError) as refusal:
        parse_random_world(name)
    assert told in str(refusal.value)
    assert name in str(refusal.value)
    assert "\n" not in str(refusal.value)


def test_a_range_is_every_seed_of_it_with_the_same_wishes() -> None:
    worlds = expand_worlds(("lim_room", "random:8..11,rooms=4", "random:3", "plan.yaml"))
    ranged = tuple(f"random:{seed},rooms=4" for seed in (8, 9, 10, 11))
    assert worlds == ("lim_room", *ranged, "random:3", "plan.yaml")
    assert expand_worlds(("random:5..5",)) == ("random:5",)


@pytest.mark.parametrize("name", ["random:9..0", "random:0..10000"])
def test_a_range_that_counts_down_or_never_ends_is_refused(name: str) -> None:
    with pytest.raises(TestbedError, match="must count up"):
        expand_worlds((name,))
