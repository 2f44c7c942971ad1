"""Walkers for the navigation tests, and where and how fast the robot first touches one."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mapping.geometry import Pose
from mapping.messages import Twist
from nav.movers import Mover
from nav.outline import BURGER_OUTLINE
from nav.safety_kernels import outline_distance

LEG_RADIUS = 0.06
HALF_HIP = 0.10
WALK_RATIO = 0.0065
"""Length of a step over steps a minute [m min] (Sekiya and Nagasaki 1998)."""
KNOWN_WELL = 10
"""Sightings of one that has been watched for 2 s."""


@dataclass
class Walker:
    """Someone who walks straight on for ever on two legs, stopping for nothing."""

    start: NDArray[np.float64]
    heading: float
    speed: float
    phase: float = 0.0

    @property
    def along(self) -> NDArray[np.float64]:
        return np.array([math.cos(self.heading), math.sin(self.heading)])

    def middle(self, time: float) -> NDArray[np.float64]:
        return np.asarray(self.start + self.speed * time * self.along)

    def feet(self, time: float) -> NDArray[np.float64]:
        """Both legs ``(2, 2)`` [m]: one stands while the other swings two steps ahead."""
        step = math.sqrt(60.0 * WALK_RATIO * self.speed)
        aside = HALF_HIP * np.array([-self.along[1], self.along[0]])
        feet = []
        for foot in (0, 1):
            steps = time * self.speed / step + self.phase + foot
            swing = min(max(steps % 2.0 - 1.0, 0.0), 1.0)
            taken = 2.0 * (steps // 2.0 + swing**2 * (3.0 - 2.0 * swing)) + 0.5 - self.phase - foot
            feet.append(self.start + taken * step * self.along + (1 - 2 * foot) * aside)
        return np.array(feet)

    def as_mover(self, time: float) -> Mover:
        """What perfect knowledge has of it."""
        return Mover(
            place=self.middle(time),
            velocity=self.speed * self.along,
            stamp=time,
            sightings=KNOWN_WELL,
        )


def random_walker(rng: np.random.Generator) -> Walker:
    """Someone who comes past the origin within a metre, from 2 to 5 m away."""
    angle, away = rng.uniform(-math.pi, math.pi), rng.uniform(2.0, 5.0)
    aim = rng.uniform(-0.8, 0.8, 2)
    return Walker(
        start=aim - away * np.array([math.cos(angle), math.sin(angle)]),
        heading=angle,
        speed=rng.uniform(0.5, 1.2),
        phase=rng.random(),
    )


def moved(pose: Pose, twist: Twist, time: float) -> Pose:
    """The pose after driving a twist for a short time [s]."""
    heading = pose[2] + 0.5 * twist.angular_z * time
    way = twist.linear_x * time
    return np.asarray(
        pose + (way * math.cos(heading), way * math.sin(heading), twist.angular_z * time)
    )


def speed_at_touch(pose: Pose, twist: Twist, foot: NDArray[np.float64]) -> float | None:
    """How fast the robot moves towards a leg that it touches [m/s]; None if it touches it not."""
    if math.dist(foot, pose[:2]) > 0.25:
        return None
    gap = outline_distance(foot[None], *pose, BURGER_OUTLINE)
    if gap >= LEG_RADIUS:
        return None
    tiny = 1e-5
    slope = [
        outline_distance((foot + each)[None], *pose, BURGER_OUTLINE) - gap
        for each in ((tiny, 0.0), (0.0, tiny))
    ]
    towards = np.array(slope) / np.hypot(*slope) if gap > 0.0 else foot - pose[:2]
    arm = foot - gap * towards - pose[:2]
    ahead = np.array([math.cos(pose[2]), math.sin(pose[2])])
    velocity = twist.linear_x * ahead + twist.angular_z * np.array([-arm[1], arm[0]])
    return float(velocity @ towards / np.hypot(*towards))
