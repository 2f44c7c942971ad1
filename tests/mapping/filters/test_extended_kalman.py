"""The extended Kalman filter on curved systems: a circle, a landmark, and this project's fusion."""

import math

import numpy as np
import pytest

from mapping.filters import extended_information, extended_kalman
from mapping.filters.gaussian import Gaussian, gaussian, to_gaussian, to_information
from mapping.geometry import between, compose, wrap_to_pi
from mapping.messages import Imu, Odometry, Twist
from mapping.slam import fusion_filter
from mapping.slam.fusion import FusedTrack
from mapping.slam.fusion_kernels import BIAS, STATES, TURN_SCALE, WAY_SCALE, YAW, X, Y
from tests.mapping.filters.systems import Array

LANDMARKS = np.array([[2.0, 1.0], [-1.0, 2.5], [0.5, -2.0]])


def unicycle(way: float, turn: float) -> extended_kalman.Model:
    def move(state: Array) -> tuple[Array, Array]:
        x, y, yaw = state
        heading = yaw + 0.5 * turn
        jacobian = np.eye(3)
        jacobian[:2, 2] = -way * math.sin(heading), way * math.cos(heading)
        moved = [x + way * math.cos(heading), y + way * math.sin(heading), yaw + turn]
        return np.array(moved), jacobian

    return move


def landmark(place: Array) -> extended_kalman.Model:
    def look(state: Array) -> tuple[Array, Array]:
        dx, dy = place - state[:2]
        q = dx * dx + dy * dy
        r = math.sqrt(q)
        expected = np.array([r, math.atan2(dy, dx) - state[2]])
        return expected, np.array([[-dx / r, -dy / r, 0.0], [dy / q, -dx / q, -1.0]])

    return look


def range_bearing_difference(first: Array, second: Array) -> Array:
    return np.array([first[0] - second[0], wrap_to_pi(first[1] - second[1])])


def test_a_robot_on_a_circle_stays_located_by_landmarks() -> None:
    rng = np.random.default_rng(3)
    way, turn, steps = 0.05, 0.04, 400
    motion_noise, sensor_noise = np.diag([1e-4, 1e-4, 2e-5]), np.diag([0.02**2, 0.01**2])
    truth = np.zeros(3)
    belief = gaussian([0.2, -0.2, 0.1], np.diag([0.1, 0.1, 0.03]))
    dual = to_information(belief)
    surprises = []
    for step in range(steps):
        noise = rng.multivariate_normal(np.zeros(3), motion_noise)
        truth = unicycle(way, turn)(truth)[0] + noise
        belief = extended_kalman.predict(belief, unicycle(way, turn), motion_noise)
        dual = extended_information.predict(dual, unicycle(way, turn), motion_noise)
        sensor = landmark(LANDMARKS[step % 3])
        seen = sensor(truth)[0] + rng.multivariate_normal(np.zeros(2), sensor_noise)
        belief = extended_kalman.correct(
            belief, sensor, seen, sensor_noise, difference=range_bearing_difference
        )
        dual = extended_information.correct(
            dual, sensor, seen, sensor_noise, difference=range_bearing_difference
        )
        error = truth - belief.mean
        surprises.append(error @ np.linalg.solve(belief.covariance, error))
    assert to_gaussian(dual).mean == pytest.approx(belief.mean, abs=1e-6)
    assert np.hypot(*(truth - belief.mean)[:2]) < 0.06, "three times its own deviation of 0.02 m"
    # an honest filter of three states has a mean squared distance of 3; 400 dependent samples
    assert 1.5 < np.mean(surprises[20:]) < 4.5


def test_a_measurement_beyond_the_gate_changes_nothing() -> None:
    belief = gaussian([0.0, 0.0, 0.0], 0.01 * np.eye(3))
    sensor = landmark(LANDMARKS[0])
    far_off = sensor(belief.mean)[0] + np.array([1.0, 0.0])
    noise = np.diag([1e-4, 1e-4])
    assert extended_kalman.correct(belief, sensor, far_off, noise, gate=3.0) is belief
    assert extended_kalman.correct(belief, sensor, far_off, noise).mean[0] < -0.5


def test_jacobians_of_the_models_are_their_slopes() -> None:
    state = np.array([0.3, -0.4, 0.7])
    for model in (unicycle(0.3, 0.2), landmark(LANDMARKS[1])):
        value, jacobian = model(state)
        for k in range(3):
            step = np.zeros(3)
            step[k] = 1e-6
            slope = (model(state + step)[0] - model(state - step)[0]) / 2e-6
            assert jacobian[:, k] == pytest.approx(slope, abs=1e-6)
        assert jacobian.shape == (len(value), 3)


