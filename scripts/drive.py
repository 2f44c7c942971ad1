"""``burger drive``: drives a robot by hand in a terminal, the map growing beside it."""

import sys
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Annotated

import tyro

from envs.viewer import ViewedEnv, check_display
from envs.worlds import load_world, world_label
from evaluation.episode import (
    CONTROL_PERIOD,
    Episode,
    EpisodeConfig,
    check_episode,
    drive_episode,
    make_agent,
    make_environment,
    navigator_of,
)
from evaluation.episode_folder import write_run
from evaluation.failure import what_is_left
from evaluation.kernels.warm_up import kernels_of_mapper
from evaluation.map_snapshots import MapSnapshots
from evaluation.pace import Pace
from evaluation.recorder import Recorder
from evaluation.run_folder import run_folder
from mapping.errors import TestbedError
from nav.teleop import Teleop
from scripts.arguments import parse
from scripts.drive_session import DriveSession
from scripts.explore import summary
from scripts.failed_run import tell_failure
from scripts.first_run import compile_if_needed
from scripts.live_map import LiveMap, can_draw
from scripts.raw_terminal import raw_terminal, read_keys

HAND = "teleop"
"""What drove the robot, in config.json and result.json, before the name of the autonomous one."""

NOTICED = 0.05
"""Share of late control periods from which on it is told that the machine was too slow."""


@dataclass(frozen=True, kw_only=True)
class Drive:
    """Drive by hand, the map growing beside you; q or Ctrl-C writes a run folder."""

    episode: Annotated[EpisodeConfig, tyro.conf.OmitArgPrefixes]
    out: Path | None = None
    """Folder to write; default runs/drive-WORLD-MAPPER-seedN."""
    viewer: bool = False
    """Show MuJoCo's own viewer as well; needs a display."""
    speed: float = 1.0
    """How many times faster than real time."""
    record: bool = False
    """Write the messages of the run as well: log.carmen and a ROS 2 bag in the folder bag."""


def run(arguments: list[str]) -> int:
    """Run the verb; 0 once the run is saved, 1 when an error ended it."""
    options = parse(Drive, "drive", arguments)
    config = options.episode
    pace = Pace(CONTROL_PERIOD, options.speed)
    _check_terminal()
    if options.viewer:
        check_display()
    out = options.out or Path("runs") / _folder_name(config)
    recorder = Recorder() if options.record else None
    with run_folder(out):
        compile_if_needed(
            kernels_of_mapper(config.mapper, simulates=True), check=lambda: check_episode(config)
        )
        episode, failure, late_share = _drive(options, out, pace, recorder)
        result = write_run(episode, out)
        tell_failure(out, failure)
    print(summary(result))
    if late_share > NOTICED:
        print(f"this machine was too slow for {options.speed:g}x in {late_share:.0%} of the time")
    print(f"map, picture, trajectories and result.json are in {out}/")
    return 1 if failure else 0


def _check_terminal() -> None:
    """Refuse to start where keys cannot be read or the map cannot be shown."""
    if not sys.stdin.isatty():
        raise TestbedError("stdin is no terminal; keys can be read from a terminal only")
    if not can_draw():
        raise TestbedError("stderr shows no map; must be a terminal with a UTF-8 locale")


def _folder_name(config: EpisodeConfig) -> str:
    return f"drive-{world_label(config.world)}-{config.mapper}-seed{config.seed}"


def _drive(
    options: Drive, out: Path, pace: Pace, recorder: Recorder | None
) -> tuple[Episode, str, float]:
    """Drive until the person quits.

    Returns:
        What is left of it, the error that ended it or nothing, and the share of time in which the
        machine was too slow.
    """
    config = options.episode
    plan = load_world(config.world)
    agent = make_agent(config, plan)
    environment = make_environment(config, plan)
    try:
        if options.viewer:
            environment = ViewedEnv(environment)
        snapshots = MapSnapshots(out)
        terminal = sys.stdin.fileno()
        session = DriveSession(
            teleop=Teleop(lambda: navigator_of(config, plan)),
            mapper=agent.mapper,
            pace=pace,
            read=partial(read_keys, terminal),
            live_map=LiveMap(""),
            snapshots=snapshots,
        )
        agent.navigator = session
        driven = replace(config, navigator=f"{HAND}+{config.navigator}")
        with raw_terminal(terminal, on_resume=pace.restart):
            episode, failure = what_is_left(
                lambda: drive_episode(
                    driven, plan, agent, environment, session.note_progress, recorder
                )
            )
            session.draw()
    finally:
        environment.close()
    snapshots.close()
    return episode, failure, session.late_share
