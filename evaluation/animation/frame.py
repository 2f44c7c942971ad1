"""Draws one moment of an episode: the map as it then was, and on it what goes on.

Colours are those of ``map.png`` where it shows the same. Pixels are indices into a palette from the
start; Pillow draws a frame so in a few milliseconds, where Matplotlib takes half a second.
"""

import math
from dataclasses import dataclass, field
from itertools import product

import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageDraw, ImageFont

from evaluation.animation.map_canvas import MapCanvas
from evaluation.packed_map import PackedMap
from mapping.burger import ROBOT_RADIUS
from mapping.geometry import Pose
from mapping.grid import FREE, OCCUPIED
from mapping.io.map_server import MapFile
from mapping.path_plot import GOAL_COLOUR, LEFT_OVER_COLOUR, PATH_COLOUR
from mapping.plot import FREE_COLOUR, OCCUPIED_COLOUR, UNKNOWN_COLOUR
from nav.navigator import Plan

SCAN_COLOUR, PEOPLE_COLOUR = "#009e73", "#e69f00"
"""Bluish green and orange of the palette of Okabe and Ito (2008)."""

COLOURS = (
    UNKNOWN_COLOUR,
    FREE_COLOUR,
    OCCUPIED_COLOUR,
    PATH_COLOUR,
    SCAN_COLOUR,
    GOAL_COLOUR,
    LEFT_OVER_COLOUR,
    PEOPLE_COLOUR,
)
_UNKNOWN, _FREE, _OCCUPIED, _PATH, _SCAN, _PLAN, _FRONTIER, _PEOPLE = range(len(COLOURS))

GREYS = 8
"""Shades from black to white, for smooth letters; they follow the colours in the palette."""

ROBOT_RADIUS_LEAST, SPOT_RADIUS, LINE_WIDTH = 6.0, 4.0, 3
"""The robot is never drawn smaller; goals and frontiers; the path and the way ahead [pixels]."""

PERSON_RADIUS = 0.2
"""People are drawn so large [m]: as wide as their hips."""

FONT_SIZE, LINE_HEIGHT, PADDING, KEY_STEP = 14, 20, 6, 84
"""Of the caption under the map, with the keys of the colours in its second line [pixels]."""

KEYS = (("path", _PATH), ("plan", _PLAN), ("frontier", _FRONTIER), ("scan", _SCAN))


def _nowhere() -> NDArray[np.float64]:
    return np.zeros((0, 2))


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Moment:
    """What a frame shows; places are in the map frame [m]."""

    coverage: float
    drawn: PackedMap
    """The map, and when it was so."""
    pose_map: Pose
    path: NDArray[np.float64]
    """Where the robot had been ``(n, 2)``."""
    plan: Plan = Plan()
    scan: NDArray[np.float64] = field(default_factory=_nowhere)
    """Where the newest scan's beams ended ``(n, 2)``."""
    people: NDArray[np.float64] = field(default_factory=_nowhere)
    """Where people were ``(n, 2)``."""


