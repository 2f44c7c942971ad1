"""Odometry counts whole ticks and integrates them; its errors are as large as the presets say."""

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from envs.burger_constants import CONTACT_CREEP, WHEEL_RADIUS, WHEEL_SEPARATION
from envs.floor_plan import Box, FloorPlan
from envs.simulation import Simulation
from envs.wheel_encoders import (
    ODOMETRY_PRESETS,
    TICK,
    OdometryConfig,
    WheelEncoders,
)
from mapping.errors import TestbedError
from mapping.geometry import between, compose

PERIOD = 1.0 / 30.0
ROLLING_RADIUS = WHEEL_RADIUS * (1.0 - CONTACT_CREEP)
OPEN_FLOOR = FloorPlan(
    name="open floor", start=(1.0, 2.0, 0.5), boxes=(Box(center=(50.0, 0.0), size=(1.0, 1.0)),)
)


def encoders(config: OdometryConfig, seed: int = 0) -> WheelEncoders:
    made = WheelEncoders(config)
    made.reset(np.random.default_rng(seed), (0.0, 0.0), np.zeros(3))
    return made


def reckon(config: OdometryConfig, angles: np.ndarray, seed: int = 0) -> np.ndarray:
    """The rows that wheel angles ``(n, 2)`` at 30 Hz give."""
    made = encoders(config, seed)
    return np.array(
        [made.read((k + 1) * PERIOD, (a, b), 0.0) for k, (a, b) in enumerate(angles.tolist())]
    )


@settings(deadline=None, max_examples=30)
@given(
    steps=st.lists(st.tuples(st.floats(-0.2, 0.2), st.floats(-0.2, 0.2)), min_size=1, max_size=40)
)
def test_ideal_odometry_equals_a_slow_reference_in_whole_ticks(
    steps: list[tuple[float, float]],
) -> None:
    angles = np.cumsum(np.array(steps), axis=0)
    rows = reckon(replace(ODOMETRY_PRESETS["ideal"], yaw_source="encoders"), angles)
    ticks = np.vstack(((0, 0), np.floor(angles / TICK)))
    pose = np.zeros(3)
    for row, (left, right) in zip(rows, np.diff(ticks, axis=0), strict=True):
        way = 0.5 * (left + right) * TICK * ROLLING_RADIUS
        turn = (right - left) * TICK * ROLLING_RADIUS / WHEEL_SEPARATION
        # Half the turn, the way, half the turn: midpoint integration as motions of a body.
        for motion in ((0.0, 0.0, turn / 2), (way, 0.0, 0.0), (0.0, 0.0, turn / 2)):
            pose = compose(pose, motion)
        np.testing.assert_allclose(row[1:4], pose, atol=1e-9)
        np.testing.assert_allclose(row[4:], (way / PERIOD, turn / PERIOD), atol=1e-9)


def test_less_than_a_tick_is_no_motion() -> None:
    rows = reckon(ODOMETRY_PRESETS["ideal"], np.full((3, 2), 0.9 * TICK))
    np.testing.assert_array_equal(rows[:, 1:], 0.0)


def test_a_tick_is_a_twentieth_of_a_millimetre() -> None:
    assert round(1e3 * TICK * WHEEL_RADIUS, 4) == 0.0506


@pytest.mark.parametrize(("preset", "times"), [("typical", 1.0), ("poor", 3.0)])
def test_episodes_differ_by_the_presets_radius_and_base(preset: str, times: float) -> None:
    config = replace(ODOMETRY_PRESETS[preset], yaw_source="encoders")
    straight = np.full((1, 2), 1000.0)  # 33 m: slip is small beside the radius
    ways = [math.hypot(*reckon(config, straight, seed)[0, 1:3]) for seed in range(1000)]
    assert np.std(ways) / (1000.0 * WHEEL_RADIUS) == pytest.approx(0.005 * times, rel=0.08)
    # A full turn in place; radius and base add up as independent errors.
    spin = np.array(((-1.0, 1.0),)) * math.pi * WHEEL_SEPARATION / WHEEL_RADIUS / 4.0
    turns = [reckon(config, spin, seed)[0, 3] for seed in range(1000)]
    slip = math.sqrt(2.0 * math.pi * WHEEL_SEPARATION / 4.0) * config.slip / WHEEL_SEPARATION
    expected = math.hypot(0.5 * math.pi * math.hypot(0.005, 0.01) * times, slip)
    assert np.std(turns) == pytest.approx(expected, rel=0.08)  # 1000 draws: 2.2 % is one sigma


