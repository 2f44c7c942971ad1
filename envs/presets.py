"""Turns the name of a sensor's settings into the settings."""

from collections.abc import Mapping
from typing import TypeVar

from mapping.errors import TestbedError

Config = TypeVar("Config")


def preset(field: str, choice: str | Config, presets: Mapping[str, Config]) -> Config:
    """The configuration that a name stands for; a configuration stands for itself.

    Raises:
        TestbedError: There is no preset of that name.
    """
    if not isinstance(choice, str):
        return choice
    if choice not in presets:
        raise TestbedError(f"{field}: {choice!r}; must be one of {', '.join(presets)}")
    return presets[choice]
