"""Turns a localisation into a picture: the belief at some moments, and both paths on the map."""

from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from evaluation.localization.recording import LocalizationRun, Snapshot
from mapping.grid import UNKNOWN
from mapping.io.atomic import write_atomically
from mapping.path_plot import PATH_COLOUR
from mapping.plot import draw_map

TRUE_COLOUR, BELIEF_COLOUR = "#0072b2", "#009e73"
"""With the red of the estimate they stay apart for colour-blind eyes (Okabe and Ito)."""

COLOURS = "belief green, truth blue, best guess red"

PANEL_WIDTH, HIGHEST_PANEL, LOWEST_PANEL = 4.6, 5.0, 1.2
"""Size of one map in the picture [inch]."""

WIDE = 2.0
"""A map this many times as wide as high is shown in two columns, others in four."""

TITLES = 0.9
"""Height left for titles and labels beside a map [inch]."""

JUMP = 0.5
"""A step longer than this [m] is a jump of the guess, or a kidnapping, and not drawn as a way."""

DPI = 110


def save_localization_picture(path: Path, run: LocalizationRun, result: dict[str, Any]) -> None:
    """Save the picture as png; the same run gives the same bytes.

    Args:
        path: Where to.
        run: What happened.
        result: Its table, for the title.
    """
    known = run.map_file.states != UNKNOWN
    height, width = known.any(axis=1).sum(), known.any(axis=0).sum()
    panels = len(run.snapshots) + 1
    columns = min(panels, 2 if width > WIDE * height else 4)
    rows = -(-panels // columns)
    tall = float(np.clip(PANEL_WIDTH * height / width, LOWEST_PANEL, HIGHEST_PANEL))
    figure = Figure(figsize=(PANEL_WIDTH * columns, (tall + TITLES) * rows), layout="constrained")
    canvas = FigureCanvasAgg(figure)
    axes = np.atleast_1d(figure.subplots(rows, columns)).ravel()
    for ax, snapshot in zip(axes, run.snapshots, strict=False):
        _draw_snapshot(ax, run, snapshot)
    _draw_paths(axes[panels - 1], run)
    for ax in axes[panels:]:
        ax.set_axis_off()
    figure.suptitle(f"{_title(result)}\n{COLOURS}", fontsize=10)
    figure.set_dpi(DPI)
    write_atomically(path, lambda out: canvas.print_png(out, metadata={"Software": None}))


def _draw_snapshot(ax: Axes, run: LocalizationRun, snapshot: Snapshot) -> None:
    """The belief at a moment, the best guess and the truth as arrows."""
    draw_map(ax, run.map_file)
    x, y = snapshot.poses[:, 0], snapshot.poses[:, 1]
    ax.plot(x, y, ".", color=BELIEF_COLOUR, markersize=2, alpha=0.4, zorder=3)
    for pose, colour in ((snapshot.pose_world, TRUE_COLOUR), (snapshot.pose_map, PATH_COLOUR)):
        ax.plot(*pose[:2], "o", color=colour, markersize=5, markerfacecolor="none", zorder=4)
        ax.quiver(*pose[:2], np.cos(pose[2]), np.sin(pose[2]), color=colour, scale=14, zorder=4)
    ax.set_title(f"{snapshot.time:.1f} s", fontsize=9)


def _draw_paths(ax: Axes, run: LocalizationRun) -> None:
    """Where the robot was and where it was believed to be."""
    draw_map(ax, run.map_file)
    track = run.track
    for poses, colour, width in (
        (track.pose_world, TRUE_COLOUR, 2.5),
        (track.pose_map, PATH_COLOUR, 1.0),
    ):
        way = poses[:, :2].copy()
        jumps = np.flatnonzero(np.hypot(*np.diff(way, axis=0).T) > JUMP)
        way = np.insert(way, jumps + 1, np.nan, axis=0)
        ax.plot(way[:, 0], way[:, 1], color=colour, linewidth=width)
    ax.set_title("the whole way", fontsize=9)


def _title(result: dict[str, Any]) -> str:
    told = [f"{Path(result['world']).stem}, {result['filter']}, seed {result['seed']}"]
    told.append(_time("located after", result["localized_at_s"]))
    if result["kidnapped_at_s"] is not None:
        told.append(f"carried off at {result['kidnapped_at_s']:.0f} s")
        told.append(_time("located again after", result["relocalized_after_s"]))
    return ", ".join(told)


def _time(words: str, seconds: float | None) -> str:
    return (
        "never " + words.removesuffix(" after") if seconds is None else f"{words} {seconds:.1f} s"
    )
