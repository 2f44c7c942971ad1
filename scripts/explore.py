"""``burger explore``: one autonomous episode into a run folder."""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any

import tyro

from envs.worlds import world_label
from evaluation.animation.animation import Animation
from evaluation.episode import Episode, EpisodeConfig, check_episode, run_episode
from evaluation.episode_folder import write_run
from evaluation.failure import what_is_left
from evaluation.kernels.warm_up import kernels_of_mapper
from evaluation.progress import Progress
from evaluation.recorder import Recorder
from evaluation.run_folder import run_folder
from scripts.arguments import parse
from scripts.failed_run import tell_failure
from scripts.first_run import compile_if_needed
from scripts.live_map import LiveMap, can_draw


@dataclass(frozen=True, kw_only=True)
class Explore:
    """Explore a world autonomously, map it, score the map, write a run folder."""

    episode: Annotated[EpisodeConfig, tyro.conf.OmitArgPrefixes]
    out: Path | None = None
    """Folder to write; default runs/WORLD-MAPPER-seedN."""
    record: bool = False
    """Write the messages of the run as well: log.carmen and a ROS 2 bag in the folder bag."""
    animate: bool = False
    """Draw the map as it grows, and the robot in it, as episode.gif."""


def run(arguments: list[str]) -> int:
    """Run the verb; 0 when the robot finished, 1 when it did not."""
    options = parse(Explore, "explore", arguments)
    config = options.episode
    out = options.out or Path("runs") / _folder_name(config)
    recorder = Recorder() if options.record else None
    animation = Animation() if options.animate else None
    with run_folder(out):
        compile_if_needed(
            kernels_of_mapper(config.mapper, simulates=True), check=lambda: check_episode(config)
        )
        episode, failure = what_is_left(lambda: _watch(config, recorder, animation))
        result = write_run(episode, out, animation)
        tell_failure(out, failure)
    print(summary(result))
    more = ", log.carmen, bag" if options.record else ""
    more += ", episode.gif" if options.animate else ""
    print(f"map, picture, trajectories{more} and result.json are in {out}/")
    return 0 if result["stop_reason"] == "complete" else 1


def summary(result: dict[str, Any]) -> str:
    """What came of a run, in a few lines."""
    world = Path(result["world"]).stem
    return "\n".join(
        (
            f"{world}: {result['stop_reason']} after {result['sim_time_s']:.0f} s "
            f"simulated, {result['wall_time_s']:.1f} s real "
            f"({result['real_time_factor']:.0f}x real time)",
            f"  coverage {_shown(result['coverage'])}   f1_5cm {_shown(result['f1_5cm'])}   "
            f"f1_10cm {_shown(result['f1_10cm'])}   free_iou {_shown(result['free_iou'])}",
            f"  path {result['path_length_m']:.1f} m   contacts {result['contacts']}   "
            f"home within {result['home_distance_m']:.2f} m   "
            f"position error {_shown(result['ate_rmse_m'])} m rms",
        )
    )


def _shown(value: float | None) -> str:
    return "-" if value is None else f"{value:.3f}"


def _folder_name(config: EpisodeConfig) -> str:
    return f"{world_label(config.world)}-{config.mapper}-seed{config.seed}"


def _watch(
    config: EpisodeConfig, recorder: Recorder | None, animation: Animation | None
) -> Episode:
    """Run the episode, its map growing before the user's eyes if there is a terminal."""
    live_map = LiveMap(f"exploring {Path(config.world).stem}") if can_draw() else None
    if live_map is None and animation is None:
        return run_episode(config, recorder=recorder)
    newest: list[Progress] = []

    def show(progress: Progress) -> None:
        if animation is not None:
            animation.note(progress)
        if live_map is not None:
            newest[:] = [progress]
            live_map.show(progress)

    episode = run_episode(config, show, recorder=recorder)
    if live_map is not None and newest:
        live_map.draw(newest[0])
    return episode
