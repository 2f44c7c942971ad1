"""Drives a Burger on paper: exact poses, and what its encoders and IMU would say of them."""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.signal import lfilter

from envs.burger_constants import CONTACT_CREEP, IMU_POSITION, WHEEL_RADIUS, WHEEL_SEPARATION
from envs.imu import IMU_PRESETS, InertialUnit, yaw_of
from envs.wheel_encoders import ODOMETRY_PRESETS, WheelEncoders, YawSource
from mapping.geometry import Pose
from mapping.messages import Imu, Odometry, Twist

PERIOD = 0.01
"""Time between IMU messages [s]."""

ODOMETRY_EVERY = 3
"""IMU periods between odometry messages: 33 Hz for the robot's 30, so that stamps coincide."""


@dataclass(frozen=True, kw_only=True)
class Drive:
    """A drive: truth and messages; ``poses[k]`` is the true pose at ``odometry[k].stamp``."""

    odometry: list[Odometry]
    imu: list[Imu]
    poses: Pose
    gyro_bias: float


def patrol(rng: np.random.Generator, metres: float) -> NDArray[np.float64]:
    """Speeds ``(n, 2)`` 10 ms apart: a second's rest, then straights, curves, spins and rests."""
    pieces: list[tuple[float, float, float]] = [(1.5, 0.0, 0.0)]
    driven = 0.0
    while driven < metres:
        way = float(rng.uniform(0.5, 3.0))
        curve = float(rng.choice([0.0, 0.0, rng.uniform(-0.3, 0.3)]))
        pieces.append((way / 0.2, 0.2, curve))
        angle = float(rng.uniform(-np.pi, np.pi))
        pieces.append((abs(angle) / 1.0, 0.0, float(np.copysign(1.0, angle))))
        if rng.random() < 0.2:
            pieces.append((1.0, 0.0, 0.0))
        driven += way
    wanted = np.concatenate(
        [np.full((round(seconds / PERIOD), 2), (v, w)) for seconds, v, w in pieces]
    )
    return smooth(wanted)


def smooth(wanted: NDArray[np.float64], lag: float = 0.05) -> NDArray[np.float64]:
    """Speeds that follow the wanted ones as the motors do, a first-order lag behind."""
    share = PERIOD / lag
    speeds = np.asarray(lfilter([share], [1.0, share - 1.0], wanted, axis=0))
    speeds[np.abs(speeds) < 1e-6] = 0.0  # tyres come to rest, exponentials never
    return speeds


def drive(
    speeds: NDArray[np.float64],
    rng: np.random.Generator,
    *,
    odometry: str = "typical",
    imu: str = "typical",
    yaw: YawSource = "encoders",
) -> Drive:
    """What a Burger's sensors say while it drives at these speeds ``(n, 2)``, 10 ms apart.

    Between two moments the speeds change evenly, as the trapezoidal rule has it, and the place
    moves along the heading of the middle.
    """
    means = 0.5 * (speeds[1:] + speeds[:-1]) * PERIOD
    yaws = np.concatenate(([0.0], np.cumsum(means[:, 1])))
    middles = yaws[:-1] + 0.5 * means[:, 1]
    places = np.cumsum(means[:, :1] * np.column_stack((np.cos(middles), np.sin(middles))), axis=0)
    poses = np.column_stack((np.vstack((np.zeros((1, 2)), places)), yaws))
    unit = InertialUnit(IMU_PRESETS[imu])
    unit.reset(rng)
    stamps = np.arange(1, len(speeds)) * PERIOD
    rows = unit.read(stamps, *_body(poses, speeds))
    encoders = WheelEncoders(replace(ODOMETRY_PRESETS[odometry], yaw_source=yaw))
    encoders.reset(rng, (0.0, 0.0), poses[0])
    half_base = 0.5 * WHEEL_SEPARATION
    ways = np.cumsum(means @ np.array([[1.0, 1.0], [-half_base, half_base]]), axis=0)
    angles = ways / ((1.0 - CONTACT_CREEP) * WHEEL_RADIUS)
    messages, truths = [], []
    for k in range(ODOMETRY_EVERY, len(stamps), ODOMETRY_EVERY):
        stamp, x, y, heading, v, w = encoders.read(
            float(stamps[k]), (float(angles[k, 0]), float(angles[k, 1])), yaw_of(rows[k])
        )
        twist = Twist(linear_x=v, angular_z=w)
        messages.append(Odometry(stamp=stamp, pose_odom=np.array([x, y, heading]), twist=twist))
        truths.append(poses[k + 1])
    return Drive(
        odometry=messages,
        imu=[imu_message(row) for row in rows],
        poses=np.array(truths),
        gyro_bias=float(unit._gyro_bias[2]),
    )


def imu_message(row: NDArray[np.float64]) -> Imu:
    return Imu(
        stamp=float(row[0]),
        orientation=row[1:5],
        angular_velocity=row[5:8],
        linear_acceleration=row[8:11],
    )


def _body(
    poses: Pose, speeds: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Positions ``(n, 7)`` and velocities ``(n, 6)`` of base_link, as ``InertialUnit`` wants."""
    count = len(poses)
    positions, velocities = np.zeros((count, 7)), np.zeros((count, 6))
    positions[:, :2], positions[:, 2] = poses[:, :2], IMU_POSITION[2]
    positions[:, 3], positions[:, 6] = np.cos(poses[:, 2] / 2), np.sin(poses[:, 2] / 2)
    velocities[:, 0] = speeds[:, 0] * np.cos(poses[:, 2])
    velocities[:, 1] = speeds[:, 0] * np.sin(poses[:, 2])
    velocities[:, 5] = speeds[:, 1]
    return positions, velocities
