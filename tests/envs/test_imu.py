"""The IMU feels what physics says it must, with the noise of its presets; its yaw drifts."""

import math
from dataclasses import replace

import mujoco
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import assets
from envs.burger_constants import IMU_POSITION
from envs.floor_plan import Box, FloorPlan
from envs.imu import GYRO_STEP, IMU_PRESETS, PERIOD, ImuConfig, InertialUnit, yaw_of
from envs.imu_kernels import GRAVITY, disturb, madgwick, mean_rates, specific_forces
from envs.simulation import Simulation
from mapping.errors import TestbedError
from mapping.geometry import wrap_to_pi
from mapping.messages import IMU_COLUMNS

OPEN_FLOOR = FloorPlan(
    name="open floor", start=(0.0, 0.0, 0.0), boxes=(Box(center=(50.0, 0.0), size=(1.0, 1.0)),)
)


def drive(imu: str | ImuConfig, linear: float, angular: float, seconds: float) -> np.ndarray:
    """The IMU rows of a drive from rest."""
    simulation = Simulation(OPEN_FLOOR, lidar="ideal", odometry="truth", imu=imu, rng=1)
    rows = []
    for _ in range(round(seconds * 10)):
        simulation.command(linear, angular)
        rows.append(simulation.advance().imu)
    return np.concatenate(rows)