class FramePainter:
    """Draws moments, all in the same place and at the same scale.

    Args:
        title: What captions begin with.
        last_map: What is known in the end, from edge to edge; it makes the bounds.
        people: Whether there are any to be told of.
    """

    def __init__(self, title: str, last_map: MapFile, *, people: bool = False) -> None:
        self._title = title
        self._canvas = MapCanvas(last_map)
        self._keys = (*KEYS, ("people", _PEOPLE)) if people else KEYS
        self._font = ImageFont.load_default(FONT_SIZE)
        greys = [round(255 * grey / (GREYS - 1)) for grey in range(GREYS)]
        self._palette = b"".join(
            [bytes.fromhex(colour[1:]) for colour in COLOURS]
            + [bytes([grey] * 3) for grey in greys]
        )

    def paint(self, moment: Moment) -> Image.Image:
        """The frame of a moment, mode ``P``, every frame of the same size and palette."""
        view = Image.fromarray(self._map_of(moment))
        pen = ImageDraw.Draw(view)
        self._draw_line(pen, moment.plan.path, _PLAN)
        self._draw_line(pen, moment.path, _PATH)
        for place in self._canvas.pixels(moment.plan.frontiers):
            _draw_spot(pen, place, SPOT_RADIUS, _FRONTIER, _FREE)
        if moment.plan.goal is not None:
            goal = self._canvas.pixels(moment.plan.goal[None])[0]
            _draw_spot(pen, goal, SPOT_RADIUS + 1.0, _FREE, _PLAN)
        for place in self._canvas.pixels(moment.people):
            radius = PERSON_RADIUS * self._canvas.pixels_per_metre
            _draw_spot(pen, place, radius, _PEOPLE, _OCCUPIED)
        self._draw_robot(pen, moment.pose_map)
        caption = self._caption(moment, view.width)
        frame = Image.new("P", (view.width, view.height + caption.height))
        frame.putpalette(self._palette)
        frame.paste(view, (0, 0))
        frame.paste(caption, (0, view.height))
        return frame

    def _map_of(self, moment: Moment) -> NDArray[np.uint8]:
        """The map with the scan's ends, a colour a pixel."""
        states = self._canvas.states(moment.drawn.unpack())
        colours = np.full(states.shape, _UNKNOWN, dtype=np.uint8)
        colours[states == FREE] = _FREE
        colours[states == OCCUPIED] = _OCCUPIED
        height, width = states.shape
        ends = np.round(self._canvas.pixels(moment.scan)).astype(np.int64)
        for beside, below in product((-1, 0, 1), repeat=2):
            column, row = ends[:, 0] + beside, ends[:, 1] + below
            inside = (row >= 0) & (row < height) & (column >= 0) & (column < width)
            colours[row[inside], column[inside]] = _SCAN
        return colours

    def _draw_line(
        self, pen: ImageDraw.ImageDraw, places: NDArray[np.float64], colour: int
    ) -> None:
        if len(places) > 1:
            pixels = self._canvas.pixels(places).ravel().tolist()
            pen.line(pixels, fill=colour, width=LINE_WIDTH, joint="curve")

    def _draw_robot(self, pen: ImageDraw.ImageDraw, pose: Pose) -> None:
        """A disc with a line from its middle ahead."""
        radius = max(ROBOT_RADIUS * self._canvas.pixels_per_metre, ROBOT_RADIUS_LEAST)
        middle = self._canvas.pixels(pose[None, :2])[0]
        _draw_spot(pen, middle, radius, _PATH, _OCCUPIED)
        x, y = middle.tolist()
        yaw = float(pose[2])
        ahead = (x + 1.6 * radius * math.cos(yaw), y - 1.6 * radius * math.sin(yaw))
        pen.line([(x, y), ahead], fill=_OCCUPIED, width=LINE_WIDTH)

    def _caption(self, moment: Moment, width: int) -> Image.Image:
        """What stands under the map: which moment it is, and what the colours mean."""
        letters = Image.new("L", (width, 2 * LINE_HEIGHT + 2 * PADDING), 255)
        pen = ImageDraw.Draw(letters)
        text = f"{self._title}    {moment.drawn.time:.0f} s    coverage {moment.coverage:.1%}"
        pen.text((PADDING, PADDING), text, fill=0, font=self._font)
        below = PADDING + LINE_HEIGHT
        starts = [PADDING + KEY_STEP * index for index in range(len(self._keys))]
        for start, (name, _) in zip(starts, self._keys, strict=True):
            pen.text((start + FONT_SIZE, below), name, fill=0, font=self._font)
        shades = np.asarray(letters).astype(np.int64) * (GREYS - 1) // 255 + len(COLOURS)
        caption = Image.fromarray(shades.astype(np.uint8))
        pen = ImageDraw.Draw(caption)
        for start, (_, colour) in zip(starts, self._keys, strict=True):
            middle = np.array((start + SPOT_RADIUS, below + FONT_SIZE / 2.0 + 2.0))
            _draw_spot(pen, middle, SPOT_RADIUS, colour, colour)
        return caption


def _draw_spot(
    pen: ImageDraw.ImageDraw, middle: NDArray[np.float64], radius: float, inside: int, rim: int
) -> None:
    """A disc about a pixel ``(2,)``."""
    x, y = middle.tolist()
    pen.ellipse((x - radius, y - radius, x + radius, y + radius), fill=inside, outline=rim)
