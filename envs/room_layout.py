"""Divides a floor into rooms on a lattice: from an area, a number of rooms and a style to labels.

The lattice is a coarse one of cells, each with the number of its room. A hub, the corridor of
offices or the hall that rooms lie round, is taken out of the outline first; what is left is cut in
two again and again (recursive binary space partition), as architects' test plans are.
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

CELL = 0.1
"""Edge of a cell of the lattice, near enough: the plan is scaled to its area afterwards [m]."""

OUTSIDE = -1
"""Label of the cells that are in no room."""

HUB = 0
"""Label of the corridor or hall, or of the largest room where there is neither."""

Labels = NDArray[np.int64]
Mask = NDArray[np.bool_]
Rect = tuple[int, int, int, int]
"""First row, row after the last, first column, column after the last."""

MIN_SIDE = {"apartment": 1.5, "office": 2.1, "hall": 2.1}
"""Least width of a room by style, walls counted [m]: a bathroom, a cell office."""

CRAMPED_SHARE, CRAMPED_SIDE = 0.6, 1.3
"""Where rooms are many and the floor is little, the least width is this share of the side of an
average square room, and never below so much [m]."""

CORRIDOR_WIDTH = {"apartment": (1.1, 1.6), "office": (1.5, 2.6), "hall": (1.5, 2.6)}
"""Width of corridors by style, walls counted [m]."""

ASPECT = {"apartment": (1.0, 1.9), "office": (1.4, 3.2), "hall": (1.0, 2.0)}
"""Length over width of the whole floor by style."""

SHAPES = {"rectangle": 0.5, "L": 0.25, "U": 0.1, "T": 0.08, "Z": 0.07}
"""How often each outline is drawn."""

WIDE_SHARE = 0.85
"""Share of a room that squares of the least width inside it must cover."""

CUT_TRIES = 30


@dataclass(frozen=True, slots=True, kw_only=True)
class Outline:
    """The shape of a floor and where corridors may run in it."""

    inside: Mask
    corridors: tuple[Rect, ...]
    """A strip through each wing; together they are joined."""


def draw_rooms(style: str, area: float, rooms: int, rng: np.random.Generator) -> Labels | None:
    """Draw a floor and divide it into rooms.

    Args:
        style: One of STYLES.
        area: Wanted area [m2]; the lattice's is near it.
        rooms: How many rooms, hub counted.
        rng: Where chance comes from.

    Returns:
        The room of each cell ``[row, col]``: HUB, 1, 2 ... or OUTSIDE; None when this draw led to
        rooms that are too narrow, and another may do.
    """
    cramped = max(CRAMPED_SHARE * math.sqrt(area / rooms), CRAMPED_SIDE)
    least = _cells(min(MIN_SIDE[style], cramped))
    outline = _draw_outline(style, area, least, rng)
    if not _is_wide(outline.inside, least):
        return None
    hub = _draw_hub(style, outline, rooms, rng)
    labels = np.where(outline.inside, 1, OUTSIDE)
    if hub is not None:
        labels = _separate(np.where(hub, HUB, labels))
    else:
        labels = np.where(outline.inside, HUB, OUTSIDE)
    merges = int(rng.integers(0, 3)) if style == "apartment" and rooms > 3 else 0
    divided = _divide(labels, rooms + merges, least, keep_hub=hub is not None, rng=rng)
    if divided is None:
        return None
    merged = _merge_to(divided, rooms, keep_hub=hub is not None, rng=rng)
    if not all(_is_wide(merged == room, least) for room in range(1, rooms)):
        return None
    return merged if hub is not None else _largest_first(merged)


def _cells(length: float) -> int:
    return max(1, round(length / CELL))


def _draw_outline(style: str, area: float, least: int, rng: np.random.Generator) -> Outline:
    """A floor of one of SHAPES, turned or mirrored by chance."""
    shape = str(rng.choice(list(SHAPES), p=list(SHAPES.values())))
    share_x, share_y = rng.uniform(0.3, 0.5, size=2)
    cut_away = {"rectangle": 0.0, "L": 1.0, "U": 0.8, "T": 1.1, "Z": 1.0}[shape]
    aspect = float(rng.uniform(*ASPECT[style]))
    boxed = area / (1.0 - cut_away * share_x * share_y)
    rows, columns = _cells(math.sqrt(boxed / aspect)), _cells(math.sqrt(boxed * aspect))
    inside = np.ones((rows, columns), dtype=np.bool_)
    cut_rows, cut_columns = round(share_y * rows), round(share_x * columns)
    for cut in _cuts(shape, rows, columns, cut_rows, cut_columns):
        _fill(inside, cut, False)
    wings = _wings(shape, rows, columns, cut_rows, cut_columns)
    corridors = _corridors(wings, style, least, rng)
    if rng.random() < 0.5:
        inside = inside[::-1]
        corridors = tuple((rows - b, rows - a, c, d) for a, b, c, d in corridors)
    return Outline(inside=inside, corridors=corridors)


def _cuts(shape: str, rows: int, columns: int, high: int, wide: int) -> tuple[Rect, ...]:
    """What is cut from the rectangle to leave the shape."""
    top = rows - high
    if shape == "L":
        return ((top, rows, columns - wide, columns),)
    if shape == "U":
        side = (columns - round(0.8 * wide)) // 2
        return ((top, rows, side, columns - side),)
    if shape == "T":
        half = round(0.55 * wide)
        return ((top, rows, 0, half), (top, rows, columns - half, columns))
    if shape == "Z":
        half_high, half_wide = round(0.7 * high), round(0.7 * wide)
        return (
            (rows - half_high, rows, columns - half_wide, columns),
            (0, half_high, 0, half_wide),
        )
    return ()


def _wings(shape: str, rows: int, columns: int, high: int, wide: int) -> tuple[Rect, ...]:
    """The wings of the shape: one along the rows, then those that stand on it."""
    base = (0, rows - high, 0, columns)
    if shape == "L":
        return base, (0, rows, 0, columns - wide)
    if shape == "U":
        side = (columns - round(0.8 * wide)) // 2
        return base, (0, rows, 0, side), (0, rows, columns - side, columns)
    if shape == "T":
        half = round(0.55 * wide)
        return base, (0, rows, half, columns - half)
    if shape == "Z":
        half_high = round(0.7 * high)
        return ((half_high, rows - half_high, 0, columns),)
    return ((0, rows, 0, columns),)


def _corridors(
    wings: tuple[Rect, ...], style: str, least: int, rng: np.random.Generator
) -> tuple[Rect, ...]:
    """A strip along each wing; those of the further wings begin at the first one's."""
    width = _cells(float(rng.uniform(*CORRIDOR_WIDTH[style])))
    first, last, left, right = wings[0]
    bottom = first + _corridor_offset(last - first, width, least, rng)
    strips = [(bottom, bottom + width, left, right)]
    for _, wing_last, wing_left, wing_right in wings[1:]:
        offset = wing_left + _corridor_offset(wing_right - wing_left, width, least, rng)
        strips.append((bottom, wing_last, offset, offset + width))
    return tuple(strips)


