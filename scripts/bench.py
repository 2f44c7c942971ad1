"""``burger bench``: how fast each stage and the whole loop run on this machine."""

import os
import platform
from dataclasses import asdict, dataclass
from pathlib import Path

from tqdm import tqdm

from evaluation.bench import BENCH_WORLDS, Loop, Stage, bench_loop, bench_stages
from evaluation.episode import EpisodeConfig, check_episode
from evaluation.kernels.warm_up import kernels_of_mapper
from evaluation.run_folder import write_json
from mapping.mappers import MAPPERS
from scripts.arguments import is_terminal, parse
from scripts.first_run import compile_if_needed


@dataclass(frozen=True, kw_only=True)
class Bench:
    """Time the stages and whole explorations; one core is enough."""

    mapper: str = "graph"
    """Mapper of the explorations."""
    worlds: tuple[str, ...] = BENCH_WORLDS
    """Worlds to explore whole."""
    seed: int = 0
    """Seed of the explorations."""
    out: Path | None = None
    """JSON file for the figures; none is written without it."""


def run(arguments: list[str]) -> int:
    """Run the verb."""
    options = parse(Bench, "bench", arguments)
    _check(options)
    for mapper in MAPPERS:
        compile_if_needed(kernels_of_mapper(mapper, simulates=True))
    print(f"{platform.machine()}, {os.cpu_count()} cores, Python {platform.python_version()}")
    stages = bench_stages()
    print(f"\n{'stage':<50} {'median ms':>10} {'p99 ms':>8}")
    for stage in stages:
        print(_stage_row(stage))
    print(
        f"\n{'whole loop, ' + options.mapper:<23} {'simulated s':>12} {'x real time':>12}"
        f" {'simulation':>11} {'mapping':>8} {'navigation':>11} ms per simulated s"
        f" {'ms a decision':>14}"
    )
    loops = []
    for world in tqdm(options.worlds, disable=not is_terminal(), leave=False):
        loops.append(bench_loop(world, options.seed, options.mapper))
        tqdm.write(_loop_row(loops[-1]))
    if options.out is not None:
        write_json(
            options.out,
            {
                "stages": [asdict(stage) for stage in stages],
                "loops": [asdict(loop) for loop in loops],
            },
        )
    return 0


def _check(options: Bench) -> None:
    """Refuse what cannot be explored before anything is timed."""
    for world in options.worlds:
        check_episode(EpisodeConfig(world=world, mapper=options.mapper, seed=options.seed))


def _stage_row(stage: Stage) -> str:
    return f"{stage.name:<50} {stage.median_ms:>10.3f} {stage.p99_ms:>8.3f}"


def _loop_row(loop: Loop) -> str:
    return (
        f"{Path(loop.world).stem:<23} {loop.sim_time:>12.0f} {loop.real_time_factor:>12.0f}"
        f" {loop.simulation_ms:>11.2f} {loop.mapping_ms:>8.2f} {loop.navigation_ms:>11.2f}"
        f" {'-' if loop.decision_ms is None else format(loop.decision_ms, '.1f'):>33}"
    )
