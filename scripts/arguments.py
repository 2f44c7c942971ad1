"""Turns command-line words into a config dataclass, or into one clear line about what is wrong."""

import contextlib
import io
import re
import sys
from collections.abc import Callable, Mapping
from typing import TypeVar

import tyro

from mapping.errors import TestbedError

Config = TypeVar("Config")

BOX_DRAWING = re.compile(r"[\u2500-\u257f]+")


def parse(config_type: type[Config], command: str, arguments: list[str]) -> Config:
    """The config that the words spell.

    Args:
        config_type: A dataclass; its fields become options, its docstrings their help.
        command: What the user typed before the options, for the usage line.
        arguments: The words after it.

    Raises:
        TestbedError: If a word is no option, a value does not fit or a required one is missing.
        SystemExit: With status 0 after ``--help``.
    """
    complaint = io.StringIO()
    try:
        with contextlib.redirect_stderr(complaint):
            return tyro.cli(config_type, prog=f"burger {command}", args=arguments)
    except SystemExit as stop:
        if stop.code in (0, None):
            raise
        raise TestbedError(_one_line(complaint.getvalue())) from None


def run_action(
    verb: str, actions: Mapping[str, Callable[[list[str]], int]], arguments: list[str]
) -> int:
    """Run the verb's own verb, the first word; without one, tell which there are.

    Returns:
        The exit status: the action's, 0 for ``--help``, 2 without a word.

    Raises:
        TestbedError: The verb has no such action.
    """
    if not arguments or arguments[0] in ("-h", "--help"):
        print(f"usage: burger {verb} {{{','.join(actions)}}} ...   (each takes --help)")
        return 0 if arguments else 2
    action, *rest = arguments
    if action not in actions:
        raise TestbedError(f"{action!r} is unknown; must be one of {', '.join(actions)}")
    return actions[action](rest)


def _one_line(complaint: str) -> str:
    """What a boxed complaint says before it repeats the help."""
    words = []
    for line in complaint.splitlines()[1:]:
        text = BOX_DRAWING.sub("", line).strip()
        if not text or text.startswith(("Argument helptext", "For full helptext")):
            break
        words.append(text)
    return " ".join(words) or "these options do not fit; see --help"


def is_terminal() -> bool:
    """Whether somebody watches: progress is shown on a terminal only."""
    return sys.stderr.isatty()
