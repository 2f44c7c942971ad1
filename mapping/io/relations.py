"""Reads files of relative poses, ``t1 t2 dx dy dz roll pitch yaw`` a line, by Kümmerle et al. 2009.

In the plane dz, roll and pitch are 0; they are dropped.
"""

from pathlib import Path

import numpy as np

from mapping.errors import TestbedError
from mapping.relations import Relations

COLUMNS = 8


def read_relations(path: str | Path) -> Relations:
    """Read the relations of a log. Lines of ``#`` are comments.

    Raises:
        TestbedError: The file is missing or holds no relation, or a line has not eight numbers.
    """
    rows = [
        _numbers(f"{path}: line {number}", line)
        for number, line in enumerate(_lines(Path(path)), start=1)
        if line.strip() and not line.lstrip().startswith("#")
    ]
    if not rows:
        raise TestbedError(f"{path}: there is no relation; must have at least one")
    table = np.array(rows, dtype=np.float64)
    return Relations(stamps=table[:, :2].copy(), poses=table[:, [2, 3, 7]])


def _lines(path: Path) -> list[str]:
    try:
        return path.read_text(encoding="utf-8").splitlines()
    except (OSError, UnicodeDecodeError) as error:
        raise TestbedError(f"{path}: cannot be read ({error}); must be a relations file") from error


def _numbers(where: str, line: str) -> list[float]:
    """The eight finite numbers of a line."""
    words = line.split()
    try:
        numbers = [float(word) for word in words]
    except ValueError:
        numbers = []
    if len(numbers) != COLUMNS or not np.all(np.isfinite(numbers)):
        raise TestbedError(
            f"{where}: {line.strip()[:80]!r}; must be eight finite numbers: "
            "t1 t2 dx dy dz roll pitch yaw"
        )
    return numbers
