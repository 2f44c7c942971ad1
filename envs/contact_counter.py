"""Counts what the robot touches, and tells contacts of its own making from people's."""

import math

import mujoco
import numpy as np
from numpy.typing import NDArray

from envs.burger_constants import STEPS_PER_SECOND
from envs.scene import FLOOR

APART_STEPS = STEPS_PER_SECOND // 2
"""How long two that touched must be apart before they can touch anew [steps]: 0.5 s."""

OWN_MOTION = 0.02
"""A robot that moves towards a leg faster than this, a tenth of its full speed [m/s], runs into the
person; a slower one stands."""

AT_REST = 0.005
"""A robot that moves and turns slower than this has not driven on yet [m/s, rad/s]."""


class ContactCounter:
    """Counts contacts since the last reset.

    Each pair of a robot part and a thing that stands still counts for itself, and counts again when
    it had been apart for half a second: a push against a wall chatters. A person counts once for
    the whole meeting, until both had been apart for half a second: the first touch tells whose
    doing it is, and what a pushed robot does afterwards is no longer its own motion: what it runs
    into while people push it, until half a second after they let go of it, or after it drives on if
    it came to rest, is the doing of those people as well.

    Args:
        model: A scene.
        leg_geoms: Geoms of the legs, two a person ``(p, 2)``.
    """

    def __init__(self, model: mujoco.MjModel, leg_geoms: NDArray[np.int64]) -> None:
        self._floor = model.geom(FLOOR).id
        self._person = {geom: k for k, pair in enumerate(leg_geoms.tolist()) for geom in pair}
        self.reset()

    def reset(self) -> None:
        """Count from zero."""
        self.own, self.by_people = 0, 0
        self._touched: dict[tuple[int, int], int] = {}
        self._met: dict[int, int] = {}
        self._pushes: dict[int, bool] = {}
        self._pushed = _NEVER

    def count(
        self,
        data: mujoco.MjData,
        step: int,
        base_position: NDArray[np.float64],
        base_velocity: NDArray[np.float64],
    ) -> None:
        """Count the contacts of a step that were not there lately.

        Args:
            data: The state after the step.
            step: Its number since the reset.
            base_position: Where base_link was before the contacts of this step could push it, x, y
                first ``(2,)`` or longer [m], in the world.
            base_velocity: Its velocity then: linear in the world, angular in base_link ``(6,)``.
        """
        if self._is_pushed(step) and np.abs(base_velocity[[0, 1, 5]]).max() < AT_REST:
            self._pushed = step
        things = []
        for contact, (first, second) in enumerate(data.contact.geom.tolist()):
            if self._floor in (first, second):
                continue
            leg = second if second in self._person else first
            if leg in self._person:
                self._meet(data, contact, leg, step, base_position, base_velocity)
            else:
                things.append((first, second))
        for pair in things:
            if step - self._touched.get(pair, _NEVER) > APART_STEPS:
                self._blame(by_people=self._is_pushed(step))
            self._touched[pair] = step

    def _meet(
        self,
        data: mujoco.MjData,
        contact: int,
        leg: int,
        step: int,
        base_position: NDArray[np.float64],
        base_velocity: NDArray[np.float64],
    ) -> None:
        """Count a person who was not touched lately, by whose doing it is."""
        person = self._person[leg]
        if step - self._met.get(person, _NEVER) > APART_STEPS:
            place, axis = data.contact.pos[contact], data.geom_xpos[leg]
            speed = _speed_towards(axis, place, base_position, base_velocity)
            self._pushes[person] = speed <= OWN_MOTION or self._is_pushed(step)
            self._blame(by_people=self._pushes[person])
        self._met[person] = step
        if self._pushes[person]:
            self._pushed = step

    def _is_pushed(self, step: int) -> bool:
        """Whether people move the robot, or did until lately."""
        return step - self._pushed <= APART_STEPS

    def _blame(self, *, by_people: bool) -> None:
        """Count a contact that is people's doing, or the robot's own."""
        self.by_people += by_people
        self.own += not by_people


_NEVER = -APART_STEPS - 1
"""The step of what has not happened."""


def _speed_towards(
    axis: NDArray[np.float64],
    place: NDArray[np.float64],
    base_position: NDArray[np.float64],
    base_velocity: NDArray[np.float64],
) -> float:
    """How fast the robot moves towards a leg's axis [m/s] at the place where they touch."""
    x, y = float(axis[0] - place[0]), float(axis[1] - place[1])
    turn = float(base_velocity[5])
    arm_x, arm_y = float(place[0] - base_position[0]), float(place[1] - base_position[1])
    velocity_x = float(base_velocity[0]) - turn * arm_y
    velocity_y = float(base_velocity[1]) + turn * arm_x
    apart = math.hypot(x, y)
    return (velocity_x * x + velocity_y * y) / apart if apart > 0.0 else 0.0
