"""Turns the readings of the two sensor experiments into the probabilities of the thesis (4.3.2)."""

import math
from collections import Counter
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.stats import binomtest

from evaluation.calibration.experiment import Readings

RIGHT_VALUES = 3
"""So many of the most frequent values in front of a wall count as right (thesis, appendix A)."""

CONFIDENCE = 0.95

RIGHT, WRONG, FAILED = "right", "wrong", "failed"
"""What a reading counts as."""

DECIMALS = 6
"""Readings are told apart to the micrometre; the lidar's own step is a millimetre."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Estimate:
    """A figure with its 95 % confidence interval; a side that is infinite is None."""

    value: float | None
    low: float | None
    high: float | None


@dataclass(frozen=True, slots=True, kw_only=True)
class ValueCount:
    """How often a value was read, as appendix A has it."""

    experiment: str
    """``wall`` or ``open``."""
    reading: float
    """The value [m]."""
    count: int
    counts_as: str
    """``right``, ``wrong`` or ``failed``: a 0.0."""


@dataclass(frozen=True, slots=True, kw_only=True)
class SensorModelFit:
    """What the experiments say of the lidar."""

    p_m1_given_z1: Estimate
    """How often the wall was read right: p(m=1 given z=1)."""
    p_m0_given_z0: Estimate
    """How often open space was: p(m=0 given z=0)."""
    lo1: Estimate
    """Log odds of the first."""
    lo0: Estimate
    """Log odds of the second."""
    table: tuple[ValueCount, ...]
    """Every value that was read, ascending, the wall's first."""
    mean_m: float | None
    """Mean of the wall's readings that did not fail [m]."""
    std_m: float | None
    """Their standard deviation [m]."""

    def rows(self, experiment: str) -> list[ValueCount]:
        """The table's rows of ``wall`` or ``open``."""
        return [row for row in self.table if row.experiment == experiment]


def fit_sensor_model(readings: Readings) -> SensorModelFit:
    """Count as the thesis does.

    In front of the wall the three most frequent distances are right, all others wrong; a 0.0 and an
    ``inf`` are no distances. In front of open space ``inf`` is right.
    """
    wall, free = _counts(readings.wall), _counts(readings.open)
    distances = [value for value in wall if value > 0.0 and math.isfinite(value)]
    right = set(sorted(distances, key=lambda value: (-wall[value], value))[:RIGHT_VALUES])
    occupied = proportion(sum(wall[value] for value in right), len(readings.wall))
    empty = proportion(free[math.inf], len(readings.open))
    hits = readings.wall[(readings.wall > 0.0) & np.isfinite(readings.wall)]
    return SensorModelFit(
        p_m1_given_z1=occupied,
        p_m0_given_z0=empty,
        lo1=log_odds_of(occupied),
        lo0=log_odds_of(empty),
        table=(*_table("wall", wall, right), *_table("open", free, {math.inf})),
        mean_m=float(hits.mean()) if len(hits) else None,
        std_m=float(hits.std()) if len(hits) else None,
    )


def proportion(right: int, total: int) -> Estimate:
    """The share of ``right`` in ``total`` with Wilson's score interval (Wilson 1927)."""
    interval = binomtest(right, total).proportion_ci(CONFIDENCE, method="wilson")
    return Estimate(value=right / total, low=float(interval.low), high=float(interval.high))


def log_odds_of(probability: Estimate) -> Estimate:
    """The log odds of a probability and of the ends of its interval; None at 0 and at 1."""
    return Estimate(
        value=_log_odds(probability.value),
        low=_log_odds(probability.low),
        high=_log_odds(probability.high),
    )


def _counts(readings: NDArray[np.float64]) -> Counter[float]:
    return Counter(np.round(readings, DECIMALS).tolist())


def _table(name: str, counts: Counter[float], right: set[float]) -> tuple[ValueCount, ...]:
    return tuple(
        ValueCount(
            experiment=name,
            reading=value,
            count=counts[value],
            counts_as=RIGHT if value in right else WRONG if value > 0.0 else FAILED,
        )
        for value in sorted(counts)
    )


def _log_odds(probability: float | None) -> float | None:
    if probability is None or not 0.0 < probability < 1.0:
        return None
    return math.log(probability / (1.0 - probability))
