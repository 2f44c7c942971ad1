"""``burger report``: one HTML page from run folders, sweeps and scenarios."""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

from tyro.conf import Positional

from evaluation.sweeps.report import write_report
from evaluation.sweeps.run_record import find_runs
from mapping.errors import TestbedError
from scripts.arguments import parse


@dataclass(frozen=True, kw_only=True)
class Report:
    """Write one HTML page: table, plots, the worst maps, what failed and why."""

    folders: Annotated[tuple[Path, ...], Positional]
    """Run folders, or folders that hold some at any depth, such as those of burger sweep."""
    out: Path | None = None
    """The page to write; default report.html in the first folder."""
    title: str = "Exploration report"
    """Heading of the page."""


def run(arguments: list[str]) -> int:
    """Run the verb."""
    options = parse(Report, "report", arguments)
    if not options.folders:
        raise TestbedError("no folders; name run folders, or folders that hold some")
    runs = find_runs(options.folders)
    out = options.out or options.folders[0] / "report.html"
    write_report(runs, out, options.title)
    print(f"{len(runs)} runs, written to {out}")
    return 0
