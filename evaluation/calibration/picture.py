"""Draws the readings of the two sensor experiments as histograms, side by side."""

import math
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.patches import Patch

from evaluation.calibration.experiment import WALL_DISTANCE, CalibrationConfig
from evaluation.calibration.fit import (
    FAILED,
    RIGHT,
    WRONG,
    Estimate,
    SensorModelFit,
    ValueCount,
)
from mapping.io.atomic import write_atomically

LOOKS = {RIGHT: ("#0072b2", ""), WRONG: ("#e69f00", "///"), FAILED: ("#d55e00", "xxx")}
"""Colour and hatch of a bar: blue, orange and vermilion of Okabe and Ito (2008), which colour-blind
readers can tell; the hatches tell them apart without any colour."""

BAR_MM = 0.9
"""Width of a bar [mm], a little less than the LDS-01's step."""

LEAST_SPAN_MM = 8.0
"""The axis of distances shows so much at least [mm]."""

MOST_LABELLED = 12
"""More bars than this get no counts written on them."""

MOST_TICKS = 9
"""On the axis of distances."""

SIZE, DPI = (11.0, 4.8), 150
"""Of the picture [inch] and its dots per inch."""


def save_histogram(file: Path, fit: SensorModelFit, config: CalibrationConfig) -> None:
    """Save both histograms as png; counts on a log axis, where one wrong reading can be seen.

    Raises:
        TestbedError: The file cannot be written.
    """
    figure = Figure(figsize=SIZE, dpi=DPI, layout="constrained")
    canvas = FigureCanvasAgg(figure)
    wall, free = figure.subplots(1, 2, sharey=True, width_ratios=(3, 2))
    _draw_wall(wall, fit.rows("wall"))
    _entitle(wall, f"{WALL_DISTANCE} m from a wall", "p(m=1 | z=1)", fit.p_m1_given_z1)
    _draw_open(free, fit.rows("open"))
    _entitle(free, "before open space", "p(m=0 | z=0)", fit.p_m0_given_z0)
    wall.set_ylabel(f"readings of {config.scans} (log scale)")
    for ax in (wall, free):
        ax.set_yscale("log")
        ax.set_ylim(0.5, 3.0 * config.scans)
        ax.spines[["top", "right"]].set_visible(False)
    figure.suptitle(f"LDS-01, beam ahead, lidar {config.lidar}, seed {config.seed}", fontsize=10)
    handles = [Patch(**_look(kind), label=kind) for kind in LOOKS]
    figure.legend(handles=handles, loc="outside lower center", ncols=3, frameon=False)
    write_atomically(file, lambda out: canvas.print_png(out, metadata={"Software": None}))


def _draw_wall(ax: Axes, rows: list[ValueCount]) -> None:
    """Distances to scale, in mm; a failure, or a wall not seen, stands apart on the left."""
    hits = [row for row in rows if row.reading > 0.0 and math.isfinite(row.reading)]
    places = [1e3 * row.reading for row in hits]
    middle = 0.5 * (min(places) + max(places)) if places else 1e3 * WALL_DISTANCE
    half = 0.5 * max(LEAST_SPAN_MM, *(abs(place - middle) * 2.0 for place in places), 0.0)
    for row, place in zip(hits, places, strict=True):
        _bar(ax, place, row, BAR_MM, counted=len(hits) <= MOST_LABELLED)
    others = [row for row in rows if row not in hits]
    aside = [middle - half * (1.2 + 0.12 * i) for i in range(len(others))]
    for row, place in zip(others, aside, strict=True):
        _bar(ax, place, row, 0.08 * half)
    step = max(math.ceil(2.0 * half / MOST_TICKS), 1)
    ticks = np.arange(math.ceil(middle - half), middle + half + 1e-9, step).tolist()
    names = [f"{1e3 * row.reading:.0f}" for row in others] + [f"{tick:.0f}" for tick in ticks]
    ax.set_xticks(aside + ticks, names)
    ax.set_xlabel("reading [mm]" + ("; the left end is not to scale" if others else ""))


def _draw_open(ax: Axes, rows: list[ValueCount]) -> None:
    """A bar for each value, in no scale."""
    for place, row in enumerate(rows):
        _bar(ax, float(place), row, 0.5)
    ax.set_xticks(range(len(rows)), [f"{1e3 * row.reading:.0f}" for row in rows])
    ax.set_xlim(-0.8, len(rows) - 0.2)
    ax.set_xlabel("reading [mm]; inf: nothing within range")


def _bar(ax: Axes, place: float, row: ValueCount, width: float, *, counted: bool = True) -> None:
    """A bar of one value, with its count above it."""
    ax.bar(place, row.count, width, **_look(row.counts_as))
    if counted:
        over, above = (place, row.count), (0, 2)
        ax.annotate(
            str(row.count), over, above, textcoords="offset points", ha="center", fontsize=8
        )


def _look(kind: str) -> dict[str, Any]:
    colour, hatch = LOOKS[kind]
    return {"facecolor": colour, "hatch": hatch, "edgecolor": "white"}


def _entitle(ax: Axes, place: str, name: str, estimate: Estimate) -> None:
    interval = f"{estimate.low:.3f} to {estimate.high:.3f}"
    ax.set_title(f"{place}\n{name} = {estimate.value:.3f} (95 %: {interval})", fontsize=10)
