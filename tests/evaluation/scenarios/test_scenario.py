"""Judging: what meets a criterion, what misses it, and how that is told."""

from pathlib import Path

import pytest

from evaluation.episode import EpisodeConfig, run_episode
from evaluation.kernels.warm_up import TINY_ROOM
from evaluation.result import result_of
from evaluation.scenarios.criterion import FLAGS, NUMBERS, TEXTS, Criterion
from evaluation.scenarios.file import read_scenario
from evaluation.scenarios.scenario import Scenario, judge
from tests.evaluation.scenarios.scenario_files import good_result, write_scenario


@pytest.fixture
def scenario(tmp_path: Path) -> Scenario:
    return read_scenario(write_scenario(tmp_path))


def test_a_result_on_every_bound_passes(scenario: Scenario) -> None:
    assert judge(scenario, good_result(coverage=0.9, t95_s=65, home_distance_m=0.3), {}) == ()


@pytest.mark.parametrize(
    ("changes", "told"),
    [
        ({"coverage": 0.8}, "coverage 0.8, must be at least 0.9"),
        ({"coverage": 0.89999999}, "coverage 0.89999999, must be at least 0.9"),
        ({"t95_s": 65.5}, "t95_s 65.5, must be at most 65"),
        ({"coverage_in.corner": 0.5}, "coverage_in.corner 0.5, must be at least 0.99"),
        ({"stop_reason": "stuck"}, "stop_reason stuck, not complete"),
        ({"contacts": 1}, "contacts 1, must be at most 0"),
        ({"home_distance_m": 0.31}, "home_distance_m 0.31, must be at most 0.3"),
        ({"false_free": 0.02}, "false_free 0.02, must be at most 0.01"),
        ({"map_reloads": False}, "map_reloads false, not true"),
    ],
)
def test_a_missed_criterion_tells_what_was_measured_and_what_is_required(
    changes: dict[str, object], told: str, scenario: Scenario
) -> None:
    assert judge(scenario, good_result(**changes), {}) == (told,)


@pytest.mark.parametrize("key", ["coverage", "t95_s", "stop_reason", "map_reloads", "contacts"])
def test_a_value_that_does_not_exist_meets_no_criterion(key: str, scenario: Scenario) -> None:
    for result in (good_result(**{key: None}), good_result()):
        if result[key] is not None:
            del result[key]
        told = judge(scenario, result, {})
        assert told
        assert all(words.startswith(f"{key} null") for words in told)


def test_every_missed_criterion_is_told(scenario: Scenario) -> None:
    assert len(judge(scenario, good_result(coverage=0.1, t95_s=None, contacts=3), {})) == 4


def test_a_ratio_is_held_against_the_other_scenarios_result() -> None:
    ratio = Criterion(key="t99_s", bound="max_ratio", value=1.5, of="lim_room")
    other = {"t99_s": 80.0}
    assert ratio.missed({"t99_s": 120.0}, other) == ""
    assert (
        ratio.missed({"t99_s": 121.0}, other)
        == "t99_s 121, must be at most 1.5 x lim_room's 80 = 120"
    )
    for nothing in ({"t99_s": None}, None):
        assert (
            ratio.missed({"t99_s": 1.0}, nothing)
            == "t99_s 1, must be at most 1.5 x lim_room's null"
        )
    assert ratio.missed({"t99_s": None}, other).startswith("t99_s null")


def test_a_list_counts_for_its_length() -> None:
    none_left = Criterion(key="dropped_frontiers", bound="max", value=0)
    assert none_left.missed({"dropped_frontiers": []}) == ""
    assert none_left.missed({"dropped_frontiers": [{}]}) == "dropped_frontiers 1, must be at most 0"


def test_every_key_of_a_result_can_have_a_criterion() -> None:
    episode = run_episode(EpisodeConfig(time_limit=1.0, resolution=0.05), plan=TINY_ROOM)
    assert set(result_of(episode, map_file_kb=None)) <= {*TEXTS, *FLAGS, *NUMBERS}
