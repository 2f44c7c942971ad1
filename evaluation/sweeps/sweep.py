"""Runs every combination of worlds, mappers, navigators, odometries and seeds, and tables them."""

import csv
import io
import json
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from itertools import product
from pathlib import Path
from typing import Any

from envs.random_world import expand_worlds, is_random_world, parse_random_world
from envs.worlds import load_world, world_label
from evaluation.episode import BATTERY_LIFE, EpisodeConfig, check_episode
from evaluation.episode_pool import Failure, Outcome, run_episodes
from evaluation.run_folder import describe
from evaluation.seed_count import check_seed_count
from evaluation.sweeps.run_record import RunRecord, read_json
from mapping.errors import TestbedError
from mapping.io.atomic import write_atomically

TABLE = "sweep.csv"


@dataclass(frozen=True, slots=True, kw_only=True)
class SweepConfig:
    """What to combine with what; each combination is run with each seed."""

    worlds: tuple[str, ...]
    """Worlds as burger explore takes them; random:0..9 names ten random ones, and
    random:0..9,rooms=6,area=120,style=office ten such offices."""
    mappers: tuple[str, ...] = ("graph",)
    """graph, scan_match, gmapping, ogm or occgridmapp."""
    navigators: tuple[str, ...] = ("frontier",)
    """Navigators as burger explore takes them."""
    odometry: tuple[str, ...] = ("typical",)
    """Wheel and odometry errors: ideal, typical, poor, or truth."""
    lidar: str = "datasheet"
    """Lidar noise of all runs."""
    people: int = 0
    """So many people walk in every world, besides its own."""
    seeds: int = 1
    """Seeds of each combination: 0 to this minus 1."""
    time_limit: float = BATTERY_LIFE
    """Simulated time after which a run ends [s]."""

    def __post_init__(self) -> None:
        """Refuse sweeps of nothing."""
        for field in ("worlds", "mappers", "navigators", "odometry"):
            if not getattr(self, field):
                raise TestbedError(f"{field}: none; must be one at least")
        check_seed_count(self.seeds)


@dataclass(frozen=True, slots=True, kw_only=True)
class Sweep:
    """Runs of a sweep, in the order of its combinations."""

    runs: tuple[RunRecord, ...]
    interrupted: bool
    """Whether Ctrl-C ended it early; then runs are missing."""

    @property
    def failures(self) -> tuple[RunRecord, ...]:
        """The runs that have no result."""
        return tuple(run for run in self.runs if run.failure is not None)


Planned = dict[Path, EpisodeConfig]
"""Run folder -> what to run there."""


def plan_sweep(config: SweepConfig, out: Path) -> Planned:
    """The runs of a sweep, all worlds and names checked before any is run.

    Run folders are ``OUT/WORLD-MAPPER-NAVIGATOR-ODOMETRY-seedN``.

    Raises:
        TestbedError: If a world, mapper, navigator or odometry does not exist, or two worlds would
            share a folder.
    """
    planned: Planned = {}
    for episode in _combinations(config):
        words = (episode.mapper, episode.navigator, episode.odometry, f"seed{episode.seed}")
        folder = out / "-".join((world_label(episode.world), *words))
        if folder in planned and planned[folder].world != episode.world:
            raise TestbedError(
                f"worlds: {planned[folder].world} and {episode.world} would share the folder "
                f"{folder.name}; their files must have different names"
            )
        planned[folder] = episode
    _check(list(planned.values()))
    return planned


def finished_runs(planned: Planned) -> dict[Path, RunRecord]:
    """Those runs that an earlier sweep has finished: same config, versions and sources."""
    finished = {}
    for folder, episode in planned.items():
        if not all((folder / name).is_file() for name in ("config.json", "result.json")):
            continue
        try:
            config, result = (read_json(folder / f"{name}.json") for name in ("config", "result"))
        except TestbedError:
            continue  # to be run again
        world = Path(episode.world)
        changed = (
            world.is_file() and world.stat().st_mtime > (folder / "result.json").stat().st_mtime
        )
        if config == json.loads(json.dumps(describe(episode))) and not changed:
            finished[folder] = RunRecord(folder=folder, config=config, result=result)
    return finished


