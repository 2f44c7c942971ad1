"""A scenario: an episode, the seeds it is run with, and what its results must reach."""

import re
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

from evaluation.episode import EpisodeConfig
from evaluation.scenarios.criterion import COVERAGE_IN, Criterion
from evaluation.scenarios.yaml_lines import nearest
from evaluation.seed_count import check_seed_count
from mapping.errors import TestbedError

DEFAULT_SEEDS = (0, 1, 2, 3, 4)

BASE_CRITERIA = (
    Criterion(key="stop_reason", bound="is", value="complete"),
    Criterion(key="contacts", bound="max", value=0),
    Criterion(key="home_distance_m", bound="max", value=0.3),
    Criterion(key="false_free", bound="max", value=0.01),
    Criterion(key="map_reloads", bound="is", value=True),
)
"""What every scenario asks for, but for keys that it sets bounds on itself."""

NAME = re.compile(r"[A-Za-z0-9][\w.-]*")
"""A scenario's name is that of a folder as well."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Region:
    """An upright rectangle of the world."""

    left: float
    """Least x [m]."""
    bottom: float
    """Least y [m]."""
    right: float
    top: float

    def __post_init__(self) -> None:
        """Refuse a rectangle without area."""
        if not (self.left < self.right and self.bottom < self.top):
            raise TestbedError(
                f"[{self.left:g}, {self.bottom:g}, {self.right:g}, {self.top:g}]; "
                "must be [xmin, ymin, xmax, ymax] [m] with xmin < xmax and ymin < ymax"
            )


@dataclass(frozen=True, slots=True, kw_only=True)
class Scenario:
    """Episodes that differ by their seed alone, and the criteria that each of them must meet."""

    name: str
    episode: EpisodeConfig
    """What is run; its seed stands for each of ``seeds``."""
    description: str = ""
    """One line that says what the scenario is about."""
    seeds: tuple[int, ...] = DEFAULT_SEEDS
    own_criteria: tuple[Criterion, ...] = ()
    """Its criteria but for those that all scenarios share."""
    regions: Mapping[str, Region] = field(default_factory=dict)
    """Parts of the world, by the names that criteria ``coverage_in.NAME`` use."""
    source: Path | None = None
    """The file it was read from."""

    def __post_init__(self) -> None:
        """Refuse what cannot be run or judged."""
        if not NAME.fullmatch(self.name):
            raise TestbedError(
                f"name: {self.name!r}; must be letters, digits, _ . and -, a letter or digit first"
            )
        if not self.seeds or min(self.seeds) < 0 or len(set(self.seeds)) < len(self.seeds):
            raise TestbedError(f"seeds: {list(self.seeds)}; must be different numbers, 0 or more")
        for criterion in self.own_criteria:
            region = criterion.key.removeprefix(COVERAGE_IN)
            if region != criterion.key and region not in self.regions:
                raise TestbedError(
                    f"criteria: {criterion.key}: unknown region; {nearest(region, self.regions)}"
                    f"must be one of regions ({', '.join(self.regions) or 'there are none'})"
                )

    @property
    def criteria(self) -> tuple[Criterion, ...]:
        """All criteria: those of every scenario, unless it bounds their key itself, and its own."""
        own = {criterion.key for criterion in self.own_criteria}
        shared = tuple(each for each in BASE_CRITERIA if each.key not in own)
        return shared + self.own_criteria

    def config(self, seed: int) -> EpisodeConfig:
        """The episode of one seed."""
        return replace(self.episode, seed=seed)

    def with_seeds(self, count: int) -> "Scenario":
        """The same with so many seeds: its own first, then the numbers after the largest of them.

        Raises:
            TestbedError: If ``check_seed_count`` refuses the count.
        """
        check_seed_count(count)
        more = range(max(self.seeds) + 1, max(self.seeds) + 1 + count)
        return replace(self, seeds=(*self.seeds, *more)[:count])

    def with_mapper(self, mapper: str) -> "Scenario":
        """The same with another mapper."""
        return replace(self, episode=replace(self.episode, mapper=mapper))


def judge(
    scenario: Scenario, result: Mapping[str, Any], others: Mapping[str, Mapping[str, Any]]
) -> tuple[str, ...]:
    """What a result missed, a criterion each: measured and required, in words.

    Args:
        scenario: What the result must reach.
        result: The content of ``result.json``, and a ``coverage_in.NAME`` for each region.
        others: Results of the same seed of the scenarios that criteria compare with, by what
            ``Criterion.of`` calls them.
    """
    told = (each.missed(result, others.get(each.of)) for each in scenario.criteria)
    return tuple(words for words in told if words)