def general_move(
    state: Array,
    covariance: Array,
    motion: tuple[float, float, float],
    gains: tuple[float, float],
    variances: tuple[float, float, float, float],
) -> tuple[float, float]:
    """What ``fusion_kernels.move`` does, by the general filter: the model written out anew."""
    ahead, left, turn = motion
    cos, sin = math.cos(state[YAW]), math.sin(state[YAW])
    across, along = cos * ahead - sin * left, sin * ahead + cos * left
    way_variance, turn_variance, place_variance, walk_variance = variances

    def model(at: Array) -> tuple[Array, Array]:
        jacobian = np.eye(STATES)
        jacobian[:2, YAW] = -along, across
        jacobian[:2, WAY_SCALE] = -across, -along
        for place, gain in zip((BIAS, TURN_SCALE), gains, strict=True):
            jacobian[[X, Y, YAW], place] = -0.5 * along * gain, 0.5 * across * gain, gain
        return at + np.array([across, along, turn, 0.0, 0.0, 0.0]), jacobian

    way = math.hypot(across, along)
    direction = np.array([across, along]) / way if way > 0.0 else np.array([cos, sin])
    aside = np.array([-along, across])
    noise = np.zeros((STATES, STATES))
    noise[:2, :2] = way_variance * np.outer(direction, direction) + place_variance * np.eye(2)
    noise[:2, :2] += turn_variance / 3.0 * np.outer(aside, aside)
    noise[:2, YAW] = noise[YAW, :2] = turn_variance / 2.0 * aside
    noise[YAW, YAW], noise[BIAS, BIAS] = turn_variance, walk_variance
    take(state, covariance, extended_kalman.predict(gaussian(state, covariance), model, noise))
    return across, along


def general_correct(
    state: Array,
    covariance: Array,
    innovation: float,
    sensitivity: Array,
    shared: Array,
    variance: float,
    gate: float,
) -> bool:
    """What ``fusion_kernels.correct`` does, by the general filter."""
    prior = gaussian(state, covariance)
    found = extended_kalman.correct(
        prior,
        # the kernel's sensitivity leaves out the states that ``shared`` moves
        lambda at: (np.zeros(1), sensitivity[None, :]),
        np.array([innovation]),
        np.array([[variance]]),
        gate=gate,
        shared=shared[:, None],
    )
    take(state, covariance, found)
    return found is not prior


def take(state: Array, covariance: Array, belief: Gaussian) -> None:
    state[:], covariance[:] = belief.mean, belief.covariance


def drive_with_gyro() -> tuple[list[Odometry], list[Imu]]:
    """A rest, a curve and a spin, with a biased gyroscope and wheels that turn 1 % too far."""
    rng = np.random.default_rng(5)
    odometry, imu = [], []
    pose, stamp = np.zeros(3), 0.0
    for k in range(600):
        stamp = 0.01 * (k + 1)
        speed, rate = (0.0, 0.0) if k < 150 else (0.2, 0.4) if k < 400 else (0.0, 1.5)
        imu.append(
            Imu(
                stamp=stamp,
                orientation=np.array([0.0, 0.0, 0.0, 1.0]),
                angular_velocity=np.array([0.0, 0.0, rate + 2e-4 + 2e-4 * rng.standard_normal()]),
                linear_acceleration=np.array([0.0, 0.0, 9.81]),
            )
        )
        noise = 1e-5 * rng.standard_normal() if rate else 0.0
        pose = compose(pose, np.array([0.01 * speed, 0.0, 0.01 * 1.01 * rate + noise]))
        if k % 3 == 2:
            twist = Twist(linear_x=speed, angular_z=rate)
            odometry.append(Odometry(stamp=stamp, pose_odom=pose, twist=twist))
    return odometry, imu


def test_the_fusion_of_odometry_and_gyroscope_is_this_filter(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """The kernels that fuse in the mappers give the track of the general filter."""
    odometry, imu = drive_with_gyro()
    fused = FusedTrack()
    fused.add(odometry, imu)
    monkeypatch.setattr(fusion_filter, "move", general_move)
    monkeypatch.setattr(fusion_filter, "correct", general_correct)
    general = FusedTrack()
    general.add(odometry, imu)
    assert fused.newest is not None
    assert general.newest is not None
    assert between(fused.newest, general.newest) == pytest.approx(np.zeros(3), abs=1e-9)
    assert general.gyro_bias == pytest.approx(fused.gyro_bias, rel=1e-6)
    assert general.motion_covariance() == pytest.approx(fused.motion_covariance(), rel=1e-6)
    assert abs(fused.gyro_bias[0] - 2e-4) < 1e-4, "it was learned, or the test tests nothing"
