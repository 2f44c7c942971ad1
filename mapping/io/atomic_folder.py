"""Writes a folder of files whole or not at all."""

import os
import shutil
import tempfile
from collections.abc import Callable
from pathlib import Path

from mapping.errors import TestbedError


def write_folder_atomically(path: str | Path, write: Callable[[Path], object]) -> None:
    """Let ``write`` make a new folder (or file), then move it to ``path``.

    When ``write`` fails, or the process is interrupted, ``path`` stays as it was and what was
    written is removed. What stood at ``path`` before is removed only when the new one is there.

    Args:
        path: The folder to write; the folder it lies in must exist.
        write: Called once with a path of the same name at which nothing is; must make it.

    Raises:
        TestbedError: The place cannot be written, or the disk is full. Errors that ``write`` raises
            for reasons of its own pass through.
    """
    path = Path(path)
    try:
        workshop = Path(tempfile.mkdtemp(prefix=f".{path.name}.", suffix=".tmp", dir=path.parent))
        try:
            write(workshop / path.name)
            _replace(path, workshop / path.name, workshop / "former")
        finally:
            shutil.rmtree(workshop, ignore_errors=True)
    except OSError as error:
        raise TestbedError(
            f"{path}: cannot be written ({error.strerror or error}); "
            "must lie in an existing folder with write permission"
        ) from error


def _replace(path: Path, new: Path, former: Path) -> None:
    """Move ``new`` to ``path``; a full folder cannot be renamed over, so it steps aside first."""
    if not path.exists():
        os.rename(new, path)
        return
    os.rename(path, former)
    try:
        os.rename(new, path)
    except BaseException:
        os.rename(former, path)
        raise
