"""Orders viewpoints so that much is seen soon: a tour of least weighted latency.

Going to the nearest frontier wastes time on crumbs, going to the largest leaves crumbs behind that
cost a second way. Minimising the sum of gain times arrival time over the whole tour (the weighted
travelling repairman problem) weighs one against the other; the end of the tour counts besides, as
in the travelling salesman problem. Only the first leg is driven before everything is decided anew.
"""

import numpy as np
from numba import njit
from numpy.typing import NDArray

NO_TIME = 1e-9
"""Keeps a place that the robot stands on from dividing by zero [s]."""
ROUNDING = 1e-9
"""A tour better by less than this share is no better: the search must end."""


def best_order(
    first_legs: NDArray[np.float64],
    legs: NDArray[np.float64],
    weights: NDArray[np.float64],
    end_share: float = 0.0,
) -> NDArray[np.int64]:
    """The order ``(n,)`` in which to visit n places, by greedy insertion and local search.

    Args:
        first_legs: Time from here to each place ``(n,)`` [s].
        legs: Time from each place (row) to each other ``(n, n)`` [s].
        weights: What each place is worth ``(n,)``.
        end_share: What the arrival at the last place counts, as a share of all weights.
    """
    order: NDArray[np.int64] = _by_ratio(first_legs, legs, weights)
    _improve(order, first_legs, legs, weights, end_share)
    return order


@njit(cache=True)
def latency(
    order: NDArray[np.int64],
    first_legs: NDArray[np.float64],
    legs: NDArray[np.float64],
    weights: NDArray[np.float64],
    end_share: float,
) -> float:
    """Sum over the places of worth times arrival time [s], the last one's once more by share."""
    time = first_legs[order[0]]
    total = weights[order[0]] * time
    for k in range(1, len(order)):
        time += legs[order[k - 1], order[k]]
        total += weights[order[k]] * time
    return float(total + end_share * weights.sum() * time)


@njit(cache=True)
def _by_ratio(
    first_legs: NDArray[np.float64], legs: NDArray[np.float64], weights: NDArray[np.float64]
) -> NDArray[np.int64]:
    """A first order: next is always the place with the most worth per second of the way."""
    count = len(weights)
    order = np.empty(count, dtype=np.int64)
    left = np.ones(count, dtype=np.bool_)
    for k in range(count):
        best, best_ratio = -1, -1.0
        for place in range(count):
            if left[place]:
                time = first_legs[place] if k == 0 else legs[order[k - 1], place]
                ratio = weights[place] / (time + NO_TIME)
                if ratio > best_ratio:
                    best, best_ratio = place, ratio
        order[k] = best
        left[best] = False
    return order


@njit(cache=True)
def _improve(
    order: NDArray[np.int64],
    first_legs: NDArray[np.float64],
    legs: NDArray[np.float64],
    weights: NDArray[np.float64],
    end_share: float,
) -> None:
    """Reverse stretches (2-opt) and move places (or-opt) while that helps, in place."""
    count = len(order)
    best = latency(order, first_legs, legs, weights, end_share)
    improved = True
    while improved:
        improved = False
        for i in range(count):
            for j in range(count):
                if i == j:
                    continue
                trial = _moved(order, i, j)
                cost = latency(trial, first_legs, legs, weights, end_share)
                if i < j:
                    reversed_ = _reversed(order, i, j)
                    other = latency(reversed_, first_legs, legs, weights, end_share)
                    if other < cost:
                        trial, cost = reversed_, other
                if cost < best * (1.0 - ROUNDING):
                    for k in range(count):
                        order[k] = trial[k]
                    best = cost
                    improved = True


@njit(cache=True)
def _moved(order: NDArray[np.int64], i: int, j: int) -> NDArray[np.int64]:
    """The order with its ``i``-th place taken out and put back as the ``j``-th.

    Element by element: numba takes two seconds to compile copies from slice to slice.
    """
    moved = order.copy()
    step = 1 if i < j else -1
    for k in range(i, j, step):
        moved[k] = order[k + step]
    moved[j] = order[i]
    return moved


@njit(cache=True)
def _reversed(order: NDArray[np.int64], i: int, j: int) -> NDArray[np.int64]:
    """The order with the stretch from its ``i``-th to its ``j``-th place turned round."""
    turned = order.copy()
    for k in range(i, j + 1):
        turned[k] = order[i + j - k]
    return turned