def test_slip_grows_with_the_root_of_the_way() -> None:
    config = OdometryConfig(
        wheel_radius_sigma=0.0, wheel_base_sigma=0.0, slip=0.002, yaw_source="encoders"
    )
    for way in (1.0, 4.0):
        steps = np.linspace(0.0, way / ROLLING_RADIUS, 50)[1:, None] * (1.0, 1.0)
        yaws = [reckon(config, steps, seed)[-1, 3] for seed in range(300)]
        expected = math.sqrt(2.0 * way) * 0.002 / WHEEL_SEPARATION
        assert np.std(yaws) == pytest.approx(expected, rel=0.15)


def test_unequal_wheels_turn_a_straight_path() -> None:
    config = OdometryConfig(
        yaw_source="encoders",
        wheel_radius_sigma=0.0,
        wheel_base_sigma=0.0,
        wheel_mismatch_sigma=0.001,
        slip=0.0,
    )
    straight = np.full((1, 2), 1.0 / ROLLING_RADIUS)
    yaws = [reckon(config, straight, seed)[0, 3] for seed in range(400)]
    assert np.std(yaws) == pytest.approx(0.001 / WHEEL_SEPARATION, rel=0.12)


def drive(odometry: str | OdometryConfig, imu: str = "ideal") -> tuple[np.ndarray, np.ndarray]:
    """Odometry at the end of a curved drive, and the true pose in its frame."""
    simulation = Simulation(OPEN_FLOOR, lidar="ideal", odometry=odometry, imu=imu, rng=3)
    start = simulation.pose_world
    for k in range(150):
        simulation.command(0.15, 0.8 if k % 60 < 30 else -0.5)
        last = simulation.advance().odometry[-1]
    return last, between(start, simulation.pose_world)


def test_ideal_odometry_follows_the_truth() -> None:
    last, truth = drive("ideal")
    # 2.2 m with 5 changes of curve: what is left is tyre slip at each, and 4 ms of lag.
    assert math.hypot(*(last[1:3] - truth[:2])) < 0.01
    assert abs(last[3] - truth[2]) < 0.01


def test_true_odometry_is_the_truth() -> None:
    last, truth = drive("truth")
    np.testing.assert_allclose(last[1:4], truth, atol=1e-12)


def test_true_odometry_has_the_true_velocity() -> None:
    simulation = Simulation(OPEN_FLOOR, odometry="truth", rng=0)
    for _ in range(10):
        simulation.command(0.15, -0.6)
        last = simulation.advance().odometry[-1]
    np.testing.assert_allclose(last[4:], simulation.velocity_base, atol=1e-12)
    np.testing.assert_allclose(last[4:], (0.15, -0.6), rtol=0.01)


def test_yaw_from_the_imu_does_not_see_the_wheel_base() -> None:
    wrong_base = OdometryConfig(
        wheel_radius_sigma=0.0, wheel_base_sigma=0.1, slip=0.0, yaw_source="encoders"
    )
    by_wheels, truth = drive(wrong_base)
    by_imu, _ = drive(
        OdometryConfig(wheel_radius_sigma=0.0, wheel_base_sigma=0.1, slip=0.0, yaw_source="imu")
    )
    assert abs(by_imu[3] - truth[2]) < 0.01  # the last IMU message is up to 7 ms old
    assert abs(by_wheels[3] - truth[2]) > 0.02


def test_yaw_from_the_imu_passes_half_a_turn_without_a_jump() -> None:
    made = encoders(OdometryConfig(yaw_source="imu", slip=0.0))
    yaws = [made.read((k + 1) * PERIOD, (0.0, 0.0), yaw) for k, yaw in enumerate((3.0, -3.2 + 0.1))]
    assert yaws[1][5] * PERIOD == pytest.approx(2.0 * math.pi - 6.1)


@pytest.mark.parametrize(
    ("field", "value"),
    [("slip", -1.0), ("wheel_radius_sigma", math.nan), ("wheel_base_sigma", 0.5),
     ("yaw_source", "gps")],
)  # fmt: skip
def test_figures_that_make_no_sense_are_refused(field: str, value: object) -> None:
    with pytest.raises(TestbedError, match=rf"odometry {field}: .*must be"):
        OdometryConfig(**{field: value})  # type: ignore[arg-type]
