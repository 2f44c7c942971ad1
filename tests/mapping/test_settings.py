from dataclasses import dataclass
from typing import Any, Literal

import pytest

from mapping.errors import TestbedError
from mapping.mappers import CONFIGS, MAPPERS
from mapping.settings import parse_settings


@dataclass(frozen=True, slots=True, kw_only=True)
class Example:
    share: float = 0.0
    count: int = 0
    careful: bool = True
    gate: float | None = None
    kind: Literal["fine", "coarse"] = "fine"
    pose: tuple[float, float, float] = (0.0, 0.0, 0.0)
    steps: tuple[int, ...] = ()
    name: str = ""
    inner: dict[str, float] | None = None


@pytest.mark.parametrize(
    ("word", "value"),
    [
        ("share=0.5", 0.5),
        ("share=1e-3", 1e-3),
        ("count=-3", -3),
        ("careful=false", False),
        ("careful=True", True),
        ("gate=none", None),
        ("gate=0.2", 0.2),
        ("kind=coarse", "coarse"),
        ("pose=0.1,-2,3", (0.1, -2.0, 3.0)),
        ("steps=1,2,3,4", (1, 2, 3, 4)),
        ("name=a=b", "a=b"),
        ("inner=none", None),
    ],
)
def test_a_word_becomes_what_the_field_holds(word: str, value: Any) -> None:
    settings = parse_settings(Example, [word])
    assert list(settings.values()) == [value]
    assert type(settings[word.split("=")[0]]) is type(value)
    Example(**settings)


def test_the_last_of_two_words_for_a_field_counts() -> None:
    words = ["share=0.5", "count=2", "share=0.7"]
    assert parse_settings(Example, words) == {"share": 0.7, "count": 2}


@pytest.mark.parametrize(
    ("word", "told"),
    [
        ("share", "NAME=VALUE"),
        ("shares=1", "share, count"),
        ("share=half", "share: 'half'; must be a number"),
        ("count=1.5", "a whole number"),
        ("careful=1", "true or false"),
        ("gate=off", "a number or none"),
        ("kind=rough", "fine or coarse"),
        ("pose=1,2", "a number, a number, a number"),
        ("steps=1,x", "a whole number"),
        ("inner=1", "cannot be set"),
    ],
)
def test_a_word_that_does_not_fit_is_told_with_what_does(word: str, told: str) -> None:
    with pytest.raises(TestbedError, match=told):
        parse_settings(Example, [word])


def test_every_mapper_has_settings() -> None:
    assert CONFIGS.keys() == MAPPERS.keys()
    for config in CONFIGS.values():
        assert parse_settings(config, ["max_range=2.5"]) == {"max_range": 2.5}
