"""Finds scenarios by name or file, and those that their criteria compare with."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from assets import ROOT
from evaluation.scenarios.criterion import Criterion
from evaluation.scenarios.file import read_scenario
from evaluation.scenarios.scenario import Scenario
from evaluation.scenarios.yaml_lines import nearest
from mapping.errors import TestbedError
from mapping.mappers import MAPPERS

SCENARIOS = Path(str(ROOT)) / "scenarios"
"""Folder of the built-in scenarios, one YAML each."""


@dataclass(frozen=True, slots=True, kw_only=True)
class ScenarioSet:
    """Scenarios to be judged, and others that are only run because criteria compare with them."""

    asked: tuple[Scenario, ...]
    others: dict[tuple[str, str], Scenario]
    """The scenario that each criterion means, by the names of its own scenario and of ``of``."""

    def compared(self, scenario: Scenario) -> dict[str, Scenario]:
        """The scenarios that one's criteria compare with, by what ``Criterion.of`` calls them."""
        return {each.of: self.others[scenario.name, each.of] for each in _ratios(scenario)}


def find_scenario(name_or_path: str | Path, folder: Path = Path()) -> Scenario:
    """A built-in scenario by its name, or that of a file.

    A built-in name wins over a file of the same name; write ``./name`` for the file.

    Args:
        name_or_path: The name, or the file.
        folder: Where a file's relative name starts.

    Raises:
        TestbedError: There is no such scenario, or its file cannot be used.
    """
    name = str(name_or_path)
    built_in = SCENARIOS / f"{name}.yaml"
    if built_in.is_file() and name == Path(name).name:
        return read_scenario(built_in)
    path = folder / name_or_path
    if path.is_file():
        return read_scenario(path)
    names = [each.stem for each in _files()]
    what = "is a folder" if path.is_dir() else "no such scenario or file"
    raise TestbedError(
        f"scenario: {name!r}: {what}; {nearest(name, names)}"
        f"must be a YAML file or a built-in one: {', '.join(names)}"
    )


def built_in_scenarios() -> tuple[Scenario, ...]:
    """Every built-in scenario, in the order of their names."""
    return tuple(map(read_scenario, _files()))


def gather(
    names: Sequence[str], *, mapper: str | None = None, seeds: int | None = None
) -> ScenarioSet:
    """The scenarios of some names or files, of none all built-in ones.

    Args:
        names: Names or files.
        mapper: Runs every scenario with this mapper instead of its own.
        seeds: Runs every scenario with so many seeds.

    Raises:
        TestbedError: One does not exist or cannot be used, or two have one name.
    """
    if mapper is not None and mapper not in MAPPERS:
        raise TestbedError(f"mapper: {mapper!r}; must be one of {', '.join(MAPPERS)}")
    found = tuple(map(find_scenario, names)) if names else built_in_scenarios()
    asked = tuple(_altered(each, mapper, seeds) for each in found)
    by_name: dict[str, Scenario] = {}
    for scenario in asked:
        if _entered(scenario, by_name) is not scenario:
            raise TestbedError(f"scenario: {scenario.name!r}: asked for twice; must be once")
    others = {}
    for scenario in asked:
        folder = scenario.source.parent if scenario.source else Path()
        for criterion in _ratios(scenario):
            other = _altered(find_scenario(criterion.of, folder), mapper, None)
            others[scenario.name, criterion.of] = _entered(other, by_name)
    return ScenarioSet(asked=asked, others=others)


def _files() -> list[Path]:
    return sorted(SCENARIOS.glob("*.yaml"))


def _ratios(scenario: Scenario) -> list[Criterion]:
    return [criterion for criterion in scenario.criteria if criterion.of]


def _altered(scenario: Scenario, mapper: str | None, seeds: int | None) -> Scenario:
    """The same with another mapper and number of seeds, where they are given."""
    if mapper is not None:
        scenario = scenario.with_mapper(mapper)
    return scenario if seeds is None else scenario.with_seeds(seeds)


def _entered(scenario: Scenario, by_name: dict[str, Scenario]) -> Scenario:
    """The scenario of this name, which is now this one if there was none."""
    entered = by_name.setdefault(scenario.name, scenario)
    sources = {each.source and each.source.resolve() for each in (entered, scenario)}
    if len(sources) > 1:
        raise TestbedError(
            f"name: {scenario.name!r}: is that of {entered.source} and of {scenario.source}; "
            "must differ, as their run folders do"
        )
    return entered
