"""Remembers which kernels a kind of run needs, and tells whether all are compiled, ready on disk.

What a run needs shows when it is over: the kernels that were called. They are noted beside numba's
compiled code, so that a note is gone when that is.
"""

import json
import sys
from pathlib import Path

from numba import config
from numba.core.dispatcher import Dispatcher

from evaluation.source_digest import PACKAGES, ROOT, digest_with_imports
from mapping.deskew_kernels import interpolate
from mapping.io.atomic import write_atomically


def is_compiled(kind: str) -> bool:
    """Whether a kind of run was noted, and its kernels were compiled since their files changed.

    True as well when numba's compiler is switched off: there is nothing to compile.
    """
    note = _note_of(kind)
    if note is None:
        return True
    try:
        files = json.loads(note.read_text(encoding="utf-8"))
        return all(_is_compiled(Path(source), Path(folder)) for source, folder in files.items())
    except (OSError, ValueError):
        return False


def forget_stale_kernels() -> None:
    """Take away all compiled code if any kernel's source has changed since it was compiled.

    Numba compares a kernel with its own file only: one that calls kernels of other files, or has
    constants of theirs, would go on with what those were.
    """
    note = _note_of("fingerprint")
    if note is None:
        return
    fingerprint = _fingerprint()
    try:
        if note.read_text(encoding="utf-8") == fingerprint:
            return
    except (OSError, ValueError):
        pass  # there is none yet
    folders = [Path(config.CACHE_DIR)] if config.CACHE_DIR else [ROOT / name for name in PACKAGES]
    for folder in folders:
        for compiled in folder.rglob("*.nb[ic]"):
            compiled.unlink(missing_ok=True)
    note.parent.mkdir(parents=True, exist_ok=True)
    write_atomically(note, lambda file: file.write(fingerprint.encode()))


def note_kernels(kind: str) -> None:
    """Note the kernels that were called in this process as those that a kind of run needs."""
    note = _note_of(kind)
    if note is not None:
        text = json.dumps(called_kernels(), indent=0)
        write_atomically(note, lambda file: file.write(text.encode()))


def called_kernels() -> dict[str, str]:
    """Source files of kernels called in this process, each with the folder of its compiled code."""
    modules = [module for name, module in sys.modules.items() if name.split(".")[0] in PACKAGES]
    kernels = [
        kernel
        for module in modules
        for kernel in vars(module).values()
        if isinstance(kernel, Dispatcher) and kernel.signatures
    ]
    return {each.py_func.__code__.co_filename: str(each.stats.cache_path) for each in kernels}


def _fingerprint() -> str:
    """A digest of every source file that holds a kernel, and of those whose constants it has."""
    sources = (source for name in PACKAGES for source in (ROOT / name).rglob("*.py"))
    return digest_with_imports(source for source in sources if b"njit" in source.read_bytes())


def _note_of(kind: str) -> Path | None:
    """The file of a note, where numba keeps the code of a kernel that every run calls."""
    if not isinstance(interpolate, Dispatcher):
        return None
    return Path(str(interpolate.stats.cache_path)) / f"kernels-of-{kind}.json"


def _is_compiled(source: Path, folder: Path) -> bool:
    changed = source.stat().st_mtime
    return any(index.stat().st_mtime >= changed for index in folder.glob(f"{source.stem}.*.nbi"))
