"""Turns a lattice of rooms into a building: walls between them, and doors through the walls."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from envs.building_frame import BuildingFrame
from envs.floor_plan import Point, Wall
from envs.room_layout import HUB, OUTSIDE, Labels, border_lengths

WALL_HEIGHT = 2.5

OUTER_THICKNESS = (0.15, 0.25)
INNER_THICKNESS = (0.05, 0.15)
"""Thickness of walls [m]: masonry outside, plasterboard to brick inside."""

DOOR_WIDTHS = ((0.72, 0.70, 1.00), (0.17, 1.00, 1.20), (0.09, 0.45, 0.70), (0.02, 0.35, 0.45))
"""Clear widths of doors [m]: how often, from, to."""

NARROW_DOOR = (0.30, 0.35)
"""Clear width of the rare narrow door [m]: the narrowest that the robot is to pass is 0.30 m."""

NARROW_SHARE = 0.1
"""How many plans have one."""

JAMB = 0.08
"""Wall left between a door and the next wall's face [m]."""

EXTRA_DOOR_SHARE = {"apartment": 0.25, "office": 0.1, "hall": 0.15}
"""How many of the walls between rooms that are joined otherwise have a door, too."""

WEDGE_SHARE, MAX_WEDGE = 0.2, 0.22
TURNED_SHARE = 0.5
"""How many buildings are wedge-shaped, and stand at an angle to the world's axes."""

Line = NDArray[np.float64]
"""A straight piece ``(2, 2)``: its ends."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Door:
    """An opening in a wall between two rooms."""

    rooms: tuple[int, int]
    center: Point
    """Middle of the opening [m]."""
    yaw: float
    """Direction along the wall [rad]; the first room lies to its left."""
    width: float
    """Clear width [m]."""
    thickness: float
    """Thickness of the wall [m]."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Building:
    """Rooms in the world, with walls and doors, and nothing in them."""

    style: str
    labels: Labels
    """Room of each cell of the lattice ``[row, col]``."""
    frame: BuildingFrame
    walls: tuple[Wall, ...]
    doors: tuple[Door, ...]
    sides: tuple[tuple[int, Point, Point, float], ...]
    """The straight walls round each room: room, ends [m] with the room to the left of the way from
    the first to the second, thickness [m]."""

    @property
    def rooms(self) -> int:
        """How many rooms there are."""
        return int(self.labels.max()) + 1

    def room_at(self, points: ArrayLike) -> NDArray[np.int64]:
        """The room at each point ``(n, 2)`` [m], or OUTSIDE; walls belong to the rooms by them."""
        columns, rows = np.floor(self.frame.to_lattice(points)).astype(np.int64).T
        within = (rows >= 0) & (rows < self.labels.shape[0])
        within &= (columns >= 0) & (columns < self.labels.shape[1])
        rooms = np.full(len(rows), OUTSIDE, dtype=np.int64)
        rooms[within] = self.labels[rows[within], columns[within]]
        return rooms


def build(
    style: str, labels: Labels, frame: BuildingFrame, rng: np.random.Generator
) -> Building | None:
    """Put up walls and cut doors so that every room can be entered; None where no door fits."""
    outer, inner = (float(rng.uniform(*each)) for each in (OUTER_THICKNESS, INNER_THICKNESS))
    borders = _borders(labels)
    doors = _doors(style, labels, frame, borders, inner, rng)
    if doors is None:
        return None
    walls = [
        _wall(_extended(frame.to_world(line), 0.5 * outer), outer)
        for (one, _), lines in _borders(np.minimum(labels, HUB)).items()
        for line in lines
        if one == OUTSIDE
    ]
    for pair, lines in borders.items():
        if pair[0] == OUTSIDE:
            continue
        for line in lines:
            ends = _extended(frame.to_world(line), 0.5 * inner)
            openings = [door for door in doors if door.rooms == pair and _lies_on(door, ends)]
            walls.extend(_wall(piece, inner) for piece in _pieces(ends, openings))
    return Building(
        style=style,
        labels=labels,
        frame=frame,
        walls=tuple(walls),
        doors=tuple(doors),
        sides=tuple(_sides(frame, borders, outer, inner)),
    )


def _borders(labels: Labels) -> dict[tuple[int, int], list[Line]]:
    """The straight lines between each two labels, in lattice coordinates.

    The lower label lies to the right of the way from a line's first end to its second.
    """
    padded = np.pad(labels, 1, constant_values=OUTSIDE)
    lines: dict[tuple[int, int], list[Line]] = {}
    for row in range(1, len(padded)):
        for below, above, start, end in _runs(padded[row - 1], padded[row]):
            ends = [(start - 1, row - 1), (end - 1, row - 1)]
            _note(lines, above, below, ends)
    for column in range(1, padded.shape[1]):
        for before, after, start, end in _runs(padded[:, column - 1], padded[:, column]):
            ends = [(column - 1, start - 1), (column - 1, end - 1)]
            _note(lines, before, after, ends)
    return lines


def _note(
    lines: dict[tuple[int, int], list[Line]], left: int, right: int, ends: list[tuple[int, int]]
) -> None:
    """Note a line that has these labels to its left and right."""
    ends = ends if right < left else ends[::-1]
    lines.setdefault((min(left, right), max(left, right)), []).append(
        np.array(ends, dtype=np.float64)
    )


