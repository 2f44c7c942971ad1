"""The built-in scenarios: a few of them with one seed, or all with all seeds (``-m full``)."""

from pathlib import Path

import pytest

from evaluation.scenarios.catalogue import SCENARIOS, gather
from evaluation.scenarios.run import run_scenarios

SHORT = ("turtlebot3_world", "narrow_door", "dropouts", "cluttered_office")
"""Pillars, a door hardly wider than the robot, a bad lidar among furniture (and a good one, to be
compared with), chair legs: the least that tells that exploring still works."""

ALL = [path.stem for path in sorted(SCENARIOS.glob("*.yaml"))]


@pytest.mark.parametrize("name", SHORT)
def test_a_scenario_of_the_short_set_passes_with_its_first_seed(name: str, tmp_path: Path) -> None:
    assert missed(name, tmp_path, seeds=1) == {}


@pytest.mark.full
@pytest.mark.parametrize("name", ALL)
def test_a_scenario_passes_with_all_its_seeds(name: str, tmp_path: Path) -> None:
    assert missed(name, tmp_path) == {}


def missed(name: str, out: Path, seeds: int | None = None) -> dict[int, tuple[str, ...]]:
    """What each seed that did not pass missed."""
    runs = run_scenarios(gather([name], seeds=seeds), out).runs
    assert runs
    return {run.seed: (*run.missed, run.failure or "") for run in runs if not run.passed}
