"""Tells of a run that an error ended, in its folder and to the user."""

import sys
from pathlib import Path

from evaluation.failure import write_failure


def tell_failure(folder: Path, failure: str) -> None:
    """Write and print why a run ended early, for who looks for the defect; nothing if it is empty.

    Args:
        folder: The run folder, everything else written.
        failure: Of ``evaluation.failure.what_is_left``.
    """
    if failure:
        write_failure(folder, failure)
        print(failure.partition("\n\n")[2], end="", file=sys.stderr)
