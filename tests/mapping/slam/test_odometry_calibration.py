import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from mapping.geometry import Pose, between, compose, inverse
from mapping.slam.odometry_calibration import CalibrationConfig, OdometryCalibration

NOISE = np.diag(np.square([0.004, 0.004, 0.002]))
"""Covariance of a matched motion [m^2, m^2, rad^2]."""

SIGMAS = np.array([0.02, 0.05, 0.05, 0.05])
"""Prior standard deviations of scale, drift, turn and offset, as the defaults have them."""


def arc(way: float, turn: float) -> Pose:
    """The motion along an arc of a length [m] that turns by an angle [rad]."""
    half = 0.5 * turn
    chord = way * np.sinc(half / np.pi)
    return np.array([chord * np.cos(half), chord * np.sin(half), turn])


def moved(way: float, turn: float, errors: NDArray[np.float64]) -> Pose:
    """The true motion when the odometry says that it was an arc.

    The robot goes and turns more than it says by the shares, turns with the way by the drift, and
    what is taken for its centre lies ahead of the point that it turns about.
    """
    scale, drift, more, offset = errors
    centre = np.array([offset, 0.0, 0.0])
    about = arc((1.0 + scale) * way, (1.0 + more) * turn + drift * way)
    return compose(inverse(centre), compose(about, centre))


def random_arcs(rng: np.random.Generator, count: int) -> NDArray[np.float64]:
    """What the odometry says between scans ``(n, 2)``: straights, spins, bends and rests."""
    kinds = [
        (0.15, 0.0),
        (0.05, 0.0),
        (0.0, 0.2),
        (0.0, -0.2),
        (0.15, 0.1),
        (0.1, -0.1),
        (0.0, 0.0),
    ]
    return rng.choice(np.array(kinds), count)


def taught(
    errors: NDArray[np.float64], rng: np.random.Generator, count: int
) -> OdometryCalibration:
    calibration = OdometryCalibration()
    for way, turn in random_arcs(rng, count):
        seen = moved(way, turn, errors) + rng.normal(0.0, np.sqrt(np.diag(NOISE)))
        calibration.learn(arc(way, turn), seen, NOISE)
    return calibration


@given(seed=st.integers(0, 10_000))
@settings(max_examples=15)
def test_systematic_errors_are_learned_from_noisy_motions(seed: int) -> None:
    rng = np.random.default_rng(seed)
    errors = rng.uniform(-1.5, 1.5, 4) * SIGMAS
    calibration = taught(errors, rng, 300)
    # 4 mm off a way of 15 cm, in 130 of 300 motions, is 0.25 %, 2 mrad off 0.2 rad less; four of
    # those, and errors are taken to add up where they multiply
    assert calibration.errors == pytest.approx(errors, abs=0.016)
    off = calibration.errors - errors
    # chi-square of four: 23 is exceeded once in 10 000; multiplied errors are beyond the model
    assert off @ np.linalg.solve(calibration.covariance, off) < 40.0


@given(seed=st.integers(0, 10_000))
@settings(max_examples=15)
def test_a_corrected_motion_is_nearer_to_the_true_one(seed: int) -> None:
    rng = np.random.default_rng(seed)
    errors = rng.choice([-1.0, 1.0], 4) * SIGMAS * rng.uniform(0.8, 1.5, 4)
    calibration = taught(errors, rng, 300)
    before, after = [], []
    for way, turn in random_arcs(rng, 30):
        true, motion = moved(way, turn, errors), arc(way, turn)
        before.append(between(true, motion))
        after.append(between(true, calibration.corrected(motion)))
    sizes = [np.sqrt(np.mean(np.square(each), axis=0)) for each in (before, after)]
    # aside and in the turn; ahead, noise leaves 0.4 % of 15 cm, and what multiplies is not learned
    assert np.all(sizes[1][1:] < 0.3 * sizes[0][1:])
    assert sizes[1][0] < 0.3 * sizes[0][0] + 1e-3


