"""Turns a belief over a few states, a control and a measurement into the next belief.

The Bayes filter (Thrun, Burgard and Fox, Probabilistic Robotics, 2005, table 2.1; thesis, table
3.1) in its discrete form (table 4.1; thesis, table 3.6), and for a state that is 0 or 1.
"""

import math

import numpy as np
from numpy.typing import ArrayLike, NDArray

from mapping.errors import TestbedError

SUMS_TO_ONE = 1e-9
"""How far a sum of probabilities may be from 1."""

Array = NDArray[np.float64]


def predict(belief: ArrayLike, transition: ArrayLike) -> Array:
    """The prior ``(n,)``: the belief after a control, before the measurement.

    Args:
        belief: Probability of each state before ``(n,)``.
        transition: ``(n, n)``; entry ``[i, j]`` is p(x_t = j | u_t, x_t-1 = i), each row sums to 1.

    Raises:
        TestbedError: A belief or a row of the transition is no distribution.
    """
    belief = _distribution("belief", belief)
    transition = np.asarray(transition, dtype=np.float64)
    if transition.shape != (len(belief), len(belief)):
        raise TestbedError(
            f"transition: shape {transition.shape}; must be {(len(belief), len(belief))}"
        )
    for row in transition:
        _distribution("transition row", row)
    return np.asarray(belief @ transition)


def correct(prior: ArrayLike, likelihood: ArrayLike) -> Array:
    """The posterior ``(n,)`` after a measurement.

    Args:
        prior: Probability of each state before it ``(n,)``.
        likelihood: p(z_t | x_t = each state) of the measurement that came ``(n,)``; need not sum
            to 1.

    Raises:
        TestbedError: The measurement is impossible in every state that is thought possible, or a
            likelihood is negative.
    """
    prior = _distribution("prior", prior)
    likelihood = np.asarray(likelihood, dtype=np.float64)
    if np.any(likelihood < 0.0):
        raise TestbedError(f"likelihood: {np.nanmin(likelihood)}; must be 0 or more")
    joint = prior * likelihood
    evidence = float(joint.sum())
    if not (math.isfinite(evidence) and evidence > 0.0):
        raise TestbedError(
            f"likelihood: evidence {evidence}; must be above 0: some possible state must explain "
            "the measurement"
        )
    return np.asarray(joint / evidence)


def predict_binary(p_one: float, one_from_zero: float, one_from_one: float = 1.0) -> float:
    """The prior that a state is 1.

    Args:
        p_one: Probability that it was 1.
        one_from_zero: That the control turns a 0 into a 1 (thesis 3.2: p_u,high).
        one_from_one: That it leaves a 1 as it is.
    """
    return one_from_zero * (1.0 - p_one) + one_from_one * p_one


def correct_binary(p_one: float, likelihood_zero: float, likelihood_one: float) -> float:
    """The posterior that a state is 1, after a measurement.

    Args:
        p_one: The prior.
        likelihood_zero: p(z | 0) of the measurement that came.
        likelihood_one: p(z | 1) of it.

    Raises:
        TestbedError: The measurement is impossible in both states, or a likelihood is negative.
    """
    zero, one = likelihood_zero * (1.0 - p_one), likelihood_one * p_one
    if not (zero >= 0.0 and one >= 0.0 and zero + one > 0.0):
        raise TestbedError(f"likelihood: {likelihood_zero}, {likelihood_one}; must explain z")
    return one / (zero + one)


def correct_log_odds(log_odds: float, likelihood_zero: float, likelihood_one: float) -> float:
    """The posterior log odds that a static state is 1 (Probabilistic Robotics, table 4.2).

    The book writes it with the inverse model p(x | z); with a prior of 0.5 that is the ratio of the
    likelihoods, as here and in an occupancy grid. Both likelihoods must be above 0.
    """
    return log_odds + math.log(likelihood_one / likelihood_zero)


def _distribution(name: str, values: ArrayLike) -> Array:
    """Probabilities as an array, or one clear line."""
    array = np.asarray(values, dtype=np.float64)
    if array.ndim != 1 or not np.all(array >= 0.0) or abs(array.sum() - 1.0) > SUMS_TO_ONE:
        raise TestbedError(f"{name}: {array.tolist()}; must be probabilities that sum to 1")
    return array
