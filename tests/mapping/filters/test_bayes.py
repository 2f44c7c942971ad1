"""The Bayes filter: the thesis's worked example, and the same in an occupancy grid's cell."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mapping.errors import TestbedError
from mapping.filters import bayes
from mapping.messages import LaserScan, Odometry, Twist
from mapping.occ_grid_mapp import OccGridMapp
from mapping.sensor_model import FREE_READINGS, OCCUPIED_READINGS, READINGS

probability = st.floats(0.001, 0.999)


def test_the_thesis_worked_example() -> None:
    """Section 3.2: a door that is pushed opens with 0.9, and a sensor that is right seldom."""
    transition = [[0.1, 0.9], [0.0, 1.0]]
    prior = bayes.predict([0.5, 0.5], transition)
    posterior = bayes.correct(prior, [0.3, 0.6])
    assert prior == pytest.approx([0.05, 0.95], abs=1e-12)
    assert posterior == pytest.approx([0.0256, 0.9744], abs=5e-5)
    assert bayes.predict_binary(0.5, 0.9) == pytest.approx(0.95, abs=1e-12)
    assert bayes.correct_binary(0.95, 0.3, 0.6) == pytest.approx(posterior[1], abs=1e-12)


@given(probability, probability, probability, probability, probability)
def test_two_discrete_states_are_the_binary_filter(
    p_one: float, from_zero: float, from_one: float, z_zero: float, z_one: float
) -> None:
    transition = [[1.0 - from_zero, from_zero], [1.0 - from_one, from_one]]
    posterior = bayes.correct(bayes.predict([1.0 - p_one, p_one], transition), [z_zero, z_one])
    prior = bayes.predict_binary(p_one, from_zero, from_one)
    assert posterior[1] == pytest.approx(bayes.correct_binary(prior, z_zero, z_one), rel=1e-9)


@given(probability, probability, probability)
def test_log_odds_are_the_binary_filter(p_one: float, z_zero: float, z_one: float) -> None:
    log_odds = bayes.correct_log_odds(np.log(p_one / (1.0 - p_one)), z_zero, z_one)
    expected = bayes.correct_binary(p_one, z_zero, z_one)
    assert 1.0 / (1.0 + np.exp(-log_odds)) == pytest.approx(expected, rel=1e-9)


@given(st.lists(st.floats(0.01, 1.0), min_size=2, max_size=6), st.integers(0, 1000))
def test_the_belief_stays_a_distribution_and_a_blind_sensor_changes_nothing(
    weights: list[float], seed: int
) -> None:
    belief = np.array(weights) / np.sum(weights)
    transition = np.random.default_rng(seed).dirichlet(np.ones(len(belief)), size=len(belief))
    prior = bayes.predict(belief, transition)
    assert prior.sum() == pytest.approx(1.0, abs=1e-12)
    assert bayes.correct(prior, np.full(len(belief), 0.2)) == pytest.approx(prior, abs=1e-12)


def test_the_order_of_measurements_of_a_static_state_does_not_matter() -> None:
    door_open = [0.2, 0.5, 0.3]
    first, second = [0.6, 0.3, 0.1], [0.2, 0.7, 0.5]
    one_way = bayes.correct(bayes.correct(door_open, first), second)
    assert one_way == pytest.approx(bayes.correct(bayes.correct(door_open, second), first))


def test_a_cell_of_the_thesis_mapper_is_a_binary_bayes_filter() -> None:
    """Three scans of a wall 1 m ahead: the belief of the hit cell and of a free one."""
    mapper = OccGridMapp()
    for k in range(3):
        ranges = np.full(360, 0.0, dtype=np.float32)
        ranges[0] = 1.0
        pose = np.zeros(3)
        mapper.update(
            LaserScan(stamp=0.2 * k, ranges=ranges),
            [Odometry(stamp=0.2 * k, pose_odom=pose, twist=Twist())],
        )
    grid = mapper.grid
    log_odds = grid.log_odds[grid.log_odds != 0.0]
    hit_right, free_right = OCCUPIED_READINGS / READINGS, FREE_READINGS / READINGS
    occupied = free = 0.5
    for _ in range(3):
        occupied = bayes.correct_binary(occupied, 1.0 - hit_right, hit_right)
        free = bayes.correct_binary(free, free_right, 1.0 - free_right)
    beliefs = 1.0 / (1.0 + np.exp(-log_odds.astype(np.float64)))
    assert beliefs.max() == pytest.approx(occupied, rel=1e-6)
    assert beliefs.min() == pytest.approx(free, rel=1e-4)


def test_what_cannot_be_is_refused() -> None:
    with pytest.raises(TestbedError, match="belief"):
        bayes.predict([0.5, 0.6], np.eye(2))
    with pytest.raises(TestbedError, match="transition row"):
        bayes.predict([0.5, 0.5], [[0.5, 0.4], [0.0, 1.0]])
    with pytest.raises(TestbedError, match="shape"):
        bayes.predict([0.5, 0.5], np.eye(3))
    with pytest.raises(TestbedError, match="evidence"):
        bayes.correct([1.0, 0.0], [0.0, 1.0])
    with pytest.raises(TestbedError, match="likelihood"):
        bayes.correct_binary(1.0, 1.0, 0.0)


@pytest.mark.parametrize("likelihood", [[0.5, -0.1], [1.0, np.nan], [-1.0, -1.0]])
def test_likelihoods_that_are_no_probabilities_are_refused(likelihood: list[float]) -> None:
    with pytest.raises(TestbedError, match="likelihood"):
        bayes.correct([0.5, 0.5], likelihood)
    with pytest.raises(TestbedError, match="likelihood"):
        bayes.correct_binary(0.5, *likelihood)
