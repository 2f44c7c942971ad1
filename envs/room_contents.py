"""What stands in which kind of room: a list of pieces to place, the most telling first."""

from dataclasses import dataclass
from typing import Literal

import numpy as np

from envs.furniture import (
    Maker,
    armchair,
    bin_of,
    block,
    corner_sofa,
    desk,
    dining_table,
    kitchen_corner,
    lone_chair,
    low_table,
    round_table,
    screen,
)

Place = Literal["wall", "free"]

WARDROBE = block((0.8, 2.4), (0.55, 0.65), 2.0)
SHELF = block((0.6, 1.6), (0.25, 0.40), 1.9)
SIDEBOARD = block((1.0, 1.9), (0.38, 0.5), 0.75)
BED = block((0.9, 1.8), (2.0, 2.1), 0.5)
NIGHTSTAND = block((0.4, 0.5), (0.35, 0.45), 0.5)
SOFA = block((1.5, 2.3), (0.8, 1.0), 0.8)
COUNTER = block((1.8, 3.2), (0.6, 0.65), 0.9)
FRIDGE = block((0.6, 0.75), (0.6, 0.7), 1.8)
TUB = block((1.5, 1.7), (0.7, 0.75), 0.55)
SHOWER = block((0.8, 0.95), (0.8, 0.95), 0.35)
BASIN = block((0.5, 0.8), (0.42, 0.5), 0.85)
TOILET = block((0.36, 0.4), (0.55, 0.68), 0.45)
CABINET = block((0.8, 1.2), (0.4, 0.45), 1.2)
BENCH = block((1.0, 1.8), (0.4, 0.5), 0.45)
CRATE = block((0.35, 1.2), (0.3, 0.8), 0.7)
BIN = bin_of((0.10, 0.20), 0.4)
POT = bin_of((0.15, 0.28), 0.6)
PILLAR = bin_of((0.12, 0.30), 2.5)


@dataclass(frozen=True, slots=True, kw_only=True)
class Wanted:
    """A piece to place, and where it belongs."""

    maker: Maker
    place: Place = "wall"


def _wall(*makers: Maker) -> tuple[Wanted, ...]:
    return tuple(Wanted(maker=maker) for maker in makers)


def _free(*makers: Maker) -> tuple[Wanted, ...]:
    return tuple(Wanted(maker=maker, place="free") for maker in makers)


_LIVING = (_wall(corner_sofa, SOFA, SIDEBOARD, SHELF, armchair, POT), _free(low_table, armchair))
_DINING = (_wall(SIDEBOARD, lone_chair), _free(dining_table, round_table))
_KITCHEN = (_wall(kitchen_corner, COUNTER, FRIDGE, BIN), _free(dining_table, lone_chair))
_BEDROOM = (_wall(BED, WARDROBE, NIGHTSTAND, NIGHTSTAND, desk, lone_chair, BIN), ())
_BATH = (_wall(TUB, TOILET, BASIN, SHOWER, BIN), ())
_STORE = (_wall(SHELF, SHELF, CRATE, CRATE, WARDROBE), _free(CRATE))
_CORRIDOR = (_wall(SIDEBOARD, POT, CABINET, BIN), ())
_OFFICE = (_wall(desk, desk, CABINET, SHELF, BIN, desk, POT), _free(lone_chair))
_MEETING = (_wall(SIDEBOARD, POT, BIN), _free(dining_table, dining_table))
_BREAK_ROOM = (_wall(COUNTER, FRIDGE, BIN, SOFA), _free(round_table, round_table))
_HALL = (
    _wall(BENCH, POT, CABINET, BENCH, BIN, POT),
    _free(PILLAR, PILLAR, round_table, screen, PILLAR, BENCH, CRATE, screen),
)

PIECE_AREA = {"hall": 6.0, "corridor": 6.0}
"""Floor for each piece by kind of room [m2]; two and a half of others."""

OTHER_PIECE_AREA = 2.5

CONTENTS = {
    "living": _LIVING,
    "dining": _DINING,
    "kitchen": _KITCHEN,
    "bedroom": _BEDROOM,
    "bath": _BATH,
    "store": _STORE,
    "corridor": _CORRIDOR,
    "office": _OFFICE,
    "meeting": _MEETING,
    "break_room": _BREAK_ROOM,
    "hall": _HALL,
}
"""Kind of room -> what stands along its walls, what stands free in it."""


def kind_of_room(
    style: str, area: float, width: float, *, is_hub: bool, rng: np.random.Generator
) -> str:
    """What a room is for, by the building's style and the room's area [m2] and width [m]."""
    if is_hub and style == "hall":
        return "hall"
    if is_hub and (style == "office" or width < 2.0):
        return "corridor"
    if style == "apartment":
        if is_hub or area > 22.0:
            return "living"
        small = ["bath", "bath", "store", "kitchen"] if area < 7.0 else []
        return str(rng.choice(small or ["bedroom", "bedroom", "kitchen", "dining", "office"]))
    if area < 6.0:
        return str(rng.choice(["store", "bath"]))
    return str(rng.choice(["office", "office", "office", "meeting", "break_room", "store"]))


def wanted_in(kind: str, area: float, clutter: float, rng: np.random.Generator) -> list[Wanted]:
    """What to place in a room of a kind and an area [m2], clutter times as much as is usual."""
    walls, free = CONTENTS[kind]
    count = round(clutter * area / PIECE_AREA.get(kind, OTHER_PIECE_AREA) * rng.uniform(0.6, 1.2))
    all_of_it = [*walls[:2], *free[:1], *walls[2:], *free[1:]]
    again = (count + len(all_of_it) - 1) // len(all_of_it)
    rest = all_of_it[2:] * max(again, 1)
    rng.shuffle(rest)
    return [*all_of_it[:2], *rest][:count]