def run_sweep(
    planned: Planned,
    out: Path,
    *,
    finished: dict[Path, RunRecord],
    processes: int = 1,
    on_run: Callable[[RunRecord], None] | None = None,
) -> Sweep:
    """Run what is not finished, and write ``OUT/sweep.csv``, a row for each run.

    A run that fails does not end the sweep; Ctrl-C does, and keeps what had ended.

    Args:
        planned: What to run.
        out: Folder of the run folders and the table.
        finished: Runs that are not run again.
        processes: How many run at the same time.
        on_run: Called with each run that ends.

    Raises:
        TestbedError: If ``processes`` is not positive or the table cannot be written.
    """
    records = dict(finished)
    jobs = [(episode, folder) for folder, episode in planned.items() if folder not in finished]

    def note(index: int, outcome: Outcome) -> None:
        episode, folder = jobs[index]
        records[folder] = _record(episode, folder, outcome)
        if on_run is not None:
            on_run(records[folder])

    interrupted = False
    try:
        run_episodes(jobs, processes=processes, on_done=note)
    except KeyboardInterrupt:
        interrupted = True
    runs = tuple(records[folder] for folder in planned if folder in records)
    write_table(out / TABLE, runs)
    return Sweep(runs=runs, interrupted=interrupted)


def write_table(path: Path, runs: Sequence[RunRecord]) -> None:
    """Write runs as CSV: folder, what was run, the flat keys of ``result.json``, and the failure.

    Lists, such as the frontiers that were given up, stand as how many there are.
    """
    rows = [_row(run) for run in runs]
    fields = list(dict.fromkeys(key for row in rows for key in row))
    fields.sort(key=lambda field: field == "failure")  # the last column
    text = io.StringIO()
    writer = csv.DictWriter(text, fieldnames=fields, lineterminator="\n")
    writer.writeheader()
    writer.writerows(rows)
    write_atomically(path, lambda file: file.write(text.getvalue().encode()))


def _combinations(config: SweepConfig) -> Iterator[EpisodeConfig]:
    worlds = expand_worlds(config.worlds)
    for world, mapper, navigator, odometry, seed in product(
        worlds, config.mappers, config.navigators, config.odometry, range(config.seeds)
    ):
        yield EpisodeConfig(
            world=world,
            mapper=mapper,
            navigator=navigator,
            odometry=odometry,
            lidar=config.lidar,
            people=config.people,
            seed=seed,
            time_limit=config.time_limit,
        )


def _check(episodes: Sequence[EpisodeConfig]) -> None:
    """Refuse what cannot be run: each world once, and in the first one all that varies else.

    Random worlds are only read by their names: to draw thousands would take longer than to wait
    for the first that cannot be drawn, which then is told as a failure.
    """
    worlds = {episode.world: episode for episode in episodes}
    for world in worlds:
        if is_random_world(world):
            parse_random_world(world)
        else:
            load_world(world)
    others = {
        (each.mapper, each.navigator, each.odometry): each
        for each in episodes
        if each.world == episodes[0].world
    }
    for episode in others.values():
        check_episode(episode)


def _record(episode: EpisodeConfig, folder: Path, outcome: Outcome) -> RunRecord:
    config = describe(episode)
    if isinstance(outcome, Failure):
        return RunRecord(folder=folder, config=config, failure=outcome.reason)
    return RunRecord(folder=folder, config=config, result=outcome)


def _row(run: RunRecord) -> dict[str, Any]:
    named = ("world", "mapper", "navigator", "odometry", "seed")
    figures = {
        key: len(value) if isinstance(value, list | tuple) else value
        for key, value in run.result.items()
    }
    return {
        "folder": run.folder.name,
        **{key: run.config.get(key) for key in named},
        **figures,
        "failure": run.failure,
    }
