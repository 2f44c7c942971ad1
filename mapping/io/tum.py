"""Turns trajectories into TUM files, ``stamp x y z qx qy qz qw`` a line, and back.

evo and most SLAM benchmarks read them. Stamps have nine decimals: four, as some tools write, would
move a robot's pose at 30 Hz to its neighbour's.
"""

from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike

from mapping.errors import TestbedError
from mapping.io.atomic import write_atomically
from mapping.trajectory import Trajectory

COLUMNS = 8
_FORMAT = "%.9f"


def write_tum(path: str | Path, stamps: ArrayLike, poses: ArrayLike) -> None:
    """Write poses ``(n, 3)`` at stamps ``(n,)``; in the plane z, qx and qy are 0.

    Raises:
        TestbedError: The file cannot be written, or a value is not finite.
    """
    stamps = np.asarray(stamps, dtype=np.float64)
    poses = np.asarray(poses, dtype=np.float64).reshape(-1, 3)
    if len(stamps) != len(poses) or not (np.isfinite(stamps).all() and np.isfinite(poses).all()):
        raise TestbedError(
            f"{path}: {len(stamps)} stamps, {len(poses)} poses; must be as many, and all finite"
        )
    rows = np.zeros((len(stamps), COLUMNS))
    rows[:, 0], rows[:, 1:3] = stamps, poses[:, :2]
    rows[:, 6], rows[:, 7] = np.sin(poses[:, 2] / 2.0), np.cos(poses[:, 2] / 2.0)
    write_atomically(path, lambda file: np.savetxt(file, rows, fmt=_FORMAT))


def read_tum(path: str | Path) -> Trajectory:
    """Read a trajectory; heights, roll and pitch are dropped. Lines of ``#`` are comments.

    Raises:
        TestbedError: The file is missing, or a line has not eight numbers, or stamps do not ascend.
    """
    rows = []
    for number, line in enumerate(_lines(Path(path)), start=1):
        if line.strip() and not line.lstrip().startswith("#"):
            rows.append(_numbers(f"{path}: line {number}", line))
    table = np.array(rows, dtype=np.float64).reshape(-1, COLUMNS)
    qx, qy, qz, qw = table[:, 4:].T
    yaw = np.arctan2(2.0 * (qw * qz + qx * qy), 1.0 - 2.0 * (qy**2 + qz**2))
    poses = np.column_stack((table[:, 1:3], yaw))
    try:
        return Trajectory(stamps=table[:, 0].copy(), poses=poses)
    except TestbedError as error:
        raise TestbedError(f"{path}: {error}") from None


def _lines(path: Path) -> list[str]:
    try:
        return path.read_text(encoding="utf-8").splitlines()
    except (OSError, UnicodeDecodeError) as error:
        raise TestbedError(f"{path}: cannot be read ({error}); must be a TUM trajectory") from error


def _numbers(where: str, line: str) -> list[float]:
    """The eight numbers of a line."""
    words = line.replace(",", " ").split()
    try:
        numbers = [float(word) for word in words]
    except ValueError:
        numbers = []
    if len(numbers) != COLUMNS:
        raise TestbedError(f"{where}: {line.strip()!r}; must be eight numbers: t x y z qx qy qz qw")
    return numbers
