"""Turns odometry that may jump, when its driver restarts, into odometry that goes on smoothly."""

from collections.abc import Iterator, Sequence
from dataclasses import replace
from math import pi

import numpy as np

from mapping.geometry import Pose, between, compose, inverse
from mapping.messages import Odometry, Twist

JUMP = 0.5
"""What a step may exceed the fastest robot's by [m]: stamps of real logs are late now and then."""

MAX_TURN_RATE = 2.0 * pi
"""No odometry turns faster [rad/s]; a Burger turns 2.84 rad/s at most."""

TURN_JUMP = 1.0
"""What a turn may exceed that by [rad]; in the Intel log one comes 0.52 rad too soon."""


class SteadyOdometry:
    """Messages without jumps: after one, the robot stands where it was and goes on from there."""

    def __init__(self, max_speed: float) -> None:
        """Take as a jump what is faster than ``max_speed`` [m/s]."""
        self.max_speed = max_speed
        self.jumps = 0
        """How many there were."""
        self._shift: Pose = np.zeros(3)
        self._newest: Odometry | None = None

    def steady(self, messages: Sequence[Odometry]) -> Iterator[Odometry]:
        """The messages as they would be without jumps, oldest first.

        A message that is not usable, or no newer than the newest, is left out. A twist that no
        robot has is taken as standing still.
        """
        for message in messages:
            if not message.is_usable:
                continue
            if self._newest is not None and message.stamp <= self._newest.stamp:
                continue
            if self._newest is not None and self._jumps(self._newest, message):
                self.jumps += 1
                before = compose(self._shift, self._newest.pose_odom)
                self._shift = compose(before, inverse(message.pose_odom))
            self._newest = message
            yield replace(
                message,
                pose_odom=compose(self._shift, message.pose_odom),
                twist=self._believable(message.twist),
            )

    def _jumps(self, old: Odometry, new: Odometry) -> bool:
        """Whether a robot cannot have gone from one message's pose to the next one's."""
        x, y, turned = between(old.pose_odom, new.pose_odom)
        seconds = new.stamp - old.stamp
        too_far = np.hypot(x, y) > JUMP + self.max_speed * seconds
        return bool(too_far or abs(turned) > TURN_JUMP + MAX_TURN_RATE * seconds)

    def _believable(self, twist: Twist) -> Twist:
        """The twist, or standing still when it is faster than a robot can be."""
        fast = abs(twist.linear_x) > self.max_speed or abs(twist.angular_z) > MAX_TURN_RATE
        return Twist() if fast else twist
