"""Rooms of straight walls, the scans that a lidar takes in them, and drives through them.

Walls are segments ``(n, 4)``: x and y of one end, then of the other [m].
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from mapping.burger import LIDAR_POSE_BASE, LIDAR_RANGE_MAX
from mapping.geometry import Pose, compose, transform_points
from mapping.mapper import Mapper
from mapping.messages import LaserScan, Odometry, Twist
from mapping.sensor_model import LDS_01, range_sigma, read_beams
from mapping.slam.scan_cloud import ScanCloud, make_cloud

Walls = NDArray[np.float64]
Period = tuple[LaserScan | None, list[Odometry]]

TICK = 1.0 / 30.0
"""Time between odometry messages [s]."""

TICKS_A_SCAN = 6
"""A scan takes 0.2 s."""

SPEED, TURN_RATE = 0.2, 1.0
"""How fast the robot drives [m/s], or turns on the spot [rad/s]."""


def outline(corners: ArrayLike) -> Walls:
    """The walls of a closed polygon with corners ``(n, 2)``."""
    corners = np.asarray(corners, dtype=np.float64)
    return np.hstack((corners, np.roll(corners, -1, axis=0)))


def box(left: float, right: float, bottom: float, top: float) -> Walls:
    return outline([(left, bottom), (right, bottom), (right, top), (left, top)])


def post(x: float, y: float, radius: float, corners: int = 12) -> Walls:
    angles = np.arange(corners) * 2.0 * np.pi / corners
    return outline(np.column_stack((x + radius * np.cos(angles), y + radius * np.sin(angles))))


def corridor(half_length: float = 50.0, half_width: float = 0.8) -> Walls:
    """Two parallel walls along x, and nothing else in sight."""
    return np.array(
        [
            (-half_length, -half_width, half_length, -half_width),
            (-half_length, half_width, half_length, half_width),
        ]
    )


def random_room(rng: np.random.Generator) -> Walls:
    """A room of four crooked walls around the origin, turned at random, with posts and boxes.

    Nothing stands within 0.6 m of the origin.
    """
    half = rng.uniform(1.4, 2.6, 2)
    corners = half * [(-1, -1), (1, -1), (1, 1), (-1, 1)] * rng.uniform(0.8, 1.1, (4, 2))
    walls = [outline(corners)]
    for _ in range(3):
        angle, away = rng.uniform(-np.pi, np.pi), rng.uniform(0.9, 1.2)
        x, y = away * np.cos(angle), away * np.sin(angle)
        walls.append(post(x, y, float(rng.uniform(0.08, 0.25)), int(rng.choice([4, 12]))))
    yaw = np.array([0.0, 0.0, rng.uniform(-np.pi, np.pi)])
    return transform_points(yaw, np.concatenate(walls).reshape(-1, 2)).reshape(-1, 4)


def ring() -> Walls:
    """A corridor 1.2 m wide around a block of 4.6 x 2.6 m, with pillars, a niche and a locker."""
    return np.concatenate(
        (
            outline(
                [(-3.5, -2.5), (1.0, -2.5), (1.0, -2.9), (1.9, -2.9), (1.9, -2.5), (3.5, -2.5)]
                + [(3.5, 2.5), (0.4, 2.5), (0.4, 2.25), (-0.4, 2.25), (-0.4, 2.5), (-3.5, 2.5)]
            ),
            box(-2.3, 2.3, -1.3, 1.3),
            post(-1.2, -2.3, 0.1),
            post(3.25, 0.6, 0.12),
            post(-3.2, -0.9, 0.15, 4),
            post(1.7, 1.5, 0.1, 4),
        )
    )


def long_ring() -> Walls:
    """A bare corridor 1.2 m wide around a block of 9.6 x 3.6 m, with one pillar.

    In its long sides a lidar that sees 3.5 m far finds nothing to tell how far it has come.
    """
    return np.concatenate(
        (box(-6.0, 6.0, -3.0, 3.0), box(-4.8, 4.8, -1.8, 1.8), post(-5.7, 0.4, 0.12))
    )


LONG_RING_WAY = [(-5.4, -2.4), (5.4, -2.4), (5.4, 2.4), (-5.4, 2.4), (-5.4, -2.4)]
"""Once around the long ring."""

RING_WAY = [(-2.9, -1.9), (2.9, -1.9), (2.9, 1.9), (-2.9, 1.9), (-2.9, -1.9)]
"""Once around the ring, in the middle of its corridor."""


def distances(walls: Walls, lidars: Pose, angles: NDArray[np.float64]) -> NDArray[np.float64]:
    """How far each beam goes ``(n,)`` [m] from a lidar ``(n, 3)`` at an angle ``(n,)``."""
    heading = lidars[:, 2] + angles
    ray_x, ray_y = np.cos(heading)[:, None], np.sin(heading)[:, None]
    wall_x, wall_y = walls[:, 2] - walls[:, 0], walls[:, 3] - walls[:, 1]
    to_x, to_y = walls[:, 0] - lidars[:, :1], walls[:, 1] - lidars[:, 1:2]
    with np.errstate(divide="ignore", invalid="ignore"):
        det = ray_x * wall_y - ray_y * wall_x
        along = (to_x * wall_y - to_y * wall_x) / det
        share = (to_x * ray_y - to_y * ray_x) / det
        meets = (along > 0.0) & (share >= 0.0) & (share <= 1.0)
    return np.where(meets, along, np.inf).min(axis=1)


def scan_of(
    walls: Walls,
    poses: Pose,
    rng: np.random.Generator | None = None,
    scan: LaserScan | None = None,
    lidar_pose_base: tuple[float, float, float] = LIDAR_POSE_BASE,
) -> LaserScan:
    """The scan by a robot at poses, one ``(3,)`` or one a beam; noisy with a generator."""
    scan = scan or LaserScan(stamp=0.0, ranges=np.zeros(360, dtype=np.float32))
    poses = np.broadcast_to(poses, (len(scan.ranges), 3))
    ranges = distances(walls, compose(poses, lidar_pose_base), scan.angles)
    near = np.minimum(ranges, scan.range_max)
    if rng is not None:
        ranges = ranges + rng.normal(0.0, range_sigma(near))
    ranges[ranges > LIDAR_RANGE_MAX] = np.inf
    return replace(scan, ranges=ranges.astype(np.float32))


def cloud_of(scan: LaserScan, resolution: float = 0.05) -> ScanCloud:
    """The cloud of a scan by a robot that stood still."""
    beams = read_beams(scan, LIDAR_RANGE_MAX)
    return make_cloud(
        scan,
        beams,
        np.zeros((len(beams.indices), 3)),
        lidar_pose_base=LIDAR_POSE_BASE,
        range_noise=LDS_01,
        resolution=resolution,
        reach=LIDAR_RANGE_MAX,
    )


@dataclass(frozen=True, kw_only=True)
class Run:
    """A drive through a room: what a mapper is given, and where the robot really was."""

    periods: list[Period]
    truth: Pose
    """True poses at the stamps of the scans, in the map frame."""
    start: Pose
    """True pose when the odometry started."""
    odometry_end: Pose
    """Where odometry alone puts the robot at the last scan, in the map frame."""


def along(way: Sequence[tuple[float, float]]) -> tuple[Pose, NDArray[np.float64]]:
    """Start pose, and speeds ``(n, 2)`` one a tick, of a drive from point to point."""
    points = np.asarray(way, dtype=np.float64)
    legs = np.diff(points, axis=0)
    headings = np.arctan2(legs[:, 1], legs[:, 0])
    speeds = [np.zeros((TICKS_A_SCAN, 2))]
    for i, leg in enumerate(legs):
        turn = 0.0 if i == 0 else float(np.angle(np.exp(1j * (headings[i] - headings[i - 1]))))
        for size, column, top in ((turn, 1, TURN_RATE), (float(np.hypot(*leg)), 0, SPEED)):
            ticks = int(np.ceil(abs(size) / top / TICK))
            piece = np.zeros((ticks, 2))
            piece[:, column] = size / max(ticks, 1) / TICK
            speeds.append(piece)
    return np.array([*points[0], headings[0]]), np.concatenate(speeds)


def travelled(speeds: NDArray[np.float64]) -> Pose:
    """Poses ``(n + 1, 3)`` at the ticks, from the origin; straight along the middle heading."""
    steps = speeds * TICK
    yaws = np.concatenate(([0.0], np.cumsum(steps[:, 1])))
    middle = yaws[:-1] + 0.5 * steps[:, 1]
    moves = steps[:, :1] * np.column_stack((np.cos(middle), np.sin(middle)))
    places = np.vstack((np.zeros((1, 2)), np.cumsum(moves, axis=0)))
    return np.column_stack((places, yaws))


def drive(
    walls: Walls,
    way: Sequence[tuple[float, float]],
    rng: np.random.Generator,
    *,
    scale: float = 0.0,
    drift: float = 0.0,
    noise: float = 0.02,
    rolls: bool = True,
) -> Run:
    """Drive from point to point with a noisy lidar and odometry that errs.

    Args:
        walls: The room.
        way: Points to go to, from the first [m].
        rng: For the noise.
        scale: Relative error of the odometry's way.
        drift: Its turn in each metre of way [rad/m].
        noise: Random relative error of the speeds in each tick.
        rolls: Whether beams are shot one after the other; else all at once.
    """
    start, speeds = along(way)
    told = speeds * (1.0 + rng.normal(0.0, noise, speeds.shape))
    told[:, 0] *= 1.0 + scale
    told[:, 1] += drift * told[:, 0]
    true, odometry = travelled(speeds), travelled(told)
    periods: list[Period] = []
    firsts = range(0, len(speeds) - TICKS_A_SCAN, TICKS_A_SCAN)
    for first in firsts:
        ticks = np.arange(first, first + TICKS_A_SCAN + 1)
        scan = LaserScan(stamp=first * TICK, ranges=np.zeros(360, dtype=np.float32))
        if not rolls:
            scan = replace(scan, time_increment=0.0)
        poses = [np.interp(scan.beam_stamps, ticks * TICK, true[ticks, k]) for k in range(3)]
        scan = scan_of(walls, compose(start, np.column_stack(poses)), rng, scan)
        messages = [message(k, odometry[k], told[k]) for k in (ticks if first == 0 else ticks[1:])]
        periods.append((scan, messages))
    return Run(
        periods=periods,
        truth=compose(start, true[list(firsts)]),
        start=start,
        odometry_end=compose(start, odometry[firsts[-1]]),
    )


def message(tick: int, pose: Pose, speed: NDArray[np.float64]) -> Odometry:
    twist = Twist(linear_x=float(speed[0]), angular_z=float(speed[1]))
    return Odometry(stamp=tick * TICK, pose_odom=pose, twist=twist)


def mirrored(periods: Sequence[Period]) -> list[Period]:
    """The same drive in the world that is mirrored about the odometry's x axis."""
    flip = np.array([1.0, -1.0, -1.0])
    return [
        (
            scan
            and replace(scan, angle_min=-scan.angle_min, angle_increment=-scan.angle_increment),
            [
                replace(
                    each,
                    pose_odom=each.pose_odom * flip,
                    twist=Twist(linear_x=each.twist.linear_x, angular_z=-each.twist.angular_z),
                )
                for each in odometry
            ],
        )
        for scan, odometry in periods
    ]


def fed(mapper: Mapper, periods: Sequence[Period]) -> Mapper:
    """The mapper, after it was given every period."""
    for scan, odometry in periods:
        mapper.update(scan, odometry)
    return mapper
