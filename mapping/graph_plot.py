"""Turns a pose graph before and after optimisation into a picture of both, side by side."""

from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from mapping.io.atomic import write_atomically
from mapping.pose_graph import PoseGraph

WAY_COLOUR, TIE_COLOUR, HELD_COLOUR = "#0072b2", "#e69f00", "#000000"
"""Blue and orange that colour-blind eyes tell apart (Okabe and Ito), and black."""

SIZE, DPI = (12.0, 6.6), 120
"""Of the picture [inch], and its dots per inch."""


def save_graph_picture(
    file: str | Path, before: PoseGraph, after: PoseGraph, titles: tuple[str, str] = ("", "")
) -> None:
    """Save a picture as png, without any display; the same graphs give the same bytes.

    Args:
        file: Where to.
        before: The graph, on the left.
        after: The same with other poses, on the right.
        titles: A line above each.

    Raises:
        TestbedError: The folder cannot be written.
    """
    figure = Figure(figsize=SIZE, layout="constrained")
    canvas = FigureCanvasAgg(figure)
    for ax, graph, title in zip(figure.subplots(1, 2), (before, after), titles, strict=True):
        draw_graph(ax, graph)
        ax.set_title(title, fontsize=10)
    handles = [
        Line2D([], [], color=WAY_COLOUR, label="edges between neighbours in the file"),
        Line2D([], [], color=TIE_COLOUR, label="other edges"),
        Line2D([], [], color=HELD_COLOUR, marker="o", linestyle="", label="held"),
    ]
    figure.legend(handles=handles, loc="outside lower center", ncols=3, fontsize=8, frameon=False)
    figure.set_dpi(DPI)
    write_atomically(file, lambda out: canvas.print_png(out, metadata={"Software": None}))


def draw_graph(ax: Axes, graph: PoseGraph) -> None:
    """Draw a pose graph into axes, in metres: its edges, those along the way on top."""
    order = np.argsort(graph.ids)
    rows = order[np.searchsorted(graph.ids, graph.edges, sorter=order)]
    lines = graph.poses[rows, :2]
    along = np.abs(rows[:, 0] - rows[:, 1]) == 1
    ax.add_collection(LineCollection(lines[~along], colors=TIE_COLOUR, linewidths=0.5))
    ax.add_collection(LineCollection(lines[along], colors=WAY_COLOUR, linewidths=0.8))
    held = graph.poses[np.isin(graph.ids, graph.fixed or graph.ids[:1]), :2]
    ax.plot(*held.T, "o", color=HELD_COLOUR, markersize=4)
    ax.autoscale_view()
    ax.set_aspect("equal", adjustable="datalim")
    ax.set_xlabel("x [m]")
    ax.set_ylabel("y [m]")
