"""Tells states of the project's own sources apart by a digest, committed or not."""

import hashlib
import re
from collections.abc import Iterable
from functools import cache
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]

PACKAGES = ("mapping", "nav", "envs", "evaluation")
"""Where everything lies that a run executes."""

_RAW_KINDS = (".py", ".xml", ".yaml")

_IMPORT = re.compile(
    rf"^[ \t]*(?:from|import)[ \t]+((?:{'|'.join(PACKAGES)})[\w.]*)"
    r"(?:[ \t]+import[ \t]+(?:\(([^)]*)\)|([^\n#]*)))?",
    re.MULTILINE,
)


@cache
def digest_of_sources() -> str:
    """SHA-256, 16 digits of it, of all that decides what a run does: code, robot, worlds.

    Of the state when it is first asked for in a process, which is about what the process runs.
    """
    folders = [ROOT / name for name in (*PACKAGES, "assets")]
    files = [file for folder in folders for file in folder.rglob("*") if file.suffix in _RAW_KINDS]
    return _digest_of(files)[:16]


def digest_with_imports(files: Iterable[Path]) -> str:
    """SHA-256 of source files and of every project file that they import, directly or not."""
    waiting, met = list(files), set[Path]()
    while waiting:
        file = waiting.pop()
        if file not in met:
            met.add(file)
            waiting += imports_of(file)
    return _digest_of(met)


def imports_of(file: Path) -> list[Path]:
    """The project's files that a source file imports, those of a package's modules among them."""
    found = []
    for dotted, in_brackets, in_line in _IMPORT.findall(file.read_text(encoding="utf-8")):
        module = ROOT.joinpath(*dotted.split("."))
        names = re.findall(r"\w+", in_brackets or in_line)
        candidates = (
            module.with_suffix(".py"),
            module / "__init__.py",
            *(module / f"{each}.py" for each in names),
        )
        found += [candidate for candidate in candidates if candidate.is_file()]
    return found


def _digest_of(files: Iterable[Path]) -> str:
    digest = hashlib.sha256()
    for file in sorted(files):
        digest.update(f"{file.relative_to(ROOT)}\n".encode() + file.read_bytes())
    return digest.hexdigest()
