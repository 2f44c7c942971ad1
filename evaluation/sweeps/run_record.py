"""Reads run folders back: what was run, and what came of it or why nothing did."""

import json
import math
import re
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from evaluation.failure import FAILURE_FILE
from mapping.errors import TestbedError

COMPLETE = "complete"


@dataclass(frozen=True, slots=True, kw_only=True)
class RunRecord:
    """An episode, finished or failed."""

    folder: Path
    config: dict[str, Any]
    """The content of ``config.json``."""
    result: dict[str, Any] = field(default_factory=dict)
    """The content of ``result.json``; empty if the run failed."""
    failure: str | None = None
    """Why there is no result."""

    @property
    def is_complete(self) -> bool:
        """Whether the robot explored everything and came home."""
        return self.result.get("stop_reason") == COMPLETE

    def told(self, key: str) -> str:
        """What the config has under a key, as text."""
        return str(self.config.get(key, "-"))

    def number(self, key: str) -> float:
        """What the result has under a key; NaN where it has nothing."""
        value = self.result.get(key)
        return math.nan if value is None else float(value)


def find_runs(folders: Sequence[Path]) -> tuple[RunRecord, ...]:
    """The runs of folders: run folders themselves, or folders of such at any depth.

    Replays of logs are left out, and so are folders that hold neither a result nor a failure.

    Raises:
        TestbedError: If a folder is none, holds no run, or one of its files cannot be read.
    """
    found: dict[Path, RunRecord] = {}
    for folder in folders:
        if not folder.is_dir():
            raise TestbedError(f"{folder}: no such folder; must be a run folder or one of several")
        configs = sorted(folder.rglob("config.json"), key=_natural)
        records = [record for each in configs if (record := read_run(each.parent)) is not None]
        if not records:
            raise TestbedError(
                f"{folder}: no runs in it; must hold result.json and config.json, "
                "as burger explore and burger sweep write them"
            )
        found |= {record.folder.resolve(): record for record in records}
    return tuple(found.values())


def read_run(folder: Path) -> RunRecord | None:
    """The run of one folder; None if it holds no episode, finished or failed.

    Raises:
        TestbedError: If a file of it is no JSON.
    """
    result, failure = folder / "result.json", folder / FAILURE_FILE
    if not (folder / "config.json").is_file() or not (result.is_file() or failure.is_file()):
        return None
    config = read_json(folder / "config.json")
    if "navigator" not in config:
        return None
    if result.is_file():
        return RunRecord(folder=folder, config=config, result=read_json(result))
    reason = failure.read_text(encoding="utf-8", errors="replace").splitlines()
    return RunRecord(folder=folder, config=config, failure=next(iter(reason), "no reason told"))


def _natural(path: Path) -> list[tuple[int, str]]:
    """A key that sorts random_2 before random_10."""
    return [
        (int(part), "") if part.isdecimal() else (-1, part)
        for part in re.split(r"([0-9]+)", str(path))
    ]


def read_json(path: Path) -> dict[str, Any]:
    """The table that a JSON file holds.

    Raises:
        TestbedError: If it cannot be read or is something else.
    """
    try:
        content = json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError) as error:
        raise TestbedError(f"{path}: cannot be read as JSON ({error})") from None
    if not isinstance(content, dict):
        raise TestbedError(f"{path}: holds a {type(content).__name__}; must be a JSON object")
    return content
