"""Turns a belief over boxes of many sizes into the next: small boxes where the belief is.

The histogram filter with an adaptive decomposition, a density tree (Probabilistic Robotics 4.1.4;
thesis 3.4.2, fig. 3.2): a box with much probability is cut in half along its longest side, again
and again; halves that together have little become one box again.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from mapping.errors import TestbedError
from mapping.filters.histogram import Likelihood, TransitionDensity

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True, kw_only=True)
class TreeConfig:
    """How fine the boxes may be and when they are cut and joined."""

    smallest: tuple[float, ...]
    """No side is cut to less than this, one an axis."""
    split_above: float = 0.02
    """A box with more probability than this is cut."""
    merge_below: float = 0.005
    """Two halves that together have less become one."""

    def __post_init__(self) -> None:
        """Refuse figures that make no tree."""
        if not all(side > 0.0 for side in self.smallest):
            raise TestbedError(f"tree smallest: {self.smallest}; must be above 0")
        if not 0.0 <= self.merge_below < self.split_above:
            raise TestbedError(
                f"tree merge_below, split_above: {self.merge_below}, {self.split_above}; "
                "must ascend, else boxes are cut and joined for ever"
            )


class TreeHistogram:
    """The leaves of the tree: boxes ``lower``, ``upper`` ``(n, d)`` with ``belief`` ``(n,)``.

    Args:
        lower: Lower corner of the space ``(d,)``.
        upper: Its upper corner ``(d,)``.
        config: How to cut; the whole space is one box at first and is cut as far as a uniform
            belief asks for.
    """

    def __init__(self, lower: ArrayLike, upper: ArrayLike, config: TreeConfig) -> None:
        self.config = config
        self.lower: Array = np.array(lower, dtype=np.float64)[None, :]
        self.upper: Array = np.array(upper, dtype=np.float64)[None, :]
        if self.lower.shape[1] != len(config.smallest) or not np.all(self.upper > self.lower):
            raise TestbedError(
                f"tree corners: {self.lower[0]}, {self.upper[0]}; must ascend, one an axis"
            )
        self.belief: Array = np.ones(1)
        self._path: list[str] = [""]
        self._smallest = np.array(config.smallest)
        self.refine()

    def __len__(self) -> int:
        return len(self.belief)

    @property
    def centers(self) -> Array:
        """Middles of the boxes ``(n, d)``."""
        return 0.5 * (self.lower + self.upper)

    @property
    def volumes(self) -> Array:
        """Volumes of the boxes ``(n,)``."""
        return np.asarray(np.prod(self.upper - self.lower, axis=1))

    @property
    def mean(self) -> Array:
        """Mean of the belief ``(d,)``; no good for angles."""
        return np.asarray(self.belief @ self.centers)

    @property
    def covariance(self) -> Array:
        """Covariance of the belief ``(d, d)``, the width of the boxes included."""
        apart = self.centers - self.mean
        within = self.belief @ (self.upper - self.lower) ** 2 / 12.0
        return np.asarray((self.belief[:, None] * apart).T @ apart + np.diag(within))

    def predict(self, transition: TransitionDensity) -> None:
        """Move the belief from box to box, then cut and join."""
        centers, volumes = self.centers, self.volumes
        prior = np.zeros_like(self.belief)
        for center, probability in zip(centers, self.belief, strict=True):
            share = transition(centers, center) * volumes
            total = float(share.sum())
            if total > 0.0:
                prior += probability / total * share
        self.belief = prior / prior.sum()
        self.refine()

    def correct(self, likelihood: Likelihood) -> None:
        """Weigh every box by the likelihood at its middle, then cut and join.

        Boxes that the measurement makes likely are cut before it counts, so that a peak narrower
        than a box is found as long as the box's middle feels it.

        Raises:
            TestbedError: The measurement is impossible everywhere.
        """
        before = -1
        while before != len(self):
            before = len(self)
            joint = self.belief * likelihood(self.centers)
            evidence = float(joint.sum())
            if not (np.isfinite(evidence) and evidence > 0.0):
                raise TestbedError(f"likelihood: evidence {evidence}; must be above 0")
            self._split(joint / evidence > self.config.split_above)
        self.belief = joint / evidence
        self._merge()

    def refine(self) -> None:
        """Cut every box that has too much probability, join what has little."""
        before = -1
        while before != len(self):
            before = len(self)
            self._split(self.belief > self.config.split_above)
        self._merge()

    def _split(self, heavy: NDArray[np.bool_]) -> None:
        """Cut boxes in half along the side that is longest in smallest sides."""
        sides = (self.upper - self.lower) / self._smallest
        axis = np.argmax(sides, axis=1)
        cut = np.flatnonzero(heavy & (sides[np.arange(len(self)), axis] >= 2.0))
        if len(cut) == 0:
            return
        axis = axis[cut]
        middle = self.centers[cut, axis]
        left_upper, right_lower = self.upper[cut].copy(), self.lower[cut].copy()
        left_upper[np.arange(len(cut)), axis] = middle
        right_lower[np.arange(len(cut)), axis] = middle
        kept = np.ones(len(self), dtype=np.bool_)
        kept[cut] = False
        half = 0.5 * self.belief[cut]
        paths = [self._path[i] for i in cut]
        self._path = [path for path, keep in zip(self._path, kept, strict=True) if keep]
        self._path += [path + "0" for path in paths] + [path + "1" for path in paths]
        self.lower = np.concatenate((self.lower[kept], self.lower[cut], right_lower))
        self.upper = np.concatenate((self.upper[kept], left_upper, self.upper[cut]))
        self.belief = np.concatenate((self.belief[kept], half, half))

    def _merge(self) -> None:
        """Join halves of one box that have little probability together."""
        place = {path: i for i, path in enumerate(self._path)}
        gone = []
        for path, left in place.items():
            right = place.get(path[:-1] + "1") if path.endswith("0") else None
            if right is None or self.belief[left] + self.belief[right] >= self.config.merge_below:
                continue
            self.upper[left] = self.upper[right]
            self.belief[left] += self.belief[right]
            self._path[left] = path[:-1]
            gone.append(right)
        kept = np.setdiff1d(np.arange(len(self)), gone)
        self.lower, self.upper = self.lower[kept], self.upper[kept]
        self.belief = self.belief[kept]
        self._path = [self._path[i] for i in kept]
