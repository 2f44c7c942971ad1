"""``burger localize``: finds the robot on a given map."""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any

import tyro
from tqdm import tqdm

from evaluation.localization.config import LocalizationConfig
from evaluation.localization.folder import write_localization
from evaluation.localization.recording import LocalizationRun
from evaluation.localization.result import is_found
from evaluation.localization.run import check_localization, run_localization
from evaluation.localization.warm_up import kernels_of_localizer
from evaluation.run_folder import run_folder
from scripts.arguments import is_terminal, parse
from scripts.first_run import compile_if_needed


@dataclass(frozen=True, kw_only=True)
class Localize:
    """Put the robot down anywhere in a world, let it wander and find itself on a map."""

    localization: Annotated[LocalizationConfig, tyro.conf.OmitArgPrefixes]
    out: Path | None = None
    """Folder to write; default runs/WORLD-FILTER-seedN."""


def run(arguments: list[str]) -> int:
    """Run the verb; 0 when the robot was located, and again after a kidnapping, 1 when not."""
    options = parse(Localize, "localize", arguments)
    config = options.localization
    world = Path(config.world).stem
    out = options.out or Path("runs") / f"{world}-{config.filter}-seed{config.seed}"
    with run_folder(out):
        result = write_localization(_watch(config), out)
    print(summary(result))
    print(f"picture, trajectories, belief.csv and result.json are in {out}/")
    return 0 if is_found(result) else 1


def summary(result: dict[str, Any]) -> str:
    """What came of a localisation, in a few lines."""
    lines = [
        f"{Path(result['world']).stem}, {result['filter']}: "
        f"{_located(result['localized_at_s'], 'located')} "
        f"({result['sim_time_s']:.0f} s simulated, {result['wall_time_s']:.1f} s real)"
    ]
    if result["kidnapped_at_s"] is not None:
        again = _located(result["relocalized_after_s"], "located again")
        lines.append(f"  carried off at {result['kidnapped_at_s']:.0f} s: {again}")
    if result["error_rmse_m"] is not None:
        lines.append(
            f"  then position error {result['error_rmse_m']:.3f} m rms, "
            f"{result['error_max_m']:.3f} m max   heading {result['yaw_rmse_deg']:.2f} deg rms"
        )
    update = result["update_ms_p50"]
    if update is None:
        return "\n".join((*lines, "  no scan saw anything to localise by"))
    lines.append(
        f"  ambiguous for {result['ambiguous_s']:.1f} s, sure of a wrong place for "
        f"{result['surely_wrong_s']:.1f} s   size {result['size_first']} -> "
        f"{result['size_median']:.0f}   {update:.2f} ms a scan"
    )
    return "\n".join(lines)


def _located(seconds: float | None, word: str) -> str:
    return f"not {word}" if seconds is None else f"{word} after {seconds:.1f} s"


def _watch(config: LocalizationConfig) -> LocalizationRun:
    """Run the localisation, a bar growing before the user's eyes if there is a terminal."""
    compile_if_needed(kernels_of_localizer(config.filter), lambda: check_localization(config))
    with tqdm(total=round(config.end), unit="s", disable=not is_terminal(), leave=False) as bar:
        return run_localization(config, lambda time: _advance(bar, int(time)))


def _advance(bar: "tqdm[Any]", seconds: int) -> None:
    bar.update(seconds - bar.n)
