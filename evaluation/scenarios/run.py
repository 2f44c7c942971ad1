"""Runs scenarios, each seed into a run folder, and judges what comes of them."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from evaluation.episode_pool import Failure, Outcome, run_episodes
from evaluation.run_folder import write_json
from evaluation.scenarios.catalogue import ScenarioSet
from evaluation.scenarios.criterion import COVERAGE_IN
from evaluation.scenarios.region_coverage import region_coverages
from evaluation.scenarios.scenario import Scenario, judge

_Key = tuple[str, int]
"""A scenario's name and a seed."""


@dataclass(frozen=True, slots=True, kw_only=True)
class ScenarioRun:
    """What came of one seed of a scenario."""

    scenario: Scenario
    seed: int
    folder: Path
    """Its run folder."""
    result: dict[str, Any] | None
    """The content of ``result.json``; None when the run broke off."""
    missed: tuple[str, ...] = ()
    """The criteria that were missed, in words."""
    failure: str | None = None
    """Why the run broke off, if it did."""

    @property
    def passed(self) -> bool:
        """Whether the run ended and met every criterion."""
        return self.failure is None and not self.missed

    @property
    def wall_time(self) -> float:
        """How long the episode took [s]; 0 when it broke off."""
        return 0.0 if self.result is None else float(self.result["wall_time_s"])


@dataclass(frozen=True, slots=True, kw_only=True)
class ScenarioRuns:
    """Runs in the order of their scenarios and seeds."""

    runs: tuple[ScenarioRun, ...]
    interrupted: bool
    """Whether Ctrl-C ended them early: then those that had not ended are missing."""

    @property
    def passed(self) -> bool:
        """Whether all were run and all passed."""
        return not self.interrupted and all(run.passed for run in self.runs)


def run_scenarios(
    scenarios: ScenarioSet,
    out: Path,
    *,
    processes: int = 1,
    on_run: Callable[[ScenarioRun], None] | None = None,
) -> ScenarioRuns:
    """Run every seed of every scenario that was asked for, and what their criteria compare with.

    Run folders are ``OUT/SCENARIO/seedN``. Ctrl-C ends the runs under way and keeps the others.

    Args:
        scenarios: What to run.
        out: Folder of the run folders.
        processes: How many episodes run at the same time.
        on_run: Called with each run that is judged, in the order of scenarios and seeds.

    Raises:
        TestbedError: If ``processes`` is not positive.
    """
    planned = _planned(scenarios)
    jobs = [(each.config(seed), out / each.name / f"seed{seed}") for each, seed in planned]
    outcomes: dict[_Key, Outcome] = {}
    told: list[ScenarioRun] = []
    waiting = [(each, seed) for each in scenarios.asked for seed in each.seeds]

    def note(index: int, outcome: Outcome) -> None:
        scenario, seed = planned[index]
        outcomes[scenario.name, seed] = _with_regions(scenario, jobs[index][1], outcome)
        while waiting and _is_known(*waiting[0], scenarios, outcomes):
            told.append(_judged(*waiting.pop(0), scenarios, outcomes, out))
            if on_run is not None:
                on_run(told[-1])

    try:
        run_episodes(jobs, processes=processes, on_done=note)
    except KeyboardInterrupt:
        late = [each for each in waiting if _is_known(*each, scenarios, outcomes)]
        told.extend(_judged(*each, scenarios, outcomes, out) for each in late)
        return ScenarioRuns(runs=tuple(told), interrupted=True)
    return ScenarioRuns(runs=tuple(told), interrupted=False)


def _planned(scenarios: ScenarioSet) -> list[tuple[Scenario, int]]:
    """Every scenario and seed to run, once each, what is compared with before what compares."""
    planned: dict[_Key, tuple[Scenario, int]] = {}
    for scenario in scenarios.asked:
        for seed in scenario.seeds:
            for each in (*scenarios.compared(scenario).values(), scenario):
                planned.setdefault((each.name, seed), (each, seed))
    return list(planned.values())


def _with_regions(scenario: Scenario, folder: Path, outcome: Outcome) -> Outcome:
    """The outcome with the coverage of each region, which its ``result.json`` then has as well."""
    if isinstance(outcome, Failure) or not scenario.regions:
        return outcome
    coverages = region_coverages(folder, scenario.episode.world, scenario.regions)
    result = outcome | {f"{COVERAGE_IN}{name}": value for name, value in coverages.items()}
    write_json(folder / "result.json", result)
    return result


def _keys(scenario: Scenario, seed: int, scenarios: ScenarioSet) -> Iterator[_Key]:
    """What must have ended before a run can be judged."""
    yield scenario.name, seed
    for other in scenarios.compared(scenario).values():
        yield other.name, seed


def _is_known(
    scenario: Scenario, seed: int, scenarios: ScenarioSet, outcomes: dict[_Key, Outcome]
) -> bool:
    return all(key in outcomes for key in _keys(scenario, seed, scenarios))


def _judged(
    scenario: Scenario,
    seed: int,
    scenarios: ScenarioSet,
    outcomes: dict[_Key, Outcome],
    out: Path,
) -> ScenarioRun:
    folder = out / scenario.name / f"seed{seed}"
    outcome = outcomes[scenario.name, seed]
    if isinstance(outcome, Failure):
        return ScenarioRun(
            scenario=scenario, seed=seed, folder=folder, result=None, failure=outcome.reason
        )
    others = {
        of: found
        for of, other in scenarios.compared(scenario).items()
        if not isinstance(found := outcomes[other.name, seed], Failure)
    }
    missed = judge(scenario, outcome, others)
    return ScenarioRun(scenario=scenario, seed=seed, folder=folder, result=outcome, missed=missed)
