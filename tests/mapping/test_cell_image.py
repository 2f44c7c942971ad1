"""Cells drawn pixel by pixel; matplotlib's own image is the oracle."""

import numpy as np
import pytest
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from numpy.typing import NDArray

from mapping.cell_image import CellImage

EXTENT = (-1.0, 3.0, 0.5, 2.5)
LIMITS = [EXTENT, (-0.37, 1.93, 0.81, 1.7), (-4.0, 5.0, -3.0, 6.0), (3.0, -1.0, 2.5, 0.5)]
"""All of it, a part, more than all, and all of it mirrored."""


def picture(draw: str, limits: tuple[float, float, float, float]) -> NDArray[np.uint8]:
    colours = np.random.default_rng(0).integers(0, 256, (37, 61, 3), dtype=np.uint8)
    figure = Figure(figsize=(3.1, 2.3), dpi=70)
    canvas = FigureCanvasAgg(figure)
    ax: Axes = figure.subplots()
    if draw == "cells":
        CellImage(ax, colours, EXTENT)
    else:
        ax.imshow(colours, extent=EXTENT, origin="lower", interpolation="nearest", zorder=0)
    ax.set_aspect("auto")
    ax.set_xlim(limits[0], limits[1])
    ax.set_ylim(limits[2], limits[3])
    canvas.draw()
    return np.asarray(canvas.buffer_rgba())


@pytest.mark.parametrize("limits", LIMITS)
def test_the_picture_is_that_of_matplotlib(limits: tuple[float, float, float, float]) -> None:
    ours, theirs = picture("cells", limits), picture("imshow", limits)
    # a pixel whose centre falls on the edge of two cells may go either way by rounding
    assert np.mean(np.any(ours != theirs, axis=-1)) < 0.01
    assert len(np.unique(ours.reshape(-1, 4), axis=0)) > 100
