"""Turns a belief over the cells of a continuous space, a control and a measurement into the next.

The histogram filter (Probabilistic Robotics, table 4.1 and eq. 4.4 to 4.8; thesis 3.4.2) on a fixed
decomposition: equal boxes, each with the probability of the whole box. ``histogram_tree`` is its
adaptive form.
"""

from collections.abc import Callable

import numpy as np
from numpy.typing import ArrayLike, NDArray

from mapping.errors import TestbedError
from mapping.filters import bayes

Array = NDArray[np.float64]

TransitionDensity = Callable[[Array, Array], Array]
"""p(x_t = ``(n, d)`` | u_t, x_t-1 = ``(d,)``), a density ``(n,)``."""

Likelihood = Callable[[Array], Array]
"""p(z_t | x_t) at states ``(n, d)``: ``(n,)``."""


class HistogramFilter:
    """A belief on a regular grid of boxes; starts uniform.

    Args:
        lower: Lower corner of the space ``(d,)``.
        upper: Its upper corner ``(d,)``.
        shape: Boxes along each axis.

    Raises:
        TestbedError: The corners or the shape make no grid.
    """

    def __init__(self, lower: ArrayLike, upper: ArrayLike, shape: tuple[int, ...]) -> None:
        self.lower = np.asarray(lower, dtype=np.float64)
        self.upper = np.asarray(upper, dtype=np.float64)
        if self.lower.shape != (len(shape),) or not np.all(self.upper > self.lower):
            raise TestbedError(
                f"histogram corners: {self.lower}, {self.upper}; must ascend, one an axis"
            )
        if min(shape, default=0) < 1:
            raise TestbedError(f"histogram shape: {shape}; must be at least 1 along every axis")
        self.shape = shape
        self.edges = (self.upper - self.lower) / np.array(shape)
        axes = [
            low + edge * (np.arange(count) + 0.5)
            for low, edge, count in zip(self.lower, self.edges, shape, strict=True)
        ]
        self.centers: Array = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(
            -1, len(shape)
        )
        self.belief: Array = np.full(len(self.centers), 1.0 / len(self.centers))

    @property
    def mean(self) -> Array:
        """Mean of the belief ``(d,)``; no good for angles."""
        return np.asarray(self.belief @ self.centers)

    @property
    def covariance(self) -> Array:
        """Covariance of the belief ``(d, d)``, the width of the boxes included."""
        apart = self.centers - self.mean
        spread = (self.belief[:, None] * apart).T @ apart
        return np.asarray(spread + np.diag(self.edges**2 / 12.0))

    def predict(self, transition: TransitionDensity) -> None:
        """Move the belief; each box's probability goes where its middle may go.

        What would leave the space is spread over what stays in.

        Raises:
            TestbedError: All of it would leave; nothing is changed.
        """
        prior = np.zeros_like(self.belief)
        for center, probability in zip(self.centers, self.belief, strict=True):
            if probability > 0.0:
                density = transition(self.centers, center)
                total = float(density.sum())
                if total > 0.0:
                    prior += probability / total * density
        total = float(prior.sum())
        if not total > 0.0:
            raise TestbedError(f"transition: keeps {total} of the belief; some must stay in space")
        self.belief = prior / total

    def correct(self, likelihood: Likelihood) -> None:
        """Weigh every box by the likelihood at its middle.

        Raises:
            TestbedError: The measurement is impossible everywhere.
        """
        self.belief = bayes.correct(self.belief, likelihood(self.centers))
