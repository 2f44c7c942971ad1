"""``burger scenario``: lists scenarios, runs them and judges them."""

from dataclasses import dataclass, field
from datetime import datetime
from pathlib import Path
from typing import Annotated, Any

from tqdm import tqdm
from tyro.conf import Positional

from evaluation.kernels.warm_up import kernels_of_mapper
from evaluation.run_folder import run_folder
from evaluation.scenarios.catalogue import ScenarioSet, built_in_scenarios, gather
from evaluation.scenarios.file import check_scenario
from evaluation.scenarios.junit import write_junit
from evaluation.scenarios.run import ScenarioRun, ScenarioRuns, run_scenarios
from mapping.errors import TestbedError
from scripts.arguments import is_terminal, parse, run_action
from scripts.first_run import compile_if_needed

INTERRUPTED = 130


@dataclass(frozen=True, kw_only=True)
class List:
    """List the built-in scenarios."""


@dataclass(frozen=True, kw_only=True)
class Run:
    """Run scenarios: a run folder a seed, a table, junit.xml; status 1 if a criterion is missed."""

    names: Annotated[tuple[str, ...], Positional] = field(default=())
    """Built-in scenarios by name, or scenario files; all built-in ones without any."""
    seeds: int | None = None
    """So many seeds of each; without it as many as each asks for."""
    jobs: int = 1
    """How many episodes run at the same time."""
    mapper: str | None = None
    """Mapper of all, in place of their own."""
    out: Path = Path("runs/scenarios")
    """Folder for the run folders, SCENARIO/seedN, and junit.xml."""


def run(arguments: list[str]) -> int:
    """Run the verb's own verb: list or run."""
    return run_action("scenario", {"list": _list, "run": _run}, arguments)


def _list(arguments: list[str]) -> int:
    parse(List, "scenario list", arguments)
    for scenario in built_in_scenarios():
        print(f"{scenario.name:<18} {len(scenario.seeds)} seeds   {scenario.description}")
    return 0


def _run(arguments: list[str]) -> int:
    """Run scenarios; 0 when all pass, 1 when one does not, 130 on Ctrl-C."""
    options = parse(Run, "scenario run", arguments)
    scenarios = gather(options.names, mapper=options.mapper, seeds=options.seeds)
    if options.jobs < 1:
        raise TestbedError(f"--jobs: {options.jobs}; must be 1 or more")
    every = {each.name: each for each in (*scenarios.asked, *scenarios.others.values())}
    for scenario in every.values():
        check_scenario(scenario)
    junit = options.out / "junit.xml"
    with run_folder(options.out):
        junit.unlink(missing_ok=True)  # an earlier one would vouch for this run
        for mapper in sorted({each.episode.mapper for each in every.values()}):
            compile_if_needed(kernels_of_mapper(mapper, simulates=True))
        started = datetime.now()
        runs = _watch(scenarios, options)
        write_junit(junit, runs.runs, started=started)
    _tell_end(runs, options.out)
    if runs.interrupted:
        return INTERRUPTED
    return 0 if runs.passed else 1


def _watch(scenarios: ScenarioSet, options: Run) -> ScenarioRuns:
    """Run them, printing a row each as they end, with a bar below if there is a terminal."""
    print(_row(HEADINGS), flush=True)
    total = sum(len(each.seeds) for each in scenarios.asked)
    with tqdm(total=total, unit="run", disable=not is_terminal(), leave=False) as bar:

        def tell(run: ScenarioRun) -> None:
            tqdm.write(_row(_cells(run)))
            bar.update()

        return run_scenarios(scenarios, options.out, processes=options.jobs, on_run=tell)


def _tell_end(runs: ScenarioRuns, out: Path) -> None:
    passed = sum(run.passed for run in runs.runs)
    early = "interrupted: " if runs.interrupted else ""
    print(f"{early}{passed} of {len(runs.runs)} passed; run folders and junit.xml are in {out}/")


HEADINGS = (
    *("scenario", "seed", "stop", "coverage", "t95 s", "t99 s", "t_ref95", "effic.", "contacts"),
    *("home m", "f1_5cm", "x real", ""),
)

WIDTHS = (17, 4, 17, 8, 6, 6, 7, 6, 8, 6, 6, 6, 0)


def _cells(run: ScenarioRun) -> tuple[str, ...]:
    """A run's cells of the table."""
    if run.result is None:
        gaps = ("-",) * (len(HEADINGS) - 4)
        return run.scenario.name, str(run.seed), "broke off", *gaps, run.failure or ""
    figures = (
        *(("coverage", ".4f"), ("t95_s", ".0f"), ("t99_s", ".0f"), ("t_ref95_s", ".0f")),
        *(("efficiency", ".2f"), ("contacts", "d"), ("home_distance_m", ".2f")),
        *(("f1_5cm", ".3f"), ("real_time_factor", ".0f")),
    )
    return (
        run.scenario.name,
        str(run.seed),
        str(run.result["stop_reason"]),
        *(_shown(run.result.get(key), form) for key, form in figures),
        "passed" if run.passed else "; ".join(run.missed),
    )


def _shown(value: Any, form: str) -> str:
    return "-" if value is None else format(value, form)


def _row(cells: tuple[str, ...]) -> str:
    first, *others, last = cells
    middle = " ".join(f"{cell:>{width}}" for cell, width in zip(others, WIDTHS[1:], strict=False))
    return f"{first:<{WIDTHS[0]}} {middle}   {last}".rstrip()
