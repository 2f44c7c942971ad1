"""Random furnished rooms, and drives through them that touch nothing."""

import numpy as np

from mapping.geometry import Pose
from nav.motion_limits import MotionLimits
from tests.nav.scans import PERIOD, Room, box

LIMITS = MotionLimits()


def furnished_room(rng: np.random.Generator) -> tuple[Room, tuple[float, float]]:
    """A room and its width and depth [m]: often a wall with a door, boxes, chairs, round posts.

    Chairs have four legs of 3 cm or more, as in the world cluttered_office.
    """
    width, depth = rng.uniform(3.0, 6.5, 2)
    walls = [box(0.0, 0.0, width, depth)]
    if rng.random() < 0.7:
        x, gap = rng.uniform(0.35, 0.65) * width, rng.uniform(0.6, 1.0)
        door = rng.uniform(0.3, depth - gap - 0.3)
        walls += [box(x, 0.0, 0.1, door), box(x, door + gap, 0.1, depth - door - gap)]
    for _ in range(rng.integers(1, 5)):
        x, y = rng.uniform(0.0, (width - 0.5, depth - 0.5))
        walls.append(box(x, y, *rng.uniform(0.1, 0.6, 2)))
    posts = [[*rng.uniform(0.3, (width - 0.3, depth - 0.3)), 0.1] for _ in range(2)]
    for _ in range(rng.integers(1, 5)):
        seat, turned = rng.uniform(0.4, (width - 0.4, depth - 0.4)), rng.uniform(0.0, np.pi)
        out, radius = rng.uniform(0.23, 0.35), rng.uniform(0.015, 0.03)
        for corner in turned + np.arange(4) * np.pi / 2.0:
            posts.append([*(seat + out * np.array([np.cos(corner), np.sin(corner)])), radius])
    return Room(walls=np.concatenate(walls), posts=np.array(posts)), (width, depth)


def drive_through(
    room: Room, size: tuple[float, float], seconds: float, rng: np.random.Generator
) -> Pose:
    """Poses ``(n, 3)``, one a control period, of a robot that drives and turns at its limits."""
    place = rng.uniform(0.2, np.array(size) - 0.2)
    while room.clearance(place) < 0.25:
        place = rng.uniform(0.2, np.array(size) - 0.2)
    pose = np.array([*place, rng.uniform(-np.pi, np.pi)])
    poses = [pose]
    speed = rate = 0.0
    for k in range(round(seconds / PERIOD)):
        if k % 15 == 0:
            wanted_speed = rng.choice([1.0, 1.0, 0.5, 0.0]) * LIMITS.max_linear
            wanted_rate = rng.choice([0.0, 0.4, -0.4, 1.0, -1.0]) * LIMITS.max_angular
        ahead = np.array([np.cos(pose[2]), np.sin(pose[2])])
        if room.clearance(pose[:2] + 0.08 * ahead) < 0.16:
            speed, wanted_rate = 0.0, LIMITS.max_angular * (1.0 if wanted_rate >= 0.0 else -1.0)
        else:
            speed = min(wanted_speed, speed + LIMITS.linear_acceleration * PERIOD)
        most = LIMITS.angular_acceleration * PERIOD
        rate += float(np.clip(wanted_rate - rate, -most, most))
        heading = pose[2] + 0.5 * PERIOD * rate
        way = PERIOD * speed * np.array([np.cos(heading), np.sin(heading)])
        pose = np.array([*(pose[:2] + way), pose[2] + PERIOD * rate])
        poses.append(pose)
    return np.array(poses)