def _runs(first: Labels, second: Labels) -> list[tuple[int, int, int, int]]:
    """Where two rows of labels differ the same way: both labels, start, end."""
    changes = np.flatnonzero((np.diff(first) != 0) | (np.diff(second) != 0)) + 1
    starts = [0, *changes.tolist()]
    ends = [*changes.tolist(), len(first)]
    return [
        (int(first[start]), int(second[start]), start, end)
        for start, end in zip(starts, ends, strict=True)
        if first[start] != second[start]
    ]


def _doors(
    style: str,
    labels: Labels,
    frame: BuildingFrame,
    borders: dict[tuple[int, int], list[Line]],
    thickness: float,
    rng: np.random.Generator,
) -> list[Door] | None:
    """Doors that join all rooms, through the hub where that can be, and some more."""
    pairs = list(border_lengths(labels))
    rng.shuffle(pairs)
    pairs.sort(key=lambda pair: HUB not in pair)
    narrow = int(rng.integers(len(pairs))) if rng.random() < NARROW_SHARE else None
    joined = list(range(int(labels.max()) + 1))
    doors: list[Door] = []
    for i, pair in enumerate(pairs):
        one, other = pair
        if joined[one] == joined[other] and rng.random() >= EXTRA_DOOR_SHARE[style]:
            continue
        width = float(rng.uniform(*NARROW_DOOR)) if i == narrow else _door_width(rng)
        lines = [frame.to_world(line) for line in borders[pair]]
        door = _door(pair, lines, width, thickness, rng)
        if door is None:
            continue
        doors.append(door)
        joined = [joined[one] if each == joined[other] else each for each in joined]
    return doors if len(set(joined)) == 1 else None


def _door_width(rng: np.random.Generator) -> float:
    shares, least, most = zip(*DOOR_WIDTHS, strict=True)
    kind = int(rng.choice(len(shares), p=shares))
    return float(rng.uniform(least[kind], most[kind]))


def _door(
    pair: tuple[int, int],
    lines: list[Line],
    width: float,
    thickness: float,
    rng: np.random.Generator,
) -> Door | None:
    """A door somewhere in the walls between two rooms; None if it fits in none of them."""
    lengths = np.array([np.hypot(*(line[1] - line[0])) for line in lines])
    rooms_left = lengths - width - 2.0 * JAMB - OUTER_THICKNESS[1]
    if np.all(rooms_left < 0.0):
        return None
    chances = np.maximum(rooms_left, 0.0) + 1e-6 * (rooms_left >= 0.0)
    chosen = int(rng.choice(len(lines), p=chances / chances.sum()))
    start, end = lines[chosen]
    # doors stand by the end of a wall more often than in its middle
    place = float(rng.beta(0.6, 0.6))
    edge = 0.5 * (width + OUTER_THICKNESS[1]) + JAMB
    center = start + (end - start) * (edge + place * rooms_left[chosen]) / lengths[chosen]
    return Door(
        rooms=pair,
        center=(float(center[0]), float(center[1])),
        yaw=float(np.arctan2(*(start - end)[::-1])),  # turned round: the first room to the left
        width=width,
        thickness=thickness,
    )


def _extended(line: Line, by: float) -> Line:
    """A line made longer at both ends [m], so that walls meet without a notch."""
    along = (line[1] - line[0]) / np.hypot(*(line[1] - line[0]))
    return np.array([line[0] - by * along, line[1] + by * along])


def _lies_on(door: Door, line: Line) -> bool:
    """Whether a door's middle lies on a line."""
    along = line[1] - line[0]
    length = float(np.hypot(*along))
    to_door = np.array(door.center) - line[0]
    across = abs(float(along[0] * to_door[1] - along[1] * to_door[0])) / length
    return across < 1e-6 and 0.0 <= float(along @ to_door) / length <= length


def _pieces(line: Line, openings: list[Door]) -> list[Line]:
    """What doors leave of a wall's line."""
    length = float(np.hypot(*(line[1] - line[0])))
    along = (line[1] - line[0]) / length
    at = 0.0
    pieces = []
    for middle, width in sorted(
        (float(along @ (np.array(door.center) - line[0])), door.width) for door in openings
    ):
        pieces.append((at, middle - 0.5 * width))
        at = middle + 0.5 * width
    pieces.append((at, length))
    return [np.array([line[0] + a * along, line[0] + b * along]) for a, b in pieces]


def _wall(line: Line, thickness: float) -> Wall:
    (x0, y0), (x1, y1) = line.tolist()
    return Wall(points=((x0, y0), (x1, y1)), thickness=thickness, height=WALL_HEIGHT)


def _sides(
    frame: BuildingFrame, borders: dict[tuple[int, int], list[Line]], outer: float, inner: float
) -> list[tuple[int, Point, Point, float]]:
    """Both faces of every line between rooms, each for the room on its side."""
    sides = []
    for (lower, higher), lines in borders.items():
        thickness = outer if lower == OUTSIDE else inner
        for line in lines:
            (x0, y0), (x1, y1) = frame.to_world(line).tolist()
            sides.append((higher, (x0, y0), (x1, y1), thickness))
            if lower != OUTSIDE:
                sides.append((lower, (x1, y1), (x0, y0), thickness))
    return sides