def test_nothing_learned_corrects_nothing() -> None:
    motion = np.array([0.1, 0.02, -0.3])
    assert OdometryCalibration().corrected(motion) == pytest.approx(motion)


def test_perfect_odometry_is_left_alone() -> None:
    calibration = taught(np.zeros(4), np.random.default_rng(0), 300)
    assert np.all(np.abs(calibration.errors) < 0.01)
    motion = np.array([0.15, 0.0, 0.2])
    assert calibration.corrected(motion) == pytest.approx(motion, abs=3e-3)  # 1 % of each


def test_a_turn_across_the_cut_at_pi_is_a_small_one() -> None:
    calibration = OdometryCalibration()
    calibration.learn(np.array([0.0, 0.0, 3.1]), np.array([0.0, 0.0, 3.14 - 2 * np.pi]), NOISE)
    assert abs(calibration.errors[2]) < 0.05


def test_a_standing_robot_teaches_nothing() -> None:
    calibration = OdometryCalibration()
    for _ in range(50):
        calibration.learn(np.zeros(3), np.full(3, 1e-3), NOISE)
    assert calibration.errors == pytest.approx(np.zeros(4))
    # what a match gives back never exceeds what was known at first by more than it gives
    assert np.all(np.linalg.eigvalsh(calibration.covariance) > 0.0)


@given(seed=st.integers(0, 10_000))
@settings(max_examples=15)
def test_wild_matches_leave_errors_and_noise_finite(seed: int) -> None:
    rng, calibration = np.random.default_rng(seed), OdometryCalibration()
    for _ in range(100):
        calibration.learn(rng.normal(size=3), rng.normal(size=3) * 10.0, NOISE)
    most = CalibrationConfig().first_noise
    assert np.all(np.isfinite(calibration.errors))
    assert np.all(np.linalg.eigvalsh(calibration.covariance) > 0.0)
    for noise in (calibration.ahead_noise, calibration.aside_noise, calibration.turn_noise):
        assert 1.0 <= noise <= most


def test_the_noise_learned_follows_the_surprises() -> None:
    rng = np.random.default_rng(0)
    told = np.diag(np.square([0.01, 0.01, 0.01]))
    good, bad = OdometryCalibration(), OdometryCalibration()
    for _ in range(300):
        motion = np.array([0.1, 0.0, 0.05])
        good.learn(motion, motion + rng.normal(0.0, 1e-3, 3), told)
        bad.learn(motion, motion + rng.normal(0.0, 0.1, 3), told)
    model = np.diag(np.square([1e-3, 1e-3, 1e-3]))
    narrow, wide = (
        each.widened(np.array([0.1, 0.0, 0.05]), model, has_gyro=False) for each in (good, bad)
    )
    assert np.all(np.diag(narrow) < np.diag(wide))
    assert np.all(np.diag(narrow) >= np.diag(model))
    by_gyro = bad.widened(np.array([0.1, 0.0, 0.05]), model, has_gyro=True)
    assert by_gyro[2, 2] < wide[2, 2]


@given(
    ways=st.lists(st.floats(0.0, 0.5), min_size=1, max_size=20),
    turns=st.lists(st.floats(-0.5, 0.5), min_size=1, max_size=20),
)
def test_errors_not_learned_yet_grow_with_the_way_and_not_with_its_root(
    ways: list[float], turns: list[float]
) -> None:
    calibration = OdometryCalibration()
    steps = [arc(way, turn) for way, turn in zip(ways, turns, strict=False)]
    total, made = np.zeros((3, 3)), np.zeros(2)
    for step in steps:
        left, made = calibration.left(made, step)
        total += left
    way = sum(np.hypot(step[0], step[1]) for step in steps)
    turn = sum(abs(step[2]) for step in steps)
    assert made == pytest.approx([way, turn])
    scale, drift, turning, _ = 2.0 * SIGMAS
    expected = [(scale * way) ** 2, (scale * way) ** 2, (drift * way) ** 2 + (turning * turn) ** 2]
    assert np.diag(total) == pytest.approx(expected)
