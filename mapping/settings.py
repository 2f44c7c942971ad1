"""Turns words ``NAME=VALUE`` into values of the types that a config's fields have."""

import types
from collections.abc import Sequence
from typing import Any, Literal, Union, get_args, get_origin, get_type_hints

from mapping.errors import TestbedError

_TRUTH = {"true": True, "false": False}


def parse_settings(config: type, words: Sequence[str]) -> dict[str, Any]:
    """The settings that words spell, for a config of the given class.

    Numbers, words, ``true`` and ``false``, ``none`` where a field may be None, and tuples with
    commas are known; a field of any other type cannot be set in this way.

    Raises:
        TestbedError: A word without ``=``, a name that is no field, or a value that does not fit.
    """
    kinds = get_type_hints(config)
    settings = {}
    for word in words:
        name, equals, text = word.partition("=")
        if not equals:
            raise TestbedError(f"setting: {word!r}; must be NAME=VALUE")
        if name not in kinds:
            raise TestbedError(f"setting: {name!r}; must be one of {', '.join(kinds)}")
        try:
            settings[name] = _value(text, kinds[name])
        except ValueError:
            told = _told(kinds[name])
            raise TestbedError(f"setting {name}: {text!r}; must be {told}") from None
    return settings


def _value(text: str, kind: Any) -> Any:
    """The value of a type that a text spells.

    Raises:
        ValueError: It spells none.
    """
    if kind is bool:
        return _one_of(text.lower(), _TRUTH)
    if kind in (int, float, str):
        return kind(text)
    if kind is types.NoneType:
        return _one_of(text.lower(), {"none": None})
    if get_origin(kind) is Literal:
        return _one_of(text, {str(value): value for value in get_args(kind)})
    if get_origin(kind) is tuple:
        return _tuple(text, get_args(kind))
    if get_origin(kind) in (Union, types.UnionType):
        return _first_that_fits(text, get_args(kind))
    raise ValueError(text)


def _one_of(text: str, values: dict[str, Any]) -> Any:
    if text not in values:
        raise ValueError(text)
    return values[text]


def _tuple(text: str, kinds: tuple[Any, ...]) -> tuple[Any, ...]:
    parts = text.split(",")
    if len(kinds) == 2 and kinds[1] is Ellipsis:
        kinds = (kinds[0],) * len(parts)
    if len(parts) != len(kinds):
        raise ValueError(text)
    return tuple(_value(part, kind) for part, kind in zip(parts, kinds, strict=True))


def _first_that_fits(text: str, kinds: tuple[Any, ...]) -> Any:
    for kind in kinds:
        try:
            return _value(text, kind)
        except ValueError:
            continue
    raise ValueError(text)


def _told(kind: Any) -> str:
    """What a type allows, in words."""
    words = {bool: "true or false", int: "a whole number", float: "a number", str: "a word"}
    if kind in words:
        return words[kind]
    if kind is types.NoneType:
        return "none"
    if get_origin(kind) is Literal:
        return " or ".join(str(value) for value in get_args(kind))
    if get_origin(kind) is tuple:
        return ", ".join(_told(part) for part in get_args(kind) if part is not Ellipsis)
    if get_origin(kind) in (Union, types.UnionType):
        return " or ".join(_told(part) for part in get_args(kind))
    return "left as it is: it cannot be set in words"
