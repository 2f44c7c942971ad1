"""Scenario files and results for the tests: text with one line changed, runs that never ran."""

from pathlib import Path
from typing import Any

SCENARIO = """\
name: mine
description: a room of my own
world: lim_room
odometry: typical
seeds: 2
time_limit: 60
regions:
  corner: [0, 0, 1, 1]
criteria:
  coverage: {min: 0.9}
  t95_s: {min: 1, max: 65}
  coverage_in.corner: {min: 0.99}
"""


def write_scenario(folder: Path, *changes: tuple[str, str], name: str = "mine.yaml") -> Path:
    """A scenario file, each of the changes replacing one text by another."""
    text = SCENARIO
    for old, new in changes:
        assert old in text, old
        text = text.replace(old, new)
    path = folder / name
    path.write_text(text)
    return path


def good_result(**changes: Any) -> dict[str, Any]:
    """A result that meets the criteria of SCENARIO and of every scenario."""
    result: dict[str, Any] = {
        "stop_reason": "complete",
        "contacts": 0,
        "home_distance_m": 0.05,
        "false_free": 0.001,
        "map_reloads": True,
        "coverage": 0.95,
        "t95_s": 50.0,
        "t99_s": None,
        "coverage_in.corner": 1.0,
        "f1_5cm": 0.9,
        "real_time_factor": 60.0,
        "wall_time_s": 1.25,
    }
    return result | changes
