"""``burger replay``: maps a recorded log into a run folder."""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any

import tyro
from tqdm import tqdm

from evaluation.failure import what_is_left
from evaluation.kernels.warm_up import kernels_of_mapper
from evaluation.recording import load_recording
from evaluation.replay import COMPLETE, Replay, ReplayConfig, check_replay, run_replay
from evaluation.replay_folder import write_replay
from evaluation.run_folder import run_folder
from mapping.errors import TestbedError
from scripts.arguments import is_terminal, parse
from scripts.failed_run import tell_failure
from scripts.first_run import compile_if_needed


@dataclass(frozen=True, kw_only=True)
class ReplayLog:
    """Map a recorded log, score what can be scored, write a run folder."""

    replay: Annotated[ReplayConfig, tyro.conf.OmitArgPrefixes, tyro.conf.UseAppendAction]
    out: Path | None = None
    """Folder to write; default runs/LOG-MAPPER-seedN."""


def run(arguments: list[str]) -> int:
    """Run the verb; 0 when the whole log was mapped, 1 when it was interrupted."""
    options = parse(ReplayLog, "replay", arguments)
    config = options.replay
    out = options.out or Path("runs") / f"{config.log.stem}-{config.mapper}-seed{config.seed}"
    log = config.log.resolve()
    if out.resolve() in (log, log.parent):
        raise TestbedError(f"--out {out}: is where the log lies; must be another folder")
    with run_folder(out):
        replay, failure = what_is_left(lambda: _watch(config))
        result = write_replay(replay, out)
        tell_failure(out, failure)
    print(summary(result))
    print(f"map, picture, trajectories and result.json are in {out}/")
    return 0 if result["stop_reason"] == COMPLETE else 1


def summary(result: dict[str, Any]) -> str:
    """What came of a replay, in a few lines."""
    update = result["map_update_ms_p50"]
    lines = [
        f"{Path(result['log']).name}: {result['stop_reason']}, {result['sim_time_s']:.0f} s of log "
        f"mapped in {result['wall_time_s']:.1f} s ({result['real_time_factor']:.0f}x real time)",
        f"  {result['map_updates']} scans mapped, {result['scans_dropped']} dropped   "
        f"{'-' if update is None else format(update, '.2f')} ms a scan   "
        f"path {result['path_length_m']:.1f} m",
    ]
    if result["ate_rmse_m"] is not None:
        lines.append(
            f"  position error {result['ate_rmse_m']:.3f} m rms, {result['ate_max_m']:.3f} m max   "
            f"per second {_shown(result['rpe_trans_rmse_m'])} m, "
            f"{_shown(result['rpe_rot_rmse_deg'])} deg"
        )
    if result["coverage"] is not None:
        lines.append(
            f"  coverage {_shown(result['coverage'])}   f1_5cm {_shown(result['f1_5cm'])}   "
            f"f1_10cm {_shown(result['f1_10cm'])}   free_iou {_shown(result['free_iou'])}"
        )
    if result["relations_used"]:
        lines.append(
            f"  {result['relations_used']} relations: {result['relations_trans_mean_m']:.3f} "
            f"+- {result['relations_trans_std_m']:.3f} m, "
            f"{result['relations_rot_mean_deg']:.2f} deg, "
            f"max {result['relations_trans_max_m']:.3f} m"
        )
    return "\n".join(lines)


def _shown(value: float | None) -> str:
    return "-" if value is None else f"{value:.3f}"


def _watch(config: ReplayConfig) -> Replay:
    """Map the log, a bar growing before the user's eyes if there is a terminal."""
    recording = load_recording(config.log, config.relations)
    compile_if_needed(
        kernels_of_mapper(config.mapper, simulates=False),
        check=lambda: check_replay(config, recording),
    )
    with tqdm(
        total=len(recording.log.scans), unit="scan", disable=not is_terminal(), leave=False
    ) as bar:
        return run_replay(config, recording, lambda count: _advance(bar, count))


def _advance(bar: "tqdm[Any]", count: int) -> None:
    bar.update(count - bar.n)
