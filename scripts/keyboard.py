"""Turns the bytes that a terminal sends into keys, and keys into what they stand for."""

from enum import Enum, auto

from nav.teleop import TeleopCommand


class Request(Enum):
    """What a person may want of the program."""

    PLOT = auto()
    """Save a picture of the map as it is now."""
    QUIT = auto()
    """Save everything and leave."""


KEYS: dict[str, TeleopCommand | Request] = {
    "w": TeleopCommand.FORWARD,
    "up": TeleopCommand.FORWARD,
    "x": TeleopCommand.BACKWARD,
    "down": TeleopCommand.BACKWARD,
    "a": TeleopCommand.LEFT,
    "left": TeleopCommand.LEFT,
    "d": TeleopCommand.RIGHT,
    "right": TeleopCommand.RIGHT,
    "s": TeleopCommand.STOP,
    "space": TeleopCommand.STOP,
    "g": TeleopCommand.GO,
    "p": Request.PLOT,
    "q": Request.QUIT,
}
"""Keys as turtlebot3_teleop has them (teleop_keyboard.py@da785b7), and this testbed's own."""

KEYS_TOLD = "w/x a/d or arrows drive, s stops, g autonomous, p plots the map, q saves and quits"

_ESCAPE, _CONTROL, _SINGLE = 0x1B, ord("["), ord("O")
"""An arrow key sends ESC [ A, or ESC O A in a terminal's application mode (ECMA-48, xterm)."""

_FIRST_FINAL, _LAST_FINAL = 0x40, 0x7E
"""A control sequence ends with a byte from here to there (ECMA-48)."""

_ARROWS = {ord("A"): "up", ord("B"): "down", ord("C"): "right", ord("D"): "left"}


def command_of(key: str) -> TeleopCommand | Request | None:
    """What a key stands for, None if for nothing; capitals count, should Caps Lock be on."""
    return KEYS.get(key.lower())


class KeyDecoder:
    """Names the keys in a stream of bytes, however the stream is cut into pieces."""

    def __init__(self) -> None:
        self._sequence = ""
        """How far into an escape sequence the stream is: ``""``, ``esc``, ``[``, ``O`` or ``[[``,
        as F1 to F5 have it on Linux's console."""

    def feed(self, piece: bytes) -> list[str]:
        """The keys that end in this piece: characters, ``space``, ``up``, ``down``, ...

        Escape sequences of keys that have no name here are left out whole, and so are bytes that
        are no ASCII character.
        """
        return [key for byte in piece if (key := self._take(byte)) is not None]

    def _take(self, byte: int) -> str | None:
        """The key that ends with a byte, if one does."""
        if byte == _ESCAPE:
            self._sequence = "esc"
            return None
        if self._sequence == "esc" and byte in (_CONTROL, _SINGLE):
            self._sequence = chr(byte)
            return None
        if self._sequence.startswith("[") and not _FIRST_FINAL <= byte <= _LAST_FINAL:
            return None
        if self._sequence == "[" and byte == _CONTROL:
            self._sequence = "[["
            return None
        inside, self._sequence = self._sequence, ""
        if inside == "[[":
            return None
        if inside in ("[", "O"):
            return _ARROWS.get(byte)
        if byte == ord(" "):
            return "space"
        return chr(byte) if 0x20 < byte < 0x7F else None
