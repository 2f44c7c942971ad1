import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mapping.errors import TestbedError
from mapping.slam.metric_scale import MetricScaleConfig, grown, lidar_scale_error, scaled

LIDAR_SIGMA = 0.005


def integrated(disagreement: float, config: MetricScaleConfig) -> float:
    """The posterior mean by adding up over every error that the lidar might have."""
    errors = np.linspace(-0.05, 0.05, 20001)
    prior = np.exp(-0.5 * (errors / LIDAR_SIGMA) ** 2)
    wheels = errors - disagreement
    likelihood = sum(
        share / sigma * np.exp(-0.5 * (wheels / sigma) ** 2)
        for share, sigma in zip(config.wheel_shares, config.wheel_sigmas, strict=True)
    )
    weights = prior * likelihood
    return float(np.sum(weights * errors) / np.sum(weights))


@given(st.floats(-0.05, 0.05))
def test_the_error_is_the_posterior_mean(disagreement: float) -> None:
    config = MetricScaleConfig()
    error = lidar_scale_error(disagreement, 0.0, LIDAR_SIGMA, config)
    assert error == pytest.approx(integrated(disagreement, config), abs=1e-6)


def test_two_equally_good_metres_share_what_they_disagree_by() -> None:
    config = MetricScaleConfig(wheel_sigmas=(LIDAR_SIGMA,), wheel_shares=(1.0,))
    assert lidar_scale_error(0.004, 0.0, LIDAR_SIGMA, config) == pytest.approx(0.002)


def test_wheels_that_are_far_off_say_little() -> None:
    assert abs(lidar_scale_error(0.1, 0.0, LIDAR_SIGMA, MetricScaleConfig())) < 0.0005


def test_a_lidar_without_error_is_believed() -> None:
    assert lidar_scale_error(0.01, 1e-6, 0.0, MetricScaleConfig()) == 0.0


def test_what_is_not_known_yet_changes_nothing() -> None:
    assert abs(lidar_scale_error(0.01, 10.0, LIDAR_SIGMA, MetricScaleConfig())) < 1e-6


def test_an_uncertainty_counts_as_much_as_the_settings_say() -> None:
    config = MetricScaleConfig(wheel_sigmas=(LIDAR_SIGMA,), wheel_shares=(1.0,), surer=2.0)
    error = lidar_scale_error(0.004, 4.0 * LIDAR_SIGMA**2, LIDAR_SIGMA, config)
    assert error == pytest.approx(0.004 / 3.0)  # three equal variances


def test_over_many_robots_the_error_left_is_smaller_than_the_lidars() -> None:
    draw = np.random.default_rng(0).standard_normal
    for sigma, share_left in ((0.005, 0.82), (0.015, 1.0)):
        lidar, wheels = LIDAR_SIGMA * draw(4000), sigma * draw(4000)
        found = [
            lidar_scale_error(d, 0.0, LIDAR_SIGMA, MetricScaleConfig())
            for d in (lidar - wheels).tolist()
        ]
        assert np.std(lidar - found) < share_left * np.std(lidar)


@pytest.mark.parametrize(
    "wrong",
    [
        {"wheel_sigmas": (), "wheel_shares": ()},
        {"wheel_sigmas": (0.0, 0.1, 0.1)},
        {"wheel_sigmas": (0.01,)},
        {"wheel_shares": (0.5, 0.5, float("nan"))},
        {"surer": 0.0},
    ],
)
def test_figures_that_are_no_errors_are_refused(wrong: dict[str, tuple[float, ...]]) -> None:
    with pytest.raises(TestbedError, match="metric scale"):
        MetricScaleConfig(**wrong)


def test_growing_keeps_one_pose_and_every_heading() -> None:
    poses = np.array([(1.0, 2.0, 0.3), (3.0, 2.0, -2.0), (1.0, 6.0, 1.0)])
    larger = grown(poses, poses[:1], 1.5)
    assert larger[0] == pytest.approx(poses[0])
    assert larger[:, 2] == pytest.approx(poses[:, 2])
    assert larger[1:, :2] == pytest.approx(np.array([(4.0, 2.0), (1.0, 8.0)]))
    assert grown(poses, poses[:0], 1.5) == pytest.approx(poses)
    assert scaled(poses[1], 2.0) == pytest.approx(np.array([6.0, 4.0, -2.0]))
