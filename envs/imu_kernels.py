"""Numba kernels of the IMU: what its gyroscope and accelerometer feel, and its attitude filter."""

import math

import numpy as np
from numba import njit
from numpy.typing import NDArray

from envs.quaternion import Quaternion, Vector, mean_attitude, rotate, rotate_back

GRAVITY = 9.81
"""Acceleration of free fall [m/s2], as MuJoCo's default has it."""


@njit(cache=True)
def specific_forces(
    positions: NDArray[np.float64],
    velocities: NDArray[np.float64],
    offset: NDArray[np.float64],
    period: float,
) -> NDArray[np.float64]:
    """Mean acceleration less gravity between states ``(n, 3)`` [m/s2], in the sensor's axes.

    Args:
        positions: Position and quaternion (w, x, y, z) of base_link ``(n + 1, 7)`` in the world.
        velocities: Linear velocity in the world and angular in base_link ``(n + 1, 6)``.
        offset: The sensor in base_link ``(3,)`` [m]; its axes are base_link's.
        period: Time between states [s].
    """
    forces = np.empty((len(positions) - 1, 3))
    mount = (offset[0], offset[1], offset[2])
    attitude, before = _sensor_state(positions[0], velocities[0], mount)
    for i in range(len(forces)):
        next_attitude, after = _sensor_state(positions[i + 1], velocities[i + 1], mount)
        gained = (
            (after[0] - before[0]) / period,
            (after[1] - before[1]) / period,
            (after[2] - before[2]) / period + GRAVITY,
        )
        halfway = mean_attitude(attitude, next_attitude, 0.5)
        forces[i, 0], forces[i, 1], forces[i, 2] = rotate_back(halfway, gained)
        attitude, before = next_attitude, after
    return forces


@njit(cache=True)
def mean_rates(positions: NDArray[np.float64], period: float) -> NDArray[np.float64]:
    """Mean angular velocity between states ``(n, 3)`` [rad/s], in the sensor's axes.

    Turning evenly at such a rate leads from one attitude to the next: the rates add up to the
    turns, whatever shook the sensor between two states.

    Args:
        positions: Position and quaternion (w, x, y, z) of base_link ``(n + 1, 7)`` in the world.
        period: Time between states [s].
    """
    rates = np.empty((len(positions) - 1, 3))
    for i in range(len(rates)):
        a, b, c, d = positions[i, 3], positions[i, 4], positions[i, 5], positions[i, 6]
        w, x, y, z = (
            positions[i + 1, 3],
            positions[i + 1, 4],
            positions[i + 1, 5],
            positions[i + 1, 6],
        )
        cos = a * w + b * x + c * y + d * z
        p = a * x - b * w - c * z + d * y
        q = a * y + b * z - c * w - d * x
        r = a * z - b * y + c * x - d * w
        sin = math.sqrt(p * p + q * q + r * r)
        if cos < 0.0:  # the same turn, by the shorter way
            cos, p, q, r = -cos, -p, -q, -r
        share = 2.0 * math.atan2(sin, cos) / sin if sin > 0.0 else 2.0
        rates[i, 0], rates[i, 1], rates[i, 2] = (
            share * p / period,
            share * q / period,
            share * r / period,
        )
    return rates


@njit(cache=True)
def disturb(
    true: NDArray[np.float64],
    bias: NDArray[np.float64],
    sigma: float,
    noise: NDArray[np.float64],
    limit: float,
) -> NDArray[np.float64]:
    """What a sensor of three axes makes of true values ``(n, 3)``: biased, noisy, clipped.

    Args:
        true: True values ``(n, 3)``.
        bias: Constant error of each axis ``(3,)``.
        sigma: Standard deviation of the noise.
        noise: Standard normal numbers ``(n, 3)``.
        limit: Largest value that the sensor reports.
    """
    measured = np.empty(true.shape)
    for i in range(len(true)):
        for axis in range(3):
            value = true[i, axis] + bias[axis] + sigma * noise[i, axis]
            measured[i, axis] = min(max(value, -limit), limit)
    return measured


