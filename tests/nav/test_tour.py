"""The tour against every order there is."""

from itertools import pairwise, permutations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from nav.planner import CostField
from nav.tour import best_order, latency
from tests.nav.grids import costmap_of, grid_from_text


def random_places(seed: int, count: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    rng = np.random.default_rng(seed)
    points = rng.uniform(0.0, 10.0, (count, 2))
    legs = np.hypot(*(points[:, None] - points).transpose(2, 0, 1))
    return np.hypot(*points.T), legs, rng.uniform(0.5, 4.0, count)


def plain_latency(
    order: tuple[int, ...],
    first: np.ndarray,
    legs: np.ndarray,
    worth: np.ndarray,
    end_share: float = 0.0,
) -> float:
    times = np.cumsum([first[order[0]], *(legs[a, b] for a, b in pairwise(order))])
    return float(np.sum(times * worth[list(order)]) + end_share * worth.sum() * times[-1])


@given(seed=st.integers(0, 10_000), count=st.integers(1, 6), end_share=st.floats(0.0, 5.0))
@settings(max_examples=30, deadline=None)
def test_the_order_is_nearly_as_good_as_the_best_of_all(
    seed: int, count: int, end_share: float
) -> None:
    first, legs, worth = random_places(seed, count)
    order = best_order(first, legs, worth, end_share)
    assert sorted(order) == list(range(count))
    best = min(plain_latency(p, first, legs, worth, end_share) for p in permutations(range(count)))
    found = plain_latency(tuple(order), first, legs, worth, end_share)
    assert latency(order, first, legs, worth, end_share) == pytest.approx(found)
    assert found <= 1.1 * best, "local search: a tenth from the optimum at worst, mostly there"


def test_what_would_cost_a_second_way_is_taken_along_when_the_end_counts() -> None:
    """A crumb to the west, 4 m from here, and rooms one after another to the east."""
    x = np.array([-4.0, 5.0, 10.0, 15.0, 20.0])
    legs, worth = np.abs(x[:, None] - x), np.array([0.5, 4.0, 4.0, 4.0, 4.0])
    assert best_order(np.abs(x), legs, worth)[-1] == 0
    assert best_order(np.abs(x), legs, worth, 5.0).tolist() == [0, 1, 2, 3, 4]


def test_costs_between_places_are_never_too_low_and_right_across_a_corridor() -> None:
    rooms = "\n".join(
        ["#" * 61]
        + ["#" + "." * 29 + "#" + "." * 29 + "#"] * 20
        + ["#" + "." * 59 + "#"] * 16
        + ["#" * 61]
    )
    costmap = costmap_of(grid_from_text(rooms))
    places = np.array([[0.8, 1.3], [2.2, 1.3], [0.8, 0.5]])
    between = CostField.around(costmap, (1.5, 0.5)).costs_between(places)
    for a in range(3):
        exact = CostField.around(costmap, places[a])
        for b in range(3):
            assert between[a, b] >= exact.cost_at(places[b]) - 0.02
    exact = CostField.around(costmap, places[0]).cost_at(places[1])
    assert between[0, 1] == pytest.approx(exact, rel=0.15), "both rooms open onto the corridor"