def _corridor_offset(across: int, width: int, least: int, rng: np.random.Generator) -> int:
    """Where across a wing the corridor lies: between two rows of rooms, or along one."""
    left_over = across - width
    if left_over < 2 * least:
        return 0 if rng.random() < 0.5 else max(left_over, 0)
    middle = left_over // 2
    play = min(middle - least, left_over // 6)
    return middle + int(rng.integers(-play, play + 1))


def _draw_hub(style: str, outline: Outline, rooms: int, rng: np.random.Generator) -> Mask | None:
    """The corridor or the hall; None for a flat whose rooms open into each other."""
    hub = np.zeros_like(outline.inside)
    if style == "office" or (style == "apartment" and rooms >= 4 and rng.random() < 0.6):
        for strip in outline.corridors:
            _fill(hub, strip, True)
        return np.asarray(hub & outline.inside)
    if style == "apartment":
        return None
    rows, columns = hub.shape
    deepest = 0.33 * min(rows, columns)
    sides = np.zeros(4, dtype=np.bool_)
    sides[rng.permutation(4)[: int(rng.integers(1, min(rooms, 5)))]] = True
    depths = np.where(sides, np.minimum(_cells(1.0) * rng.uniform(2.4, 4.0, size=4), deepest), 0.0)
    below, above, left, right = depths.astype(int)
    _fill(hub, (below, rows - above, left, columns - right), True)
    return np.asarray(hub & outline.inside)


def _fill(mask: Mask, rect: Rect, value: bool) -> None:
    first, last, left, right = rect
    mask[first:last, left:right] = value


def _separate(labels: Labels) -> Labels:
    """Each piece that the hub leaves of the rest as a room of its own."""
    pieces, _ = ndimage.label(labels > HUB)
    return np.where(pieces > 0, pieces, labels)


def _divide(
    labels: Labels, rooms: int, least: int, *, keep_hub: bool, rng: np.random.Generator
) -> Labels | None:
    """Cut rooms, the larger the likelier, until there are so many; None when none can be cut."""
    labels = labels.copy()
    for _ in range(CUT_TRIES):
        count = int(labels.max()) + 1
        if count >= rooms:
            return labels
        sizes = np.bincount(labels[labels >= 0], minlength=count).astype(np.float64) ** 2
        if keep_hub:
            sizes[HUB] = 0.0
        if sizes.sum() == 0.0:
            return None
        room = int(rng.choice(count, p=sizes / sizes.sum()))
        part = _cut(labels == room, least, rng)
        if part is not None:
            labels[part] = count
    return None


def _cut(room: Mask, least: int, rng: np.random.Generator) -> Mask | None:
    """The part of a room beyond a straight cut, that both leaves wide enough and whole."""
    rows, columns = (np.flatnonzero(room.any(axis=axis)) for axis in (1, 0))
    high, wide = len(rows), len(columns)
    across_rows = high > wide if abs(high - wide) > 0.2 * max(high, wide) else rng.random() < 0.5
    lines = rows if across_rows else columns
    if len(lines) < 2 * least:
        return None
    at = lines[0] + int(np.clip(rng.uniform(0.3, 0.7) * len(lines), least, len(lines) - least))
    beyond = np.zeros_like(room)
    if across_rows:
        beyond[at:] = room[at:]
    else:
        beyond[:, at:] = room[:, at:]
    rest = room & ~beyond
    whole = all(ndimage.label(part)[1] == 1 for part in (beyond, rest))
    return beyond if whole and _is_wide(beyond, least) and _is_wide(rest, least) else None


def _is_wide(room: Mask, least: int) -> bool:
    """Whether squares of the least width cover nearly all of it (a morphological opening)."""
    size = least | 1
    narrowed = ndimage.minimum_filter(room, size=size, mode="constant", cval=0)
    opened = ndimage.maximum_filter(narrowed, size=size, mode="constant", cval=0)
    return bool(np.count_nonzero(opened) >= WIDE_SHARE * np.count_nonzero(room))


def _merge_to(labels: Labels, rooms: int, *, keep_hub: bool, rng: np.random.Generator) -> Labels:
    """Join neighbours until no more than so many rooms are left: some become L-shaped."""
    labels = labels.copy()
    while labels.max() + 1 > rooms:
        borders = border_lengths(labels)
        pairs = [pair for pair in borders if not (keep_hub and HUB in pair)] or list(borders)
        weights = np.array([borders[pair] for pair in pairs], dtype=np.float64)
        kept, gone = pairs[int(rng.choice(len(pairs), p=weights / weights.sum()))]
        labels[labels == gone] = kept
        labels[labels > gone] -= 1
    return labels


def border_lengths(labels: Labels) -> dict[tuple[int, int], int]:
    """How many edges of cells each two rooms share, by their labels, the lower first."""
    lengths: dict[tuple[int, int], int] = {}
    for first, second in ((labels[1:], labels[:-1]), (labels[:, 1:], labels[:, :-1])):
        differ = (first != second) & (first >= 0) & (second >= 0)
        both = np.sort(np.stack((first[differ], second[differ]), axis=1), axis=1)
        pairs, counts = np.unique(both, axis=0, return_counts=True)
        for (a, b), count in zip(pairs.tolist(), counts.tolist(), strict=True):
            lengths[a, b] = lengths.get((a, b), 0) + count
    return lengths


def _largest_first(labels: Labels) -> Labels:
    """The same rooms, the largest as HUB."""
    sizes = np.bincount(labels[labels >= 0])
    largest = int(np.argmax(sizes))
    swapped = labels.copy()
    swapped[labels == largest] = HUB
    swapped[labels == HUB] = largest
    return swapped
