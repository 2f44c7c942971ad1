"""Turns a set of guesses of the state, a control and a measurement into the next set.

The particle filter (Probabilistic Robotics, table 4.3; thesis, table 3.5) with an adaptive number
of particles (KLD sampling, table 8.4; Fox 2003) and recovery by random particles (augmented MCL,
table 8.3).
"""

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.special import logsumexp

from mapping.errors import TestbedError
from mapping.filters.resampling import (
    effective_number,
    importance_sample,
    kld_sample_size,
    low_variance_sample,
    normalised,
)

Array = NDArray[np.float64]

MotionSampler = Callable[[Array, np.random.Generator], Array]
"""States ``(n, d)`` into as many samples of where each may be after the control ``(n, d)``."""


@dataclass(frozen=True, slots=True, kw_only=True)
class ParticleConfig:
    """How many particles there are and when they are drawn anew."""

    bins: tuple[float, ...] | None = None
    """Edges of a bin of the state space for KLD sampling, one a state; None keeps the number."""
    least: int = 100
    """Fewest particles of KLD sampling."""
    most: int = 10_000
    """Most particles of it."""
    error: float = 0.05
    """Kullback-Leibler divergence that the number keeps below [nats] (Fox 2003)."""
    confidence: float = 0.99
    """With this probability (Fox 2003)."""
    resampling: Literal["low_variance", "importance"] = "low_variance"
    """How survivors are drawn."""
    resample_below: float = 1.0
    """They are drawn when the effective number falls below this share of all; 1 is always."""
    slow_rate: float = 0.0
    """Rate of the long-term average of the measurements' likelihood, per measurement; with 0 no
    share of the belief is ever due to strangers."""
    fast_rate: float = 0.1
    """Rate of the short-term average; must be the larger one."""

    def __post_init__(self) -> None:
        """Refuse figures that make no filter."""
        if not 1 <= self.least <= self.most:
            raise TestbedError(f"particles least, most: {self.least}, {self.most}; must ascend")
        if self.bins is not None and not all(edge > 0.0 for edge in self.bins):
            raise TestbedError(f"particles bins: {self.bins}; must be above 0")
        if not 0.0 <= self.slow_rate < self.fast_rate <= 1.0:
            raise TestbedError(
                f"particles slow_rate, fast_rate: {self.slow_rate}, {self.fast_rate}; "
                "must ascend from 0 to 1"
            )
        if not (self.error > 0.0 and 0.0 < self.confidence < 1.0):
            raise TestbedError("particles error, confidence: must be above 0, confidence below 1")


class ParticleFilter:
    """The particles and the two averages that tell when they have lost the state."""

    def __init__(self, config: ParticleConfig, states: ArrayLike, rng: np.random.Generator) -> None:
        """Begin with particles ``(n, d)`` of equal weight."""
        self.config = config
        self.states: Array = np.array(states, dtype=np.float64)
        self.weights: Array = np.full(len(self.states), 1.0 / len(self.states))
        self._rng = rng
        self._slow = self._fast = 0.0

    def __len__(self) -> int:
        return len(self.states)

    @property
    def random_share(self) -> float:
        """Share of the belief that is due to strangers: 1 - w_fast / w_slow, 0 at least."""
        if self.config.slow_rate == 0.0 or self._slow == 0.0:
            return 0.0
        return max(0.0, 1.0 - self._fast / self._slow)

    @property
    def effective_number(self) -> float:
        """How many particles carry the weight."""
        return effective_number(self.weights)

    @property
    def usual_evidence(self) -> float:
        """The long-term average of the evidence, w_slow."""
        return self._slow

    def expect(self, evidence: float) -> None:
        """Begin both averages of the evidence with a figure, as from before; they begin with 0."""
        self._slow = self._fast = evidence

    def predict(self, motion: MotionSampler) -> None:
        """Move every particle by a sample of the motion model: line 4."""
        self.states = motion(self.states, self._rng)

    def admit(self, strangers: ArrayLike, share: float) -> None:
        """Give a share of the belief to random particles ``(k, d)``, equally, before a correction.

        With as many strangers as that share of all, this is augmented MCL (table 8.3). It is the
        prediction of a state that is carried off with that probability, so any number of strangers
        is right; more find a small peak sooner.
        """
        strangers = np.asarray(strangers, dtype=np.float64)
        if share <= 0.0 or len(strangers) == 0:
            return
        self.states = np.concatenate((self.states, strangers))
        each = np.full(len(strangers), share / len(strangers))
        self.weights = np.concatenate(((1.0 - share) * self.weights, each))

    def correct(self, log_likelihoods: ArrayLike, evidence: float | None = None) -> float:
        """Weigh the particles by log p(z_t | x_t) of each ``(n,)``: line 5.

        A measurement that is impossible for every particle changes no weight.

        Args:
            log_likelihoods: Of each particle.
            evidence: How well the belief explains the measurement, what w_slow and w_fast average;
                by default p(z_t), the particles' mean likelihood.

        Returns:
            log p(z_t): how well the belief before expected the measurement.

        Raises:
            TestbedError: A likelihood is NaN or infinite, or the evidence is; nothing is changed.
        """
        logs = np.asarray(log_likelihoods, dtype=np.float64)
        if not np.all(logs < math.inf):
            raise TestbedError("log_likelihoods: NaN or +inf among them; must be below +inf")
        if evidence is not None and not math.isfinite(evidence):
            raise TestbedError(f"evidence: {evidence}; must be finite")
        with np.errstate(divide="ignore"):
            weighed = np.log(self.weights) + logs
        expected = float(logsumexp(weighed))
        if evidence is None:
            evidence = math.exp(expected)
        self._slow += self.config.slow_rate * (evidence - self._slow)
        self._fast += self.config.fast_rate * (evidence - self._fast)
        if math.isfinite(expected):
            self.weights = normalised(weighed)
        return expected

    def resample(self) -> bool:
        """Draw the next particles if too few carry the weight: lines 8 to 11.

        Returns:
            Whether they were drawn.
        """
        if self.effective_number > self.config.resample_below * len(self):
            return False
        count = self._number(self.states[self._survivors(len(self))])
        self.states = self.states[self._survivors(count)]
        self.weights = np.full(count, 1.0 / count)
        return True

    def _survivors(self, count: int) -> NDArray[np.intp]:
        if self.config.resampling == "importance":
            return importance_sample(self.weights, count, self._rng)
        return low_variance_sample(self.weights, count, self._rng.random())

    def _number(self, drawn: Array) -> int:
        """How many particles there should be, by the bins that a draw of the next ones covers."""
        config = self.config
        if config.bins is None:
            return len(self)
        bins = count_bins(drawn, config.bins)
        wanted = kld_sample_size(bins, config.error, config.confidence)
        return min(max(wanted, config.least), config.most)


def count_bins(states: Array, edges: ArrayLike) -> int:
    """How many bins with edges ``(d,)`` the states ``(n, d)`` lie in."""
    cells = np.floor(states / np.asarray(edges, dtype=np.float64)).astype(np.int64)
    cells -= cells.min(axis=0)
    keys = np.ravel_multi_index(tuple(cells.T), tuple(cells.max(axis=0) + 1))
    return len(np.unique(keys))