@njit(cache=True)
def madgwick(
    attitude: NDArray[np.float64],
    rates: NDArray[np.float64],
    forces: NDArray[np.float64],
    period: float,
    gain: float,
) -> NDArray[np.float64]:
    """Attitudes ``(n, 4)`` as quaternions w, x, y, z after each sample, sensor to world.

    S. Madgwick, An efficient orientation filter for inertial and inertial/magnetic sensor arrays
    (2010), equations 11-13, 25, 26, 31-33: the gyroscope's rate, less a step of fixed length down
    the gradient of the squared error between measured and expected gravity. No magnetometer.

    Args:
        attitude: Quaternion before the first sample ``(4,)``.
        rates: Angular velocity ``(n, 3)`` [rad/s].
        forces: Specific force ``(n, 3)``; only its direction counts.
        period: Time between samples [s].
        gain: Length of the correcting step, the paper's beta [1/s].
    """
    attitudes = np.empty((len(rates), 4))
    w, x, y, z = attitude[0], attitude[1], attitude[2], attitude[3]
    for i in range(len(rates)):
        p, q, r = rates[i, 0], rates[i, 1], rates[i, 2]
        down_w, down_x, down_y, down_z = _tilt_gradient(
            (w, x, y, z), (forces[i, 0], forces[i, 1], forces[i, 2])
        )
        w, x, y, z = (
            w + period * (0.5 * (-x * p - y * q - z * r) - gain * down_w),
            x + period * (0.5 * (w * p + y * r - z * q) - gain * down_x),
            y + period * (0.5 * (w * q - x * r + z * p) - gain * down_y),
            z + period * (0.5 * (w * r + x * q - y * p) - gain * down_z),
        )
        scale = 1.0 / math.sqrt(w * w + x * x + y * y + z * z)
        w, x, y, z = scale * w, scale * x, scale * y, scale * z
        attitudes[i, 0], attitudes[i, 1], attitudes[i, 2], attitudes[i, 3] = w, x, y, z
    return attitudes


@njit(cache=True)
def _tilt_gradient(attitude: Quaternion, force: Vector) -> Quaternion:
    """Unit gradient (equations 25, 26) of the error in the direction of up; 0 without error."""
    w, x, y, z = attitude
    norm = math.sqrt(force[0] ** 2 + force[1] ** 2 + force[2] ** 2)
    if norm == 0.0:
        return 0.0, 0.0, 0.0, 0.0
    error_x = 2.0 * (x * z - w * y) - force[0] / norm
    error_y = 2.0 * (w * x + y * z) - force[1] / norm
    error_z = 1.0 - 2.0 * (x * x + y * y) - force[2] / norm
    along_w = -2.0 * y * error_x + 2.0 * x * error_y
    along_x = 2.0 * z * error_x + 2.0 * w * error_y - 4.0 * x * error_z
    along_y = -2.0 * w * error_x + 2.0 * z * error_y - 4.0 * y * error_z
    along_z = 2.0 * x * error_x + 2.0 * y * error_y
    length = math.sqrt(along_w**2 + along_x**2 + along_y**2 + along_z**2)
    if length == 0.0:
        return 0.0, 0.0, 0.0, 0.0
    return along_w / length, along_x / length, along_y / length, along_z / length


@njit(cache=True)
def _sensor_state(
    position: NDArray[np.float64], velocity: NDArray[np.float64], mount: Vector
) -> tuple[Quaternion, Vector]:
    """Attitude of base_link, and velocity in the world of a point mounted on it."""
    attitude = (position[3], position[4], position[5], position[6])
    p, q, r = velocity[3], velocity[4], velocity[5]
    a, b, c = mount
    swing = rotate(attitude, (q * c - r * b, r * a - p * c, p * b - q * a))
    return attitude, (velocity[0] + swing[0], velocity[1] + swing[1], velocity[2] + swing[2])
