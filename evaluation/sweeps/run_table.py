"""Sums up many runs in a table: a row for each world and each variant of what was run there."""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from evaluation.sweeps.run_record import RunRecord

VARIANT_KEYS = (
    *("mapper", "navigator", "odometry", "odometry_yaw", "imu", "lidar", "people"),
    *("resolution", "gap_filling", "waypoints", "time_limit"),
)
"""What tells variants apart, as the config names it: all but the world and the seed."""

ALWAYS_SHOWN = ("mapper", "navigator")
"""Keys that stand in the table even if all runs agree."""

KEYS = ("world", *VARIANT_KEYS)
"""What runs of one row share."""

ALL_WORLDS = "all worlds"


@dataclass(frozen=True, slots=True, kw_only=True)
class RunGroup:
    """Runs that differ in their seed only, or in their world as well."""

    world: str
    variant: tuple[str, ...]
    """What the config has under VARIANT_KEYS."""
    runs: tuple[RunRecord, ...]

    @property
    def complete_share(self) -> float:
        """How many of the runs were complete; failed runs were not."""
        return sum(run.is_complete for run in self.runs) / len(self.runs)

    @property
    def contacts(self) -> int:
        """Contacts of all runs together."""
        return sum(int(run.result.get("contacts", 0)) for run in self.runs)

    def values(self, key: str) -> NDArray[np.float64]:
        """What the finished runs have under a key, sorted; empty if none has a value.

        A time that was not reached is infinite and an efficiency without one is 0: leaving such
        runs out would make a navigator look better the more it fails.
        """
        finished = [run for run in self.runs if key in run.result]
        numbers = np.array([run.number(key) for run in finished])
        if key in MISSING:
            return np.sort(np.where(np.isnan(numbers), MISSING[key], numbers))
        return np.sort(numbers[~np.isnan(numbers)])

    def median(self, key: str) -> float:
        """Median under a key; NaN without values, infinite if half of the runs never got there."""
        values = self.values(key)
        return float(np.median(values)) if len(values) else math.nan

    def least(self, key: str) -> float:
        """Least under a key; NaN without values."""
        values = self.values(key)
        return float(values[0]) if len(values) else math.nan


MISSING = {"t90_s": math.inf, "t95_s": math.inf, "t99_s": math.inf, "efficiency": 0.0}
"""What stands for a value that a run did not reach."""


def _figure(digits: int) -> Callable[[float], str]:
    return lambda value: f"{value:.{digits}f}" if math.isfinite(value) else "-"


_UNIT, _WHOLE, _SHARE = _figure(3), _figure(0), _figure(2)

COLUMNS: tuple[tuple[str, Callable[[RunGroup], str]], ...] = (
    ("runs", lambda group: str(len(group.runs))),
    ("complete", lambda group: f"{group.complete_share:.0%}"),
    ("contacts", lambda group: str(group.contacts)),
    ("coverage", lambda group: _UNIT(group.median("coverage"))),
    ("least", lambda group: _UNIT(group.least("coverage"))),
    ("t95 [s]", lambda group: _WHOLE(group.median("t95_s"))),
    ("efficiency", lambda group: _SHARE(group.median("efficiency"))),
    ("least", lambda group: _SHARE(group.least("efficiency"))),
    ("F1 5 cm", lambda group: _UNIT(group.median("f1_5cm"))),
    ("x real time", lambda group: _WHOLE(group.median("real_time_factor"))),
)
"""Heading and text of each figure; medians but for runs, shares, sums and what says least."""


def group_runs(runs: Sequence[RunRecord]) -> tuple[RunGroup, ...]:
    """Runs by world and variant, in the order in which they come."""
    return _grouped(runs, lambda run: run.told("world"))


def group_over_worlds(runs: Sequence[RunRecord]) -> tuple[RunGroup, ...]:
    """Runs by variant alone: what compares decision rules over worlds."""
    return _grouped(runs, lambda run: ALL_WORLDS)


def varied(groups: Sequence[RunGroup]) -> list[bool]:
    """For each of VARIANT_KEYS whether groups differ in it."""
    return [len(set(told)) > 1 for told in zip(*(each.variant for each in groups), strict=True)]


def table_of(runs: Sequence[RunRecord]) -> list[list[str]]:
    """The whole table as text: headings, a row for each group, then rows over all worlds.

    Mapper and navigator always stand in it, what else tells variants apart where it differs between
    runs; the rows over all worlds where there is more than one.
    """
    groups = list(group_runs(runs))
    if len({group.world for group in groups}) > 1:
        groups += group_over_worlds(runs)
    shown = [
        key
        for key, differs in zip(VARIANT_KEYS, varied(groups), strict=True)
        if differs or key in ALWAYS_SHOWN
    ]
    rows = [["world", *shown, *(heading for heading, _ in COLUMNS)]]
    for group in groups:
        told = dict(zip(VARIANT_KEYS, group.variant, strict=True))
        named = [told[key] for key in shown]
        rows.append([short_name(group.world), *named, *(text(group) for _, text in COLUMNS)])
    return rows


def short_name(world: str) -> str:
    """A world's name, of a file without the folders it lies in."""
    return world.rsplit("/", maxsplit=1)[-1]


def _grouped(
    runs: Sequence[RunRecord], world_of: Callable[[RunRecord], str]
) -> tuple[RunGroup, ...]:
    grouped: dict[tuple[str, tuple[str, ...]], list[RunRecord]] = {}
    for run in runs:
        variant = tuple(run.told(key) for key in VARIANT_KEYS)
        grouped.setdefault((world_of(run), variant), []).append(run)
    return tuple(
        RunGroup(world=world, variant=variant, runs=tuple(members))
        for (world, variant), members in grouped.items()
    )
