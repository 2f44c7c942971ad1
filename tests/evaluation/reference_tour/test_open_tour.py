"""Short open tours against the best of all orders."""

from itertools import pairwise, permutations

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from evaluation.reference_tour.open_tour import Lengths, improved, nearest_neighbours

PLACES = 7
TOURS = 150


def lengths_between(points: np.ndarray) -> Lengths:
    away = np.hypot(*(points[:, np.newaxis] - points[np.newaxis]).transpose(2, 0, 1))
    return {(i, j): float(away[i, j]) for i, j in np.ndindex(away.shape)}


def length_of(tour: list[int], lengths: Lengths) -> float:
    return sum(lengths[leg] for leg in pairwise(tour))


def test_tours_of_seven_places_are_hardly_longer_than_the_best() -> None:
    random = np.random.default_rng(0)
    excess = []
    for _ in range(TOURS):
        lengths = lengths_between(random.uniform(0.0, 10.0, (PLACES, 2)))
        tour = improved(nearest_neighbours(range(PLACES), lengths), lengths)
        best = min(length_of([0, *rest], lengths) for rest in permutations(range(1, PLACES)))
        excess.append(length_of(tour, lengths) / best - 1.0)
    assert np.mean(excess) < 0.01
    assert np.max(excess) < 0.2


@given(st.lists(st.tuples(st.floats(0, 9), st.floats(0, 9)), min_size=1, max_size=12))
def test_a_tour_passes_every_place_once_and_improving_makes_it_no_longer(
    points: list[tuple[float, float]],
) -> None:
    lengths = lengths_between(np.array(points))
    first = nearest_neighbours(range(len(points)), lengths)
    tour = improved(first, lengths)
    assert sorted(tour) == list(range(len(points)))
    assert tour[0] == first[0] == 0
    assert length_of(tour, lengths) <= length_of(first, lengths) + 1e-9
    for i in range(1, len(tour)):
        for j in range(i + 1, len(tour) + 1):
            turned = tour[:i] + tour[i:j][::-1] + tour[j:]
            assert length_of(tour, lengths) <= length_of(turned, lengths) + 2e-6
