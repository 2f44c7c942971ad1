"""Keeps the paths of many particles as one tree, in which descendants share their past."""

import numpy as np
from numba import njit
from numpy.typing import NDArray

from mapping.geometry import Pose

FIRST_NODES = 4096
"""Nodes held at the start; the store grows when its living nodes fill half of it."""

NONE = -1
"""The parent of a root."""


class ParticlePaths:
    """The poses of all particles after each step.

    Poses that no living particle has in its past are forgotten when the store is full. As the
    pasts soon meet in one, it holds little more than one pose a step, however many the particles.
    """

    def __init__(self, poses: Pose) -> None:
        """Start with poses ``(particles, 3)``: step 0."""
        self._poses = np.empty((FIRST_NODES, 3))
        self._parents = np.empty(FIRST_NODES, dtype=np.int32)
        self._count = 0
        self._leaves = np.full(len(poses), NONE, dtype=np.int32)
        self.steps = 0
        self.extend(poses)

    @property
    def nodes(self) -> int:
        """How many poses are held."""
        return self._count

    @property
    def newest(self) -> Pose:
        """The newest pose of every particle ``(particles, 3)``."""
        return self._poses[self._leaves]

    def extend(self, poses: Pose) -> None:
        """Add the next pose of every particle ``(particles, 3)``."""
        added = len(poses)
        if self._count + added > len(self._parents):
            self._forget_the_dead(added)
        new = slice(self._count, self._count + added)
        self._poses[new], self._parents[new] = poses, self._leaves
        self._leaves = np.arange(new.start, new.stop, dtype=np.int32)
        self._count += added
        self.steps += 1

    def resample(self, parents: NDArray[np.intp]) -> None:
        """Give every particle the path of its parent ``(particles,)``."""
        self._leaves = self._leaves[parents]

    def path(self, particle: int) -> Pose:
        """The poses of a particle after each step ``(steps, 3)``."""
        poses: Pose = self._poses[_lineage(self._parents, self._leaves[particle], self.steps)]
        return poses

    def _forget_the_dead(self, room: int) -> None:
        """Keep what a leaf descends from, in the same order, and make room for so many more."""
        alive = _alive(self._parents, self._leaves, self._count)
        kept = np.flatnonzero(alive)
        place = np.cumsum(alive, dtype=np.int32) - 1
        size = len(self._parents)
        while len(kept) + room > size // 2:
            size *= 2
        poses, parents = np.empty((size, 3)), np.empty(size, dtype=np.int32)
        poses[: len(kept)] = self._poses[kept]
        old = self._parents[kept]
        parents[: len(kept)] = np.where(old == NONE, NONE, place[old])
        self._poses, self._parents = poses, parents
        self._leaves, self._count = place[self._leaves], len(kept)


@njit(cache=True)
def _lineage(parents: NDArray[np.int32], leaf: int, steps: int) -> NDArray[np.int32]:
    """The nodes from a root to a leaf ``(steps,)``."""
    nodes = np.empty(steps, dtype=np.int32)
    for step in range(steps - 1, -1, -1):
        nodes[step] = leaf
        leaf = parents[leaf]
    return nodes


@njit(cache=True)
def _alive(parents: NDArray[np.int32], leaves: NDArray[np.int32], count: int) -> NDArray[np.bool_]:
    """Which nodes a leaf descends from ``(count,)``."""
    alive = np.zeros(count, dtype=np.bool_)
    for leaf in leaves:
        node = leaf
        while node != NONE and not alive[node]:
            alive[node] = True
            node = parents[node]
    return alive
