"""Turns the name of a random world, such as ``random:7,rooms=6``, into what is asked of its plan.

``random:SEED`` draws everything from the seed; ``rooms=N``, ``area=M2`` and ``style=NAME`` after
commas fix one thing each. ``random:0..9`` names ten worlds, where a list of worlds is taken.
"""

import re
from dataclasses import dataclass

from mapping.errors import TestbedError

PREFIX = "random:"

MIN_ROOMS, MAX_ROOMS = 2, 15
MIN_AREA, MAX_AREA = 30.0, 450.0
"""Rooms and areas [m2] of the plans that are drawn: a small flat to a floor of offices."""

STYLES = ("apartment", "office", "hall")

MIN_ROOM_AREA = {"apartment": 4.0, "office": 8.0, "hall": 10.0}
"""Area that a room needs by style, on average, with its share of walls and corridors [m2]."""

MIN_STYLE_AREA = {"apartment": MIN_AREA, "office": MIN_AREA, "hall": 50.0}
"""Area that a style needs [m2]."""

MAX_WORLDS = 10_000
"""The most worlds that one range may name."""

_FORM = "random:SEED[,rooms=N][,area=M2][,style=NAME], such as random:7,rooms=6,style=office"


@dataclass(frozen=True, slots=True, kw_only=True)
class RandomWorld:
    """What is asked of a plan that is to be drawn; None leaves it to the seed."""

    seed: int
    rooms: int | None = None
    """Rooms, corridors and halls counted."""
    area: float | None = None
    """Area within the middle line of the outer walls [m2]."""
    style: str | None = None
    """apartment, office (rooms along a corridor) or hall (rooms round a hall)."""

    def __post_init__(self) -> None:
        """Refuse what no plan is drawn for."""
        if self.seed < 0:
            raise TestbedError(f"seed: {self.seed}; must be 0 or more")
        if self.rooms is not None and not MIN_ROOMS <= self.rooms <= MAX_ROOMS:
            raise TestbedError(f"rooms: {self.rooms}; must be {MIN_ROOMS} to {MAX_ROOMS}")
        if self.area is not None and not MIN_AREA <= self.area <= MAX_AREA:  # NaN compares false
            raise TestbedError(f"area: {self.area:g} m2; must be {MIN_AREA:g} to {MAX_AREA:g} m2")
        if self.style is not None and self.style not in STYLES:
            raise TestbedError(f"style: {self.style!r}; must be one of {', '.join(STYLES)}")
        style = self.style or "apartment"  # the style that gets by with least
        least = max(MIN_STYLE_AREA[style], (self.rooms or 0) * MIN_ROOM_AREA[style])
        if self.area is not None and self.area < least:
            count = "" if self.rooms is None else f"{self.rooms} rooms"
            kind = "" if self.style is None else f"style {self.style}"
            what = " in ".join(part for part in (count, kind) if part)
            raise TestbedError(f"area: {self.area:g} m2; must be {least:g} m2 or more for {what}")

    @property
    def name(self) -> str:
        """A name for the plan that can be part of a file's name, such as ``random_7_rooms6``."""
        asked = [f"random_{self.seed}"]
        if self.rooms is not None:
            asked.append(f"rooms{self.rooms}")
        if self.area is not None:
            asked.append(f"area{self.area:g}")
        if self.style is not None:
            asked.append(self.style)
        return "_".join(asked)


def is_random_world(name: str) -> bool:
    """Whether a world's name asks for a random plan, well spelt or not."""
    return name.startswith(PREFIX)


def parse_random_world(name: str) -> RandomWorld:
    """What the name of a random world asks for.

    Raises:
        TestbedError: If it is spelt in another way, or asks for what cannot be drawn.
    """
    seed, *options = name.removeprefix(PREFIX).split(",")
    if _RANGE.fullmatch(seed):
        raise _refused(name, "names many worlds; a range is for burger sweep")
    if not _NUMBER.fullmatch(seed):
        raise _refused(name, f"seed {seed!r} is no whole number of 0 to 18 digits")
    asked: dict[str, str] = {}
    for option in options:
        key, _, value = option.partition("=")
        if key not in ("rooms", "area", "style") or not value:
            raise _refused(name, f"{option!r} is no option")
        if key in asked:
            raise _refused(name, f"{key} stands twice")
        asked[key] = value
    if "rooms" in asked and not _NUMBER.fullmatch(asked["rooms"]):
        raise _refused(name, f"rooms {asked['rooms']!r} is no whole number")
    if "area" in asked and not _DECIMAL.fullmatch(asked["area"]):
        raise _refused(name, f"area {asked['area']!r} is no number")
    try:
        return RandomWorld(
            seed=int(seed),
            rooms=int(asked["rooms"]) if "rooms" in asked else None,
            area=float(asked["area"]) if "area" in asked else None,
            style=asked.get("style"),
        )
    except TestbedError as error:
        raise TestbedError(f"world: {name!r}: {error}") from None


def expand_worlds(names: tuple[str, ...]) -> tuple[str, ...]:
    """Every ``random:FIRST..LAST`` replaced by the worlds that it names; the rest as it stands.

    Raises:
        TestbedError: If a range counts down or names more than ``MAX_WORLDS``.
    """
    worlds: list[str] = []
    for name in names:
        seed, comma, options = name.removeprefix(PREFIX).partition(",")
        match = _RANGE.fullmatch(seed)
        if not is_random_world(name) or match is None:
            worlds.append(name)
            continue
        first, last = int(match[1]), int(match[2])
        if not first <= last < first + MAX_WORLDS:
            raise _refused(name, f"{first}..{last} must count up, over {MAX_WORLDS} worlds at most")
        worlds.extend(f"{PREFIX}{each}{comma}{options}" for each in range(first, last + 1))
    return tuple(worlds)


_NUMBER = re.compile(r"[0-9]{1,18}")
_DECIMAL = re.compile(r"[0-9]{1,9}(\.[0-9]{1,9})?")
_RANGE = re.compile(r"([0-9]{1,18})\.\.([0-9]{1,18})")


def _refused(name: str, why: str) -> TestbedError:
    return TestbedError(f"world: {name!r}: {why}; must be {_FORM}")
