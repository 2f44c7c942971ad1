"""Draws a map as the thesis does, as an SVG element that can stand in a page: start heading up."""

import base64
import io
from html import escape

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from evaluation.thesis.figure import MapView
from mapping.grid import FREE, OCCUPIED, UNKNOWN
from mapping.path_plot import PATH_COLOUR
from mapping.plot import FREE_COLOUR, OCCUPIED_COLOUR, UNKNOWN_COLOUR
from mapping.thesis_plot import thesis_cells

FILLED_COLOUR = "#d55e00"
"""Vermilion of the palette of Okabe and Ito (2008)."""

CM = 0.01
"""Unit of the axes [m]: a cell of the thesis's map."""

MARGIN = 0.25
"""Shown around what is drawn [m]."""

LEFT, BELOW, EDGE = 40, 34, 8
"""Room for the axes, and at the other edges [pixels]."""

TICKS = (50, 100, 200, 500)
"""Steps between ticks [cm]; the first of which at most MOST_TICKS fit is taken."""

MOST_TICKS = 6

LEAST_STEP = 1.5
"""Points of a path nearer to each other than this [pixels] are left out."""

_Points = NDArray[np.float64]
_Box = tuple[float, float, float, float]


def svg_of(view: MapView) -> str:
    """The picture: cells as an image, the path and the axes as lines and text."""
    box = _box(view)
    width, height = ((b - a) * CM * view.scale for a, b in (box[:2], box[2:]))
    data = base64.b64encode(_png(view, box, pooled=True)).decode()
    parts = [
        f'<svg class="map" role="img" aria-label="{escape(view.title)}" '
        f'viewBox="0 0 {LEFT + width + EDGE:.0f} {EDGE + height + BELOW:.0f}" '
        f'style="width:{LEFT + width + EDGE:.0f}px">',
        f'<image x="{LEFT}" y="{EDGE}" width="{width:.1f}" height="{height:.1f}" '
        f'preserveAspectRatio="none" href="data:image/png;base64,{data}"/>',
        _path(view, box),
        f'<rect class="frame" x="{LEFT}" y="{EDGE}" width="{width:.1f}" height="{height:.1f}"/>',
        *_axes(box, view.scale, width, height),
        "</svg>",
    ]
    return "".join(parts)


def picture_kb(view: MapView) -> float:
    """Size of the picture of a map's cells as a png file, a pixel a cell [kB]."""
    return len(_png(view, _box(view), pooled=False)) / 1e3


def _png(view: MapView, box: _Box, *, pooled: bool) -> bytes:
    """The cells in a box of centimetres as a png; pooled, a pixel is at least half one on the page.

    Occupied cells win over filled ones, these over free ones.
    """
    run = view.run
    block = max(int(np.ceil(0.75 / (run.map.resolution * view.scale))), 1) if pooled else 1
    pixel = run.map.resolution / CM * block
    shape = (int(np.ceil((box[3] - box[2]) / pixel)), int(np.ceil((box[1] - box[0]) / pixel)))
    image = np.full(shape, 0 if view.obstacles_only else 3, dtype=np.uint8)
    layers = [(run.map.states == OCCUPIED, 1)]
    if view.filled is not None:
        layers.insert(0, (view.filled, 2))
    if not view.obstacles_only:
        layers.insert(0, (run.map.states == FREE, 0))
    for cells, colour in layers:
        places = thesis_cells(run.centres(cells), view.start, CM)
        columns, rows = np.floor((places - (box[0], box[2])) / pixel).astype(np.int64).T
        inside = (rows >= 0) & (rows < shape[0]) & (columns >= 0) & (columns < shape[1])
        image[rows[inside], columns[inside]] = colour
    picture = Image.fromarray(np.flipud(image), mode="P")
    colours = (FREE_COLOUR, OCCUPIED_COLOUR, FILLED_COLOUR, UNKNOWN_COLOUR)
    picture.putpalette(b"".join(bytes.fromhex(colour[1:]) for colour in colours))
    file = io.BytesIO()
    picture.save(file, format="PNG", optimize=True)
    return file.getvalue()


def _box(view: MapView) -> _Box:
    """Left, right, bottom and top of the picture, in whole centimetres of the thesis's frame."""
    if view.window is not None:
        left, right, bottom, top = view.window
        points = np.array([(x, y) for x in (left, right) for y in (bottom, top)])
        margin = 0.0
    else:
        states = view.run.map.states
        shown = states == OCCUPIED if view.obstacles_only else states != UNKNOWN
        points = np.concatenate((view.run.centres(shown), view.path, [view.start[:2]]))
        margin = MARGIN / CM
    cells = thesis_cells(points, view.start, CM)
    low, high = np.floor(cells.min(axis=0) - margin), np.ceil(cells.max(axis=0) + margin)
    return float(low[0]), float(high[0]), float(low[1]), float(high[1])


def _path(view: MapView, box: _Box) -> str:
    """The path, its points no nearer than they can be told apart."""
    if len(view.path) == 0:
        return ""
    cells = thesis_cells(view.path, view.start, CM)
    x = LEFT + (cells[:, 0] - box[0]) * CM * view.scale
    y = EDGE + (box[3] - cells[:, 1]) * CM * view.scale
    points = [(float(x[0]), float(y[0]))]
    for each in zip(x.tolist(), y.tolist(), strict=True):
        if np.hypot(each[0] - points[-1][0], each[1] - points[-1][1]) >= LEAST_STEP:
            points.append(each)
    right = LEFT + (box[1] - box[0]) * CM * view.scale
    bottom = EDGE + (box[3] - box[2]) * CM * view.scale
    told, pen = [], "M"
    for px, py in points:
        inside = LEFT <= px <= right and EDGE <= py <= bottom
        if inside:
            told.append(f"{pen}{px:.1f} {py:.1f}")
        pen = "L" if inside else "M"
    return f'<path class="way" stroke="{PATH_COLOUR}" d="{"".join(told)}"/>'


def _axes(box: _Box, scale: float, width: float, height: float) -> list[str]:
    """Ticks and their numbers along the left and the lower edge."""
    parts = []
    floor = EDGE + height
    for tick in _ticks(box[0], box[1], width):
        at = LEFT + (tick - box[0]) * CM * scale
        parts.append(f'<path class="tick" d="M{at:.1f} {floor:.1f}v4"/>')
        parts.append(f'<text x="{at:.1f}" y="{floor + 15:.1f}" text-anchor="middle">{tick}</text>')
    for tick in _ticks(box[2], box[3], height):
        at = EDGE + (box[3] - tick) * CM * scale
        parts.append(f'<path class="tick" d="M{LEFT} {at:.1f}h-4"/>')
        parts.append(f'<text x="{LEFT - 6}" y="{at + 3.5:.1f}" text-anchor="end">{tick}</text>')
    parts.append(
        f'<text x="{LEFT + width / 2:.1f}" y="{floor + 29:.1f}" text-anchor="middle">'
        "x′, y′ [cells of 1 cm]</text>"
    )
    return parts


def _ticks(low: float, high: float, pixels: float) -> range:
    """Round numbers between two, not too many for so many pixels."""
    most = max(min(MOST_TICKS, int(pixels // 40)), 2)
    step = next((step for step in TICKS if (high - low) / step <= most), TICKS[-1])
    return range(int(np.ceil(low / step)) * step, int(high) + 1, step)
