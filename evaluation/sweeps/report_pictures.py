"""Draws the pictures of a report, as text that can stand in a page: dot plots and small maps."""

import base64
import io
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib import rc_context
from matplotlib.axes import Axes
from matplotlib.backends.backend_svg import FigureCanvasSVG
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from PIL import Image

from evaluation.sweeps.run_record import RunRecord
from evaluation.sweeps.run_table import (
    ALWAYS_SHOWN,
    VARIANT_KEYS,
    RunGroup,
    group_runs,
    short_name,
    varied,
)

PANELS = (
    ("t95_s", "time to 95 % coverage [s]"),
    ("efficiency", "efficiency, of the reference tour"),
    ("coverage", "coverage in the end"),
)
"""Keys of ``result.json`` that are drawn, each with what its axis says."""

COLOURS = ("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#000000")
"""Palette of Okabe and Ito (2008), which colour-blind readers can tell."""

MARKERS = "osD^vP*"

ROW_HEIGHT = 0.2
"""Height of a variant's line in a plot [inch]."""

LEAST_SHOWN = 0.9
"""Where the axis of coverage begins, unless a run covered less."""

THUMBNAIL_WIDTH = 560
"""Width of a small map [pixels]."""

THUMBNAIL_COLOURS = 128
"""Colours of a small map: maps have few, and the page stays small."""


def dot_plots(runs: Sequence[RunRecord]) -> str:
    """A dot for each run in every panel, a row for each world, as an SVG element.

    Variants of what was run differ in colour, marker and height in the row; a bar marks their
    median. A run that never covered 95 % stands as a cross at the right edge.
    """
    groups = group_runs([run for run in runs if run.result])
    worlds = list(dict.fromkeys(group.world for group in groups))
    variants = list(dict.fromkeys(group.variant for group in groups))
    height = 1.1 + ROW_HEIGHT * len(worlds) * (len(variants) + 0.6) + 0.2 * len(variants)
    figure = Figure(figsize=(12.0, height), layout="constrained")
    panels = figure.subplots(1, len(PANELS), sharey=True)
    for ax, (key, label) in zip(panels, PANELS, strict=True):
        _draw_panel(ax, groups, worlds, variants, key)
        ax.set_xlabel(label)
    panels[0].set_yticks(np.arange(len(worlds)), [short_name(world) for world in worlds])
    panels[0].set_ylim(len(worlds) - 0.5, -0.5)
    handles = [Line2D([], [], linestyle="", **_style(i)) for i in range(len(variants))]
    figure.legend(handles, _labels(groups), loc="outside upper left", ncols=4, frameon=False)
    text = io.StringIO()
    # a fixed salt keeps the ids, and so the bytes, the same
    with rc_context({"svg.hashsalt": "report", "svg.fonttype": "none"}):
        FigureCanvasSVG(figure).print_svg(text, metadata={"Date": None})
    svg = text.getvalue()
    return svg[svg.index("<svg") :]


def thumbnail(picture: Path) -> str | None:
    """A small version of a picture as the address of an image element; None if there is none."""
    try:
        with Image.open(picture) as image:
            small = image.convert("RGB")
    except OSError:
        return None
    small.thumbnail((THUMBNAIL_WIDTH, THUMBNAIL_WIDTH))
    file = io.BytesIO()
    small.quantize(THUMBNAIL_COLOURS).save(file, format="PNG", optimize=True)
    return "data:image/png;base64," + base64.b64encode(file.getvalue()).decode()


def _labels(groups: Sequence[RunGroup]) -> list[str]:
    """What tells the variants apart; the navigator alone where nothing else does."""
    differ = varied(groups)
    shown = differ if any(differ) else [key == "navigator" for key in VARIANT_KEYS]
    return [
        ", ".join(
            told if key in ALWAYS_SHOWN or told[:1].isalpha() else f"{key} {told}"
            for key, told, is_shown in zip(VARIANT_KEYS, variant, shown, strict=True)
            if is_shown
        )
        for variant in dict.fromkeys(group.variant for group in groups)
    ]


def _draw_panel(
    ax: Axes,
    groups: Sequence[RunGroup],
    worlds: Sequence[str],
    variants: Sequence[tuple[str, ...]],
    key: str,
) -> None:
    step = 1.0 / (len(variants) + 0.6)
    finite = [value for group in groups for value in group.values(key) if np.isfinite(value)]
    edge = 1.06 * max(finite, default=1.0)
    for group in groups:
        i = variants.index(group.variant)
        y = worlds.index(group.world) + (i - 0.5 * (len(variants) - 1)) * step
        colour = COLOURS[i % len(COLOURS)]
        values = group.values(key)
        reached = values[np.isfinite(values)]
        ax.plot(reached, np.full(len(reached), y), linestyle="", **_style(i))
        missed = len(values) - len(reached)
        if missed:  # an empty line without clipping would upset the layout
            ax.plot([edge] * missed, [y] * missed, "x", color=colour, clip_on=False)
        if len(values) > 1 and np.isfinite(group.median(key)):
            half = 0.45 * step
            ax.vlines(group.median(key), y - half, y + half, colors=colour)
    least = min(LEAST_SHOWN, *finite, 1.0) - 0.02 if key == "coverage" else 0.0
    ax.set_xlim(least, edge if key == "t95_s" else max(1.005, *finite))
    ax.grid(axis="x", color="#e4e7eb")
    ax.set_axisbelow(True)
    ax.spines[["top", "right", "left"]].set_visible(False)
    ax.tick_params(length=0)
    for line in range(1, len(worlds)):
        ax.axhline(line - 0.5, color="#e4e7eb", linewidth=0.8)
    if not any(key in run.result for group in groups for run in group.runs):
        ax.text(0.5, 0.5, "not measured", transform=ax.transAxes, ha="center", color="#6d7683")


def _style(i: int) -> dict[str, Any]:
    """How the dots of the i-th variant look."""
    return {
        "marker": MARKERS[i % len(MARKERS)],
        "markersize": 5.5,
        "color": COLOURS[i % len(COLOURS)],
        "alpha": 0.75,
        "markeredgewidth": 0.0,
    }
