"""Writes a file whole or not at all, so that no run leaves half a result behind."""

import os
import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import BinaryIO

from mapping.errors import TestbedError

DEFAULT_MODE = 0o666
"""Permissions of a new file before the process's umask, as ``open`` gives them."""


def write_atomically(path: str | Path, write: Callable[[BinaryIO], object]) -> None:
    """Let ``write`` fill a temporary file beside ``path``, then rename it to ``path``.

    A reader sees the old file or the new one, never a part. When ``write`` fails, or the process
    is interrupted, ``path`` stays as it was and the temporary file is removed.

    Args:
        path: The file to write; its folder must exist.
        write: Called once with the open binary file.

    Raises:
        TestbedError: The folder is missing or cannot be written, or the disk is full. Errors that
            ``write`` raises for reasons of its own pass through.
    """
    path = Path(path)
    try:
        _write_and_rename(path, write)
    except OSError as error:
        raise TestbedError(
            f"{path}: cannot be written ({error.strerror or error}); "
            "must lie in an existing folder with write permission"
        ) from error


def _write_and_rename(path: Path, write: Callable[[BinaryIO], object]) -> None:
    """Write in the folder of ``path``, since a rename is atomic on one file system only."""
    handle, temporary = tempfile.mkstemp(prefix=f".{path.name}.", suffix=".tmp", dir=path.parent)
    try:
        with os.fdopen(handle, "wb") as file:
            write(file)
        os.chmod(temporary, DEFAULT_MODE & ~_umask())
        os.replace(temporary, path)
    except BaseException:
        os.unlink(temporary)
        raise


def _umask() -> int:
    """The process's umask; the system can only tell it by setting it, so it is set back at once."""
    mask = os.umask(0)
    os.umask(mask)
    return mask
