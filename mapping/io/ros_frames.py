"""Finds where one frame lies in another from the transforms that a ROS bag holds (REP-105)."""

from collections import deque
from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import ArrayLike, NDArray

Transform = NDArray[np.float64]
"""A homogeneous transform ``(4, 4)``."""


@dataclass(slots=True)
class FrameTree:
    """The transforms between frames; of each pair the first one counts."""

    links: dict[str, dict[str, Transform]] = field(default_factory=dict)
    """Frame -> neighbouring frame -> the neighbour's pose in the frame."""

    def add(self, parent: str, child: str, position: ArrayLike, orientation: ArrayLike) -> None:
        """Add the child's pose in the parent: x, y, z [m] and a quaternion x, y, z, w."""
        parent, child = plain_name(parent), plain_name(child)
        pose = transform(position, orientation)
        if child not in self.links.get(parent, {}) and np.all(np.isfinite(pose)):
            self.links.setdefault(parent, {})[child] = pose
            self.links.setdefault(child, {})[parent] = np.asarray(np.linalg.inv(pose))

    def find(self, frame: str, bases: Sequence[str]) -> Transform | None:
        """The pose of ``frame`` in the first of ``bases`` that it is linked to, None without one.

        A base's name may stand behind a namespace, as in ``robot1/base_link``.
        """
        poses = self._seen_from(plain_name(frame))
        for base in map(plain_name, bases):
            for name in (base, *(name for name in poses if name.endswith(f"/{base}"))):
                if name in poses:
                    return np.asarray(np.linalg.inv(poses[name]))
        return None

    def _seen_from(self, frame: str) -> dict[str, Transform]:
        """The poses of all linked frames in ``frame``, the nearest first."""
        poses = {frame: np.eye(4)}
        waiting = deque([frame])
        while waiting:
            here = waiting.popleft()
            for other, pose in self.links.get(here, {}).items():
                if other not in poses:
                    poses[other] = poses[here] @ pose
                    waiting.append(other)
        return poses


def plain_name(frame: str) -> str:
    """A frame's name without the slash in front that ROS 1 had."""
    return frame.lstrip("/")


def transform(position: ArrayLike, orientation: ArrayLike) -> Transform:
    """The transform of a position ``(3,)`` and a quaternion ``(4,)`` x, y, z, w.

    A quaternion of zeros, which fresh messages have, means no rotation.
    """
    x, y, z, w = np.asarray(orientation, dtype=np.float64)
    matrix = np.eye(4)
    matrix[:3, 3] = position
    with np.errstate(invalid="ignore", over="ignore"):
        norm = x * x + y * y + z * z + w * w
        scale = 2.0 / norm if norm > 0.0 else 0.0
        matrix[:3, :3] -= scale * np.array(
            [
                [y * y + z * z, z * w - x * y, -x * z - y * w],
                [-x * y - z * w, x * x + z * z, x * w - y * z],
                [y * w - x * z, -x * w - y * z, x * x + y * y],
            ]
        )
    return matrix


def yaw_of(matrix: Transform) -> float:
    """The heading [rad] of a transform's x axis in the plane."""
    return float(np.arctan2(matrix[1, 0], matrix[0, 0]))
