"""Weighted poses gathered into places."""

import math

import numpy as np
import pytest

from mapping.localization.hypothesis_clusters import cluster
from mapping.localization.localizer import is_ambiguous, is_lost


def scattered(middle: tuple[float, float, float], count: int, seed: int) -> np.ndarray:
    rng = np.random.default_rng(seed)
    poses = np.array(middle) + rng.standard_normal((count, 3)) * [0.05, 0.08, 0.04]
    poses[:, 2] = np.angle(np.exp(1j * poses[:, 2]))
    return poses


def test_two_places_are_told_with_their_shares() -> None:
    poses = np.concatenate(
        (scattered((1.0, 2.0, math.pi), 300, 0), scattered((4.0, 1.0, 0.3), 100, 1))
    )
    first, second = cluster(poses, np.full(400, 1.0 / 400.0))
    assert first.weight == pytest.approx(0.75)
    assert second.weight == pytest.approx(0.25)
    assert first.pose[:2] == pytest.approx([1.0, 2.0], abs=0.02)
    assert abs(first.pose[2]) == pytest.approx(math.pi, abs=0.02), "not 0, the plain mean"
    assert np.sqrt(np.diag(first.covariance))[:2] == pytest.approx([0.05, 0.08], rel=0.2)
    assert is_ambiguous([first, second])
    assert not is_lost([first, second])


def test_one_place_with_two_headings_is_two_hypotheses() -> None:
    poses = np.concatenate((scattered((1.0, 1.0, 0.0), 50, 2), scattered((1.0, 1.0, 3.1), 50, 3)))
    assert [round(each.weight, 2) for each in cluster(poses, np.full(100, 0.01))] == [0.5, 0.5]


def test_a_belief_that_is_spread_out_is_lost() -> None:
    poses = np.random.default_rng(4).uniform(-20.0, 20.0, (2000, 3))
    hypotheses = cluster(poses, np.full(2000, 1.0 / 2000.0))
    assert is_lost(hypotheses)
    assert is_ambiguous(hypotheses)
    assert is_lost([])
