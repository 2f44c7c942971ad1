"""An error in the middle of a run, and what it leaves of it."""

import traceback
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, TypeVar, cast

from mapping.io.atomic import write_atomically

if TYPE_CHECKING:  # a replay needs no simulator, which an episode imports
    from evaluation.episode import Episode
    from evaluation.replay import Replay

FAILURE_FILE = "failure.txt"
"""File of a run folder that tells why it has no result, or one that an error ended: a line, then
the traceback if any."""


Run = TypeVar("Run", "Episode", "Replay")


class RunError(Exception):
    """An error, its cause, ended a run in the middle: in a mapper or navigator of one's own, say.

    Attributes:
        left: The run up to there, its ``stop_reason`` ``"error"``; its map may be written and
            scored like any other.
    """

    def __init__(self, left: "Episode | Replay") -> None:
        super().__init__("an error ended the run in the middle; its cause is told above")
        self.left = left


def what_is_left(run: Callable[[], Run]) -> tuple[Run, str]:
    """What a run left, and why an error ended it: one line, then the traceback; empty if none."""
    try:
        return run(), ""
    except RunError as error:
        return cast(Run, error.left), f"{reason_of(error)}\n\n{details_of(error)}"


def details_of(error: BaseException) -> str:
    """The traceback of an error; that of a ``RunError`` is its cause's."""
    cause = error.__cause__ if isinstance(error, RunError) else error
    return "".join(traceback.format_exception(cause))


def reason_of(error: BaseException) -> str:
    """An error in one line; that of a ``RunError`` is its cause's."""
    cause = error.__cause__ if isinstance(error, RunError) else error
    return f"{type(cause).__name__}: {next(iter(str(cause).splitlines()), '')}"


def write_failure(folder: Path, text: str) -> None:
    """Write why there is no result, or a partial one, beside what the run left."""
    write_atomically(folder / FAILURE_FILE, lambda file: file.write(text.encode()))
