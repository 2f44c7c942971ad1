"""Running scenarios: in order, once each, and what has ended is kept."""

from collections.abc import Callable
from pathlib import Path
from typing import Any
from unittest.mock import patch

import pytest

from evaluation.episode_pool import Failure, Job, Outcome
from evaluation.scenarios.catalogue import (
    SCENARIOS,
    ScenarioSet,
    built_in_scenarios,
    find_scenario,
    gather,
)
from evaluation.scenarios.run import ScenarioRun, ScenarioRuns, run_scenarios
from mapping.errors import TestbedError
from tests.evaluation.scenarios.scenario_files import good_result, write_scenario

NO_REGION = (
    ("  coverage_in.corner: {min: 0.99}\n", ""),
    ("regions:\n  corner: [0, 0, 1, 1]\n", ""),
)
RATIO = ("coverage: {min: 0.9}", "t99_s: {max_ratio: 1.5, of: first.yaml}")


def canned(
    scenarios: ScenarioSet,
    outcome: Callable[[str, int], Outcome],
    *,
    order: Callable[[list[int]], list[int]] = list,
    stop_after: int | None = None,
) -> tuple[ScenarioRuns, list[ScenarioRun], list[tuple[str, int]]]:
    """Run scenarios whose outcomes are made up; returns as well what was told, and was run."""
    told: list[ScenarioRun] = []
    done: list[tuple[str, int]] = []

    def run(jobs: list[Job], *, processes: int, on_done: Callable[[int, Outcome], None]) -> None:
        for count, index in enumerate(order(list(range(len(jobs))))):
            if count == stop_after:
                raise KeyboardInterrupt
            config, folder = jobs[index]
            done.append((folder.parent.name, config.seed))
            on_done(index, outcome(*done[-1]))

    with patch("evaluation.scenarios.run.run_episodes", run):
        runs = run_scenarios(scenarios, Path("out"), on_run=told.append)
    return runs, told, done


@pytest.fixture
def two(tmp_path: Path) -> ScenarioSet:
    """A scenario, and one that compares with it."""
    write_scenario(tmp_path, *NO_REGION, ("name: mine", "name: first"), name="first.yaml")
    second = write_scenario(
        tmp_path, *NO_REGION, RATIO, ("name: mine", "name: second"), name="second.yaml"
    )
    return gather([str(second), str(tmp_path / "first.yaml")])


def named(runs: tuple[ScenarioRun, ...] | list[ScenarioRun]) -> list[tuple[str, int]]:
    return [(run.scenario.name, run.seed) for run in runs]


IN_ORDER = [("second", 0), ("second", 1), ("first", 0), ("first", 1)]


def good(name: str, seed: int) -> dict[str, Any]:
    return good_result(t99_s=60.0)


def test_whatever_ends_first_the_runs_come_in_order(two: ScenarioSet) -> None:
    runs, told, done = canned(two, good, order=lambda jobs: jobs[::-1])
    assert named(runs.runs) == named(told) == IN_ORDER
    assert sorted(done) == sorted(IN_ORDER), "what is asked for and compared with runs once"
    assert runs.passed
    assert runs.runs[1].folder == Path("out/second/seed1")


def test_a_scenario_that_was_not_asked_for_runs_only_for_the_comparison(tmp_path: Path) -> None:
    write_scenario(tmp_path, *NO_REGION, ("name: mine", "name: first"), name="first.yaml")
    path = write_scenario(tmp_path, *NO_REGION, RATIO, ("seeds: 2", "seeds: [9]"))

    def outcome(name: str, seed: int) -> Outcome:
        return good_result(t99_s=10.0 if name == "first" else 16.0)

    runs, _, done = canned(gather([str(path)], mapper="ogm"), outcome)
    assert done == [("first", 9), ("mine", 9)], "with the same seed"
    assert named(runs.runs) == [("mine", 9)]
    assert runs.runs[0].missed == ("t99_s 16, must be at most 1.5 x first.yaml's 10 = 15",)
    assert not runs.passed


def test_a_run_that_broke_off_fails_and_so_does_what_is_compared_with_it(two: ScenarioSet) -> None:
    def outcome(name: str, seed: int) -> Outcome:
        return Failure(reason="out of luck") if (name, seed) == ("first", 1) else good(name, seed)

    runs, _, _ = canned(two, outcome)
    assert [run.passed for run in runs.runs] == [True, False, True, False]
    assert runs.runs[3].failure == "out of luck"
    assert "must be at most 1.5 x first.yaml's null" in runs.runs[1].missed[0]


def test_ctrl_c_keeps_what_has_ended(two: ScenarioSet) -> None:
    # In the order of the jobs: first 0, second 0, first 1, second 1; the third is the last to end.
    runs, told, _ = canned(two, good, stop_after=3)
    assert runs.interrupted
    assert not runs.passed
    assert named(told) == [("second", 0)]
    assert named(runs.runs) == [("second", 0), ("first", 0), ("first", 1)]


def test_two_scenarios_of_one_name_would_share_their_folders(tmp_path: Path) -> None:
    one = write_scenario(tmp_path, name="one.yaml")
    other = write_scenario(tmp_path, name="other.yaml")
    with pytest.raises(TestbedError, match=r"name: 'mine': is that of .*one.* and of .*other"):
        gather([str(one), str(other)])
    with pytest.raises(TestbedError, match="asked for twice"):
        gather([str(one), str(one)])


def test_the_number_of_seeds_and_the_mapper_can_be_set_for_all(tmp_path: Path) -> None:
    scenarios = gather(["dropouts"], mapper="ogm", seeds=2)
    assert scenarios.asked[0].seeds == (0, 1)
    compared = scenarios.compared(scenarios.asked[0])["lim_room"]
    assert {compared.episode.mapper, scenarios.asked[0].episode.mapper} == {"ogm"}


def test_an_unknown_scenario_is_answered_with_the_nearest() -> None:
    with pytest.raises(TestbedError, match=r"'lim_rom': no such .* did you mean lim_room\?"):
        find_scenario("lim_rom")


def test_the_built_in_scenarios_are_those_of_their_files_and_compare_with_each_other() -> None:
    scenarios = built_in_scenarios()
    names = [scenario.name for scenario in scenarios]
    assert names == [path.stem for path in sorted(SCENARIOS.glob("*.yaml"))]
    assert len(gather([]).asked) == len(names)
    for scenario in scenarios:
        assert len(scenario.seeds) == 5
        assert scenario.description
