"""``burger sweep``: every combination of worlds, mappers, navigators and seeds, and a table."""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Never

import tyro
from tqdm import tqdm

from evaluation.kernels.warm_up import kernels_of_mapper
from evaluation.run_folder import run_folder
from evaluation.sweeps.run_record import RunRecord
from evaluation.sweeps.run_table import KEYS, table_of
from evaluation.sweeps.sweep import TABLE, Sweep, SweepConfig, finished_runs, plan_sweep, run_sweep
from mapping.errors import TestbedError
from scripts.arguments import is_terminal, parse
from scripts.first_run import compile_if_needed


@dataclass(frozen=True, kw_only=True)
class SweepOptions:
    """Explore every combination of worlds, mappers, navigators, odometries and seeds.

    A sweep that was interrupted goes on when the same command is given again.
    """

    sweep: Annotated[SweepConfig, tyro.conf.OmitArgPrefixes]
    jobs: int = 1
    """How many runs at the same time."""
    out: Path = Path("runs/sweep")
    """Folder of the run folders, WORLD-MAPPER-NAVIGATOR-ODOMETRY-seedN, and sweep.csv."""


def run(arguments: list[str]) -> int:
    """Run the verb; 0 when all ran, 1 when one failed or Ctrl-C ended the sweep."""
    options = parse(SweepOptions, "sweep", arguments)
    if options.jobs < 1:
        raise TestbedError(f"--jobs: {options.jobs}; must be 1 or more")
    planned = plan_sweep(options.sweep, options.out)
    with run_folder(options.out):
        finished = finished_runs(planned)
        if finished:
            print(f"{len(finished)} of {len(planned)} runs are there already and are kept")
        if len(finished) < len(planned):
            for mapper in dict.fromkeys(options.sweep.mappers):
                compile_if_needed(kernels_of_mapper(mapper, simulates=True))
        with tqdm(
            total=len(planned), initial=len(finished), unit="run", disable=not is_terminal()
        ) as bar:
            sweep = run_sweep(
                planned,
                options.out,
                finished=finished,
                processes=options.jobs,
                on_run=lambda record: _tell(record, bar),
            )
    _tell_end(sweep, len(planned), options.out)
    return 1 if sweep.failures or sweep.interrupted else 0


def _tell(record: RunRecord, bar: "tqdm[Never]") -> None:
    """Say at once which run failed; the others are told together in the end."""
    if record.failure is not None:
        tqdm.write(f"{record.folder.name}: failed: {record.failure}")
    bar.update()


def _tell_end(sweep: Sweep, planned: int, out: Path) -> None:
    if sweep.runs:
        print(_aligned(table_of(sweep.runs)))
        print("medians, but for complete, contacts and least")
    if sweep.failures:
        print(f"{len(sweep.failures)} of {len(sweep.runs)} runs failed; see sweep.csv, failure.txt")
    if sweep.interrupted:
        print(f"interrupted after {len(sweep.runs)} of {planned} runs; the same command goes on")
    print(f"run folders and {TABLE} are in {out}/")


def _aligned(rows: list[list[str]]) -> str:
    """Text columns: names to the left, figures to the right."""
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    names = sum(heading in KEYS for heading in rows[0])
    return "\n".join(
        "  ".join(
            cell.ljust(width) if i < names else cell.rjust(width)
            for i, (cell, width) in enumerate(zip(row, widths, strict=True))
        ).rstrip()
        for row in rows
    )
