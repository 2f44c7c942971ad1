"""Turns the goals of an episode into ``goals.csv``: what the robot set out for, a row each."""

from collections.abc import Sequence
from dataclasses import astuple
from pathlib import Path

from mapping.io.atomic import write_atomically
from nav.navigator import ChosenGoal

COLUMNS = ("time_s", "x", "y", "frontier_x", "frontier_y")
"""When it set out [s], where to [m], and the middle of the frontier to be seen from there [m]; the
last two are empty where there was none."""

DECIMALS = 3


def write_goals(file: Path, goals: Sequence[ChosenGoal]) -> None:
    """Write goals in their order, under a header; of no goals the header alone.

    Raises:
        TestbedError: The file cannot be written.
    """
    rows = [COLUMNS, *(tuple(map(_text, astuple(goal))) for goal in goals)]
    text = "".join(",".join(row) + "\n" for row in rows)
    write_atomically(file, lambda out: out.write(text.encode()))


def _text(value: float | None) -> str:
    return "" if value is None else f"{value:.{DECIMALS}f}"
