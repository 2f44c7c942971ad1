"""Turns an episode into a moving picture: its map as it grew, and the robot in it.

What a frame needs is kept while the episode goes on, some 20 kB each; frames are drawn at the end,
when it is known how large the map has become, so that the picture stands still.
"""

from collections.abc import Iterator
from pathlib import Path
from typing import BinaryIO

import numpy as np
from PIL import Image

from evaluation.animation.frame import FramePainter, Moment
from evaluation.animation.scan_ends import scan_ends
from evaluation.episode import Episode
from evaluation.packed_map import PackedMap
from evaluation.progress import Progress
from mapping.coarse_map import coarse_map
from mapping.grid import OccupancyGrid
from mapping.io.atomic import write_atomically
from nav.navigator import Plan

MOST_FRAMES = 240
"""A longer episode has fewer frames to the second: every other, every fourth, ..."""

FRAME_MS, LAST_FRAME_MS = 100, 3000
"""How long a frame is shown, and the last one [ms]."""


class Animation:
    """Notes how an episode stands, once a simulated second, and draws it in the end."""

    def __init__(self) -> None:
        self._moments: list[Moment] = []
        self._positions: list[tuple[float, float]] = []
        self._every = 1

    def note(self, progress: Progress) -> None:
        """Keep what a frame needs, if it is time for another."""
        is_due = len(self._positions) % self._every == 0
        x, y, _ = progress.pose_map.tolist()
        self._positions.append((x, y))
        if not is_due:
            return
        observation, pose_map = progress.observation, progress.pose_map.copy()
        moment = Moment(
            coverage=progress.coverage,
            drawn=_packed(progress.time, progress.grid),
            pose_map=pose_map,
            path=np.array(self._positions),
            plan=progress.plan,
            scan=np.zeros((0, 2)) if observation is None else scan_ends(observation, pose_map),
            people=progress.people_world.copy(),
        )
        self._moments.append(moment)
        if len(self._moments) > MOST_FRAMES:
            self._moments = self._moments[::2]
            self._every *= 2

    def write(self, file: Path, episode: Episode) -> None:
        """Write all frames, and at last the map as it came out, as a GIF.

        Args:
            file: Where to.
            episode: What was noted, at its end.

        Raises:
            TestbedError: The file cannot be written.
        """
        last = _end_of(episode)
        people = any(len(moment.people) for moment in self._moments)
        painter = FramePainter(episode.plan.name, last.drawn.unpack(), people=people)
        durations = [FRAME_MS] * len(self._moments) + [LAST_FRAME_MS]
        frames = map(painter.paint, (*self._moments, last))
        write_atomically(file, lambda out: _save(frames, durations, out))


def _packed(time: float, grid: OccupancyGrid) -> PackedMap:
    return PackedMap.of(time, coarse_map(grid, grid.resolution))


def _end_of(episode: Episode) -> Moment:
    """The last frame: the map and the path as the mapper has them in the end."""
    poses = episode.trajectory.poses if len(episode.trajectory) else episode.track.pose_map
    left_over = [(frontier.x, frontier.y) for frontier in episode.dropped_frontiers]
    return Moment(
        coverage=float(episode.coverages[-1]),
        drawn=_packed(episode.sim_time, episode.grid),
        pose_map=poses[-1],
        path=poses[:, :2],
        plan=Plan(frontiers=np.array(left_over).reshape(-1, 2)),
    )


def _save(frames: Iterator[Image.Image], durations: list[int], out: BinaryIO) -> None:
    next(frames).save(
        out,
        format="GIF",
        save_all=True,
        append_images=frames,
        duration=durations,
        loop=0,
        optimize=False,  # it would sort the colours of each frame anew
    )
