"""Histogram filters, fixed and adaptive: discrete Bayes on boxes, Kalman as the boxes shrink."""

import numpy as np
import pytest

from mapping.errors import TestbedError
from mapping.filters import bayes, kalman
from mapping.filters.gaussian import gaussian
from mapping.filters.histogram import HistogramFilter
from mapping.filters.histogram_tree import TreeConfig, TreeHistogram

Array = np.ndarray
SPACE = ([-10.0], [10.0])
MOTION_SIGMA, SENSOR_SIGMA = 0.6, 0.8
MEASUREMENTS = (0.4, 1.7, 2.2, 3.9)


def moved(way: float, sigma: float = MOTION_SIGMA):
    def density(to: Array, start: Array) -> Array:
        return np.exp(-0.5 * np.sum(((to - start - way) / sigma) ** 2, axis=1))

    return density


def seen(place: float, sigma: float = SENSOR_SIGMA):
    def likelihood(states: Array) -> Array:
        return np.exp(-0.5 * np.sum(((states - place) / sigma) ** 2, axis=1))

    return likelihood


def run(belief: HistogramFilter | TreeHistogram) -> tuple[float, float]:
    """Mean and variance after all measurements, from N(0, 4)."""
    belief.correct(seen(0.0, 2.0))
    for measurement in MEASUREMENTS:
        belief.predict(moved(1.0))
        belief.correct(seen(measurement))
    return float(belief.mean[0]), float(belief.covariance[0, 0])


def kalman_end() -> tuple[float, float]:
    belief = gaussian([0.0], [[4.0]])
    for measurement in MEASUREMENTS:
        belief = kalman.predict(belief, [[1.0]], [[MOTION_SIGMA**2]], [[1.0]], [1.0])
        belief = kalman.correct(belief, [[1.0]], [measurement], [[SENSOR_SIGMA**2]])
    return float(belief.mean[0]), float(belief.covariance[0, 0])


def test_it_converges_to_the_kalman_filter_as_the_boxes_shrink() -> None:
    mean, variance = kalman_end()
    errors = []
    for boxes in (20, 40, 80, 320):
        found_mean, found_variance = run(HistogramFilter(*SPACE, (boxes,)))
        errors.append(max(abs(found_mean - mean), abs(found_variance - variance)))
    assert errors == sorted(errors, reverse=True)
    assert errors[-1] < 1e-3


def test_the_adaptive_one_is_as_good_with_fewer_boxes() -> None:
    mean, variance = kalman_end()
    tree = TreeHistogram(*SPACE, TreeConfig(smallest=(20.0 / 256.0,)))
    found_mean, found_variance = run(tree)
    assert found_mean == pytest.approx(mean, abs=0.02)
    assert found_variance == pytest.approx(variance, abs=0.02)
    assert len(tree) < 256 / 2


def test_boxes_of_the_tree_tile_the_space_and_are_small_where_the_belief_is() -> None:
    tree = TreeHistogram([0.0, 0.0], [8.0, 4.0], TreeConfig(smallest=(0.25, 0.25)))

    def likelihood(states: Array) -> Array:
        return 1e-6 + np.exp(-0.5 * np.sum(((states - [6.1, 1.2]) / 0.4) ** 2, axis=1))

    for _ in range(3):
        tree.predict(moved(0.0, 0.05))
        tree.correct(likelihood)
        assert tree.belief.sum() == pytest.approx(1.0)
        assert tree.volumes.sum() == pytest.approx(32.0)
    inside = (tree.lower[:, None] < tree.centers) & (tree.centers < tree.upper[:, None])
    assert np.array_equal(np.all(inside, axis=2), np.eye(len(tree), dtype=bool)), "none overlap"
    assert tree.mean == pytest.approx([6.1, 1.2], abs=0.15)
    likely = tree.belief > 0.05
    assert tree.volumes[likely].max() <= 0.25 * 0.25 + 1e-12
    assert tree.volumes.max() >= 4.0
    finest = tree.volumes.min()
    for _ in range(10):
        tree.predict(moved(0.0, 3.0))
    assert tree.volumes.min() > finest, "what was cut is joined again when the belief spreads"


def test_a_box_for_each_state_is_the_discrete_bayes_filter() -> None:
    transition = np.array([[0.1, 0.9], [0.0, 1.0]])
    histogram = HistogramFilter([-0.5], [1.5], (2,))

    def density(to: Array, start: Array) -> Array:
        return transition[round(start[0]), np.round(to[:, 0]).astype(int)]

    histogram.predict(density)
    histogram.correct(lambda states: np.array([0.3, 0.6])[np.round(states[:, 0]).astype(int)])
    expected = bayes.correct(bayes.predict([0.5, 0.5], transition), [0.3, 0.6])
    assert histogram.belief == pytest.approx(expected, abs=1e-12)


def test_two_doors_keep_two_peaks_which_no_gaussian_can() -> None:
    histogram = HistogramFilter(*SPACE, (100,))
    histogram.correct(lambda x: seen(-4.0, 0.3)(x) + seen(3.0, 0.3)(x))
    belief, x = histogram.belief, histogram.centers[:, 0]
    assert belief[np.abs(x + 4.0) < 1.0].sum() == pytest.approx(0.5, abs=0.01)
    assert belief[np.abs(x - 3.0) < 1.0].sum() == pytest.approx(0.5, abs=0.01)
    assert belief[np.abs(x) < 1.0].sum() < 1e-6


def test_what_makes_no_histogram_is_refused() -> None:
    with pytest.raises(TestbedError, match="corners"):
        HistogramFilter([0.0], [0.0], (3,))
    with pytest.raises(TestbedError, match="shape"):
        HistogramFilter([0.0], [1.0], (0,))
    with pytest.raises(TestbedError, match="for ever"):
        TreeConfig(smallest=(0.1,), split_above=0.01, merge_below=0.02)
    with pytest.raises(TestbedError, match="evidence"):
        HistogramFilter([0.0], [1.0], (3,)).correct(lambda x: np.zeros(len(x)))


def test_a_belief_that_would_leave_the_space_is_refused_and_stays() -> None:
    boxes = HistogramFilter([0.0], [1.0], (10,))
    with pytest.raises(TestbedError, match="transition"):
        boxes.predict(lambda states, before: np.zeros(len(states)))
    assert boxes.belief == pytest.approx(np.full(10, 0.1))
