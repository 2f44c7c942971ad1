"""Turns a YAML file into its values and the line of each, so that a complaint can name the line."""

import difflib
import reprlib
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NoReturn

import yaml

from envs.yaml_file import load_yaml
from mapping.errors import TestbedError

Place = tuple[str | int, ...]
"""Keys and list indices that lead to a value, such as ``("criteria", "coverage", "min")``."""

DEEPEST = 4
"""Lines are kept of so many levels: an alias may hold itself, and then there is no last one."""


class LineError(TestbedError):
    """Bad input in a file, told with its line."""


@dataclass(frozen=True, slots=True, kw_only=True)
class YamlLines:
    """A YAML mapping and where in its file each value stands."""

    path: Path
    values: dict[str, Any]
    lines: Mapping[Place, int]
    """Line of each key, and of each entry of a list, counted from 1."""

    def refuse(self, place: Place, allowed: str) -> NoReturn:
        """Raise the error of a wrong value: file, line, field, value, what is allowed."""
        value: Any = self.values
        for key in place:
            value = value[key]
        self.complain(place, f"{_told(place)}: {reprlib.repr(value)}; must be {allowed}")

    def complain(self, place: Place, message: str) -> NoReturn:
        """Raise a message of one's own about a place, or about the nearest one round it."""
        while place and place not in self.lines:
            place = place[:-1]
        raise LineError(f"{self.path}: line {self.lines[place]}: {message}")

    def relay(self, error: TestbedError) -> NoReturn:
        """Raise an error whose message begins with a field, ``field: ...``, with that one's line.

        An error that has its line already is passed on as it is.
        """
        if isinstance(error, LineError):
            raise error
        place: Place = ()
        for word in str(error).split(": "):
            if (*place, word) not in self.lines:
                break
            place = (*place, word)
        self.complain(place, str(error))

    def check_keys(self, place: Place, allowed: Iterable[str], needed: Iterable[str] = ()) -> None:
        """Refuse a mapping at a place that has a key too many or too few."""
        value: Any = self.values
        for key in place:
            value = value[key]
        allowed = tuple(allowed)
        if not isinstance(value, dict):
            self.refuse(place, f"keys and values: {', '.join(allowed)}")
        for key in value:
            if key not in allowed:
                self.complain(
                    (*place, key),
                    f"{_told((*place, key))}: unknown key; {nearest(key, allowed)}"
                    f"must be one of {', '.join(allowed)}",
                )
        for key in needed:
            if key not in value:
                self.complain(place, f"{_told((*place, key))}: missing; must stand")


def read_yaml_lines(path: Path, *, kind: str) -> YamlLines:
    """Read a YAML file that holds a mapping.

    Args:
        path: The file.
        kind: What it ought to be, for the errors, such as ``a scenario in YAML``.

    Raises:
        TestbedError: The file is missing, unreadable, no YAML, no mapping, or says a key twice.
    """
    if not path.is_file():
        raise TestbedError(f"{path}: no such file; must be {kind}")
    try:
        root = yaml.compose(path.read_text(encoding="utf-8"), Loader=yaml.SafeLoader)
    except (yaml.YAMLError, OSError, ValueError, RecursionError):
        return YamlLines(path=path, values=load_yaml(path), lines={(): 1})  # which tells why not
    if not isinstance(root, yaml.MappingNode):
        raise LineError(f"{path}: line 1: no keys and values; must be {kind}")
    return YamlLines(path=path, values=load_yaml(path), lines=_lines(root, ()))


def nearest(word: object, known: Iterable[str]) -> str:
    """``did you mean ...? `` when a known word is like this one, else nothing."""
    close = difflib.get_close_matches(str(word), tuple(known), n=1)
    return f"did you mean {close[0]}? " if close else ""


def _lines(node: yaml.Node, place: Place) -> dict[Place, int]:
    """The line of a node's place and of every place in it."""
    lines = {place: node.start_mark.line + 1}
    if len(place) == DEEPEST:
        return lines
    if isinstance(node, yaml.MappingNode):
        for key, value in node.value:
            if isinstance(key, yaml.ScalarNode):
                lines |= _lines(value, (*place, key.value))
                lines[(*place, key.value)] = key.start_mark.line + 1
    elif isinstance(node, yaml.SequenceNode):
        for i, value in enumerate(node.value):
            lines |= _lines(value, (*place, i))
    return lines


def _told(place: Place) -> str:
    """A place in words: ``criteria: coverage: min`` or ``seeds[2]``."""
    words = ""
    for key in place:
        words += f"[{key}]" if isinstance(key, int) else f": {key}"
    return words.removeprefix(": ")