def rest(n: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Stamps, positions and velocities of a base that stands level."""
    return (
        np.arange(1, n + 1) * PERIOD,
        np.tile((0.0, 0.0, 0.01, 1.0, 0.0, 0.0, 0.0), (n + 1, 1)),
        np.zeros((n + 1, 6)),
    )


def test_at_rest_it_feels_gravity_and_no_turning() -> None:
    rows = drive("ideal", 0.0, 0.0, 1.0)
    np.testing.assert_allclose(rows[:, 5:8], 0.0, atol=1e-6)
    # The tyres sink 0.03 mm and the caster less: 0.012 degrees of pitch, 0.002 m/s2.
    np.testing.assert_allclose(rows[:, 8:11], np.tile((0.0, 0.0, 9.81), (100, 1)), atol=3e-3)
    np.testing.assert_allclose(rows[:, 1:5], np.tile((0.0, 0.0, 0.0, 1.0), (100, 1)), atol=2e-3)


def test_messages_come_a_hundred_times_a_second() -> None:
    np.testing.assert_allclose(drive("ideal", 0.1, 0.1, 1.0)[:, 0], np.arange(1, 101) / 100.0)


def test_in_a_steady_spin_it_feels_the_centripetal_pull_of_its_place() -> None:
    """The unit sits 32 mm behind the axle: omega^2 * 0.032 forward."""
    late = drive("ideal", 0.0, 2.0, 2.0)[100:]
    np.testing.assert_allclose(late[:, 7], 2.0, rtol=1e-3)
    assert late[:, 8].mean() == pytest.approx(2.0**2 * 0.032, rel=0.02)
    assert late[:, 9].mean() == pytest.approx(0.0, abs=0.01)


def test_in_a_steady_arc_it_feels_the_pull_towards_the_centre() -> None:
    late = drive("ideal", 0.1, 1.0, 3.0)[100:]
    assert late[:, 9].mean() == pytest.approx(0.1 * 1.0, rel=0.02)  # v omega, to the left
    assert late[:, 8].mean() == pytest.approx(1.0**2 * 0.032, abs=0.003)  # the pitch at rest


def test_the_way_up_to_speed_is_the_integral_of_the_acceleration() -> None:
    rows = drive("ideal", 0.2, 0.0, 1.0)
    assert rows[:, 8].sum() * PERIOD == pytest.approx(0.2, rel=0.02)


def test_it_agrees_with_mujocos_own_sensors() -> None:
    """MuJoCo's sensors give single steps; their mean over the 10 ms is what ours gives."""
    spec = mujoco.MjSpec.from_string(assets.ROOT.joinpath("burger", "burger.xml").read_text())
    spec.worldbody.add_geom(
        type=mujoco.mjtGeom.mjGEOM_PLANE, size=(0, 0, 1), contype=0, conaffinity=1
    )
    for kind in (mujoco.mjtSensor.mjSENS_ACCELEROMETER, mujoco.mjtSensor.mjSENS_GYRO):
        spec.add_sensor(type=kind, objtype=mujoco.mjtObj.mjOBJ_SITE, objname="imu_link")
    model = spec.compile()
    data = mujoco.MjData(model)
    mujoco.mj_step(model, data, 250)
    data.ctrl[:] = 3.0, 5.0
    ours, theirs = [], []
    for _ in range(40):
        positions, velocities, felt = [data.qpos[:7].copy()], [data.qvel[:6].copy()], []
        for _ in range(5):
            mujoco.mj_step(model, data)
            felt.append(data.sensordata[:3].copy())
        positions.append(data.qpos[:7].copy())
        velocities.append(data.qvel[:6].copy())
        ours.append(
            specific_forces(np.array(positions), np.array(velocities), np.array(IMU_POSITION), 0.01)
        )
        theirs.append(np.mean(felt, axis=0))
        mujoco.mj_forward(model, data)
        np.testing.assert_allclose(data.sensordata[3:], data.qvel[3:6], atol=1e-9)
    # The start shakes the robot by several m/s2; 0.05 is the curvature within 10 ms.
    np.testing.assert_allclose(np.concatenate(ours), theirs, atol=0.05)


def test_noise_and_bias_are_those_of_the_preset() -> None:
    unit, rng = InertialUnit(IMU_PRESETS["drifting"]), np.random.default_rng(2)
    biases = []
    for _ in range(200):
        unit.reset(rng)
        rows = unit.read(*rest(200))
        biases.append(rows[:, 5:11].mean(axis=0))
        spread = rows[:, 5:11].std(axis=0)
        np.testing.assert_allclose(spread[:3], 2e-4, rtol=0.25)  # 200 draws: 5 % is one sigma
        np.testing.assert_allclose(spread[3:], 1.7e-2, rtol=0.25)
    spread = np.std(biases, axis=0)
    np.testing.assert_allclose(spread[:3], GYRO_STEP / math.sqrt(12.0), rtol=0.2)
    np.testing.assert_allclose(spread[3:], 0.1, rtol=0.2)
    np.testing.assert_allclose(np.mean(biases, axis=0)[3:], (0.0, 0.0, GRAVITY), atol=0.03)


def test_yaw_follows_a_turn_and_drifts_with_the_gyroscopes_bias() -> None:
    rows = drive("ideal", 0.0, 1.0, 4.0)
    turned = np.cumsum(rows[:, 7]) * PERIOD
    # The filter's tilt step disturbs yaw when the robot starts to move: measured 0.001 rad.
    assert yaw_of(rows[-1]) == pytest.approx(float(wrap_to_pi(turned[-1])), abs=0.005)
    drifting = IMU_PRESETS["drifting"]
    unit = InertialUnit(replace(drifting, gyro_sigma=0.0, accel_bias_sigma=0.0))
    unit.reset(np.random.default_rng(3))
    rows = unit.read(*rest(6000))
    # Correcting the tilt that the other two biases bring takes a little of the third.
    assert yaw_of(rows[-1]) == pytest.approx(60.0 * rows[0, 7], rel=0.05)


def test_a_tilted_unit_finds_its_attitude_from_gravity() -> None:
    up = np.array((-math.sin(0.3), 0.0, math.cos(0.3))) * GRAVITY  # pitched by 0.3 rad
    attitudes = madgwick(
        np.array((1.0, 0.0, 0.0, 0.0)), np.zeros((1000, 3)), np.tile(up, (1000, 1)), 0.01, 0.1
    )
    w, x, y, z = attitudes[-1]
    assert math.asin(2.0 * (w * y - z * x)) == pytest.approx(0.3, abs=0.005)
    assert math.atan2(2.0 * (w * z + x * y), 1.0 - 2.0 * (y * y + z * z)) == pytest.approx(0.0)


@settings(deadline=None, max_examples=30)
@given(
    seed=st.integers(0, 2**32 - 1),
    gain=st.floats(0.0, 0.5),
    lost=st.booleans(),
)
def test_the_filter_equals_a_slow_reference(seed: int, gain: float, lost: bool) -> None:
    rng = np.random.default_rng(seed)
    attitude = rng.standard_normal(4)
    attitude /= np.linalg.norm(attitude)
    rates, forces = rng.standard_normal((20, 3)), rng.standard_normal((20, 3))
    if lost:
        forces[5] = 0.0  # free fall tells no direction
    fast = madgwick(attitude, rates, forces, 0.01, gain)
    np.testing.assert_allclose(fast, slow_madgwick(attitude, rates, forces, 0.01, gain), atol=1e-6)


def slow_madgwick(
    attitude: np.ndarray, rates: np.ndarray, forces: np.ndarray, period: float, gain: float
) -> np.ndarray:
    """The paper's filter with the gradient by finite differences and rotations by MuJoCo."""

    def error(q: np.ndarray, up: np.ndarray) -> float:
        # The paper's form of the matrix, which holds for unit and near-unit quaternions.
        w, x, y, z = q
        expected = np.array((x * z - w * y, w * x + y * z, 0.5 - x * x - y * y)) * 2.0
        return 0.5 * float(np.sum((expected - up) ** 2))

    attitudes, q = [], attitude.copy()
    for rate, force in zip(rates, forces, strict=True):
        change = np.empty(4)
        mujoco.mju_mulQuat(change, q, np.array((0.0, *rate)))
        change *= 0.5
        if np.linalg.norm(force) > 0.0:
            up, step = force / np.linalg.norm(force), 1e-6
            gradient = np.array(
                [
                    (error(q + step * axis, up) - error(q - step * axis, up)) / (2.0 * step)
                    for axis in np.eye(4)
                ]
            )
            change -= gain * gradient / np.linalg.norm(gradient)
        q = q + period * change
        q /= np.linalg.norm(q)
        attitudes.append(q)
    return np.array(attitudes)


def test_readings_stay_within_the_devices_range() -> None:
    unit = InertialUnit(IMU_PRESETS["ideal"])
    unit.reset(np.random.default_rng(0))
    stamps, positions, velocities = rest(2)
    velocities[1, 0] = 9.0  # a kick of 900 m/s2
    positions[1, 3:] = math.cos(0.5), 0.0, 0.0, math.sin(0.5)  # and by a radian within 10 ms
    rows = unit.read(stamps, positions, velocities)
    assert rows[0, 8] == pytest.approx(8.0 * 9.81)
    assert rows[0, 7] == pytest.approx(math.radians(2000.0))


@given(seed=st.integers(0, 2**32 - 1), size=st.floats(0.0, 3.0), is_flipped=st.booleans())
def test_turning_evenly_at_the_mean_rate_leads_to_the_next_attitude(
    seed: int, size: float, is_flipped: bool
) -> None:
    """MuJoCo's own integration of quaternions is the oracle; q and -q are one attitude."""
    rng = np.random.default_rng(seed)
    first, axis = rng.standard_normal(4), rng.standard_normal(3)
    first /= np.linalg.norm(first)
    rate = size / PERIOD * axis / np.linalg.norm(axis)
    second = first.copy()
    mujoco.mju_quatIntegrate(second, rate, PERIOD)
    states = np.zeros((2, 7))
    states[:, 3:] = first, -second if is_flipped else second
    np.testing.assert_allclose(mean_rates(states, PERIOD)[0], rate, atol=1e-6 / PERIOD)


def test_what_the_gyroscope_reads_adds_up_to_the_turn_when_the_robot_changes_gear() -> None:
    """It rocks then, faster than readings come: rates of the moment were 0.2 degrees off."""
    simulation = Simulation(OPEN_FLOOR, lidar="ideal", odometry="truth", imu="ideal", rng=1)
    turned = 0.0
    for k in range(120):
        simulation.command(0.2 if k // 20 % 2 else -0.2, 0.5)
        turned += float(simulation.advance().imu[:, 7].sum()) * PERIOD
    error = wrap_to_pi(turned - float(simulation.pose_world[2]))
    assert abs(math.degrees(float(error))) < 0.01


def test_no_message_is_no_row() -> None:
    unit = InertialUnit(IMU_PRESETS["typical"])
    unit.reset(np.random.default_rng(0))
    assert unit.read(*rest(0)).shape == (0, len(IMU_COLUMNS))


@pytest.mark.parametrize(("field", "value"), [("gyro_sigma", -1.0), ("filter_gain", math.nan)])
def test_figures_that_make_no_sense_are_refused(field: str, value: float) -> None:
    with pytest.raises(TestbedError, match=rf"imu {field}: .*must be"):
        ImuConfig(**{field: value})


def test_disturbing_equals_numpys_sum_and_clip() -> None:
    rng = np.random.default_rng(4)
    true, noise, bias = rng.uniform(-9, 9, (20, 3)), rng.standard_normal((20, 3)), np.ones(3)
    expected = np.clip(true + bias + 0.5 * noise, -8.0, 8.0)
    np.testing.assert_allclose(disturb(true, bias, 0.5, noise, 8.0), expected, rtol=1e-15)
