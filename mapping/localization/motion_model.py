"""Turns a motion that odometry reports into where the robot may be after it.

The odometry motion model (Probabilistic Robotics 5.4): a turn, a straight way and another turn,
each with an error that grows with all three.
"""

import math
from dataclasses import dataclass, fields

import numpy as np

from mapping.errors import TestbedError
from mapping.geometry import Pose, wrap_to_pi

SHORTEST_WAY = 0.01
"""A shorter way [m] has no direction that noise would not turn: it is then one turn only."""


@dataclass(frozen=True, slots=True, kw_only=True)
class MotionNoise:
    """The four figures of the book, and a floor.

    They are several times larger than a Burger's odometry errs (``FusionConfig``): particles must
    also spread over what the map and the sensor model leave open.
    """

    turn_per_turn: float = 0.05
    """alpha_1 [rad/rad]."""
    turn_per_way: float = 0.05
    """alpha_2 [rad/m]."""
    way_per_way: float = 0.05
    """alpha_3 [m/m]."""
    way_per_turn: float = 0.02
    """alpha_4 [m/rad]."""
    shift_floor: float = 0.005
    """Standard deviation of the place after any motion [m]."""
    turn_floor: float = 0.005
    """Standard deviation of the heading after any motion [rad]."""

    def __post_init__(self) -> None:
        """Refuse figures that are no errors."""
        for field in fields(self):
            value = getattr(self, field.name)
            if not (math.isfinite(value) and value >= 0.0):
                raise TestbedError(f"motion {field.name}: {value}; must be finite and 0 or more")


def decomposed(motion: Pose) -> tuple[float, float, float]:
    """First turn [rad], way [m], second turn [rad] of a motion ``(3,)`` (table 5.6, lines 2 to 4).

    Backing up is a negative way, not half a turn before and after.
    """
    x, y, yaw = motion.tolist()
    way = math.hypot(x, y)
    if way < SHORTEST_WAY:
        return 0.0, x, yaw
    first = math.atan2(y, x)
    if abs(first) > 0.5 * math.pi:
        first, way = math.remainder(first + math.pi, 2.0 * math.pi), -way
    return first, way, math.remainder(yaw - first, 2.0 * math.pi)


def sample_motion(poses: Pose, motion: Pose, noise: MotionNoise, rng: np.random.Generator) -> Pose:
    """One sample for each pose of where the robot may be after a motion (table 5.6).

    Args:
        poses: Where it may have been ``(n, 3)``.
        motion: The new pose in the frame of the old one, as odometry has it ``(3,)``.
        noise: How far odometry errs.
        rng: Source of the noise.
    """
    first, way, second = decomposed(motion)
    turned = abs(first) + abs(second)
    normals = rng.standard_normal((5, len(poses)))
    per_turn, per_way = noise.turn_per_turn, noise.turn_per_way
    firsts = first + math.hypot(per_turn * first, per_way * way) * normals[0]
    ways = way + math.hypot(noise.way_per_way * way, noise.way_per_turn * turned) * normals[1]
    seconds = second + (math.hypot(per_turn * second, per_way * way, noise.turn_floor) * normals[2])
    headings = poses[:, 2] + firsts
    moved = np.empty_like(poses)
    moved[:, 0] = poses[:, 0] + ways * np.cos(headings) + noise.shift_floor * normals[3]
    moved[:, 1] = poses[:, 1] + ways * np.sin(headings) + noise.shift_floor * normals[4]
    moved[:, 2] = wrap_to_pi(headings + seconds)
    return moved
