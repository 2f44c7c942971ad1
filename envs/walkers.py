"""Moves the legs of people through a scene as time goes on."""

from collections.abc import Sequence

import mujoco
import numpy as np
from numpy.typing import NDArray

from envs.pedestrian_kernels import nearest_squared
from envs.pedestrians import LEG_HEIGHT, Feet, Pedestrian, feet_at, gaits_of
from envs.scene import leg_name

NEAR = 0.35
"""Legs farther than this from base_footprint [m] cannot touch the robot within 10 ms: its outline
and a leg reach 0.19 m, and a foot of the fastest walker swings 6 cm."""


class Walkers:
    """The people in a scene; their legs are moved, not simulated: nothing stops them.

    The legs must be the scene's only moved bodies, in order.
    """

    def __init__(self, model: mujoco.MjModel, people: int) -> None:
        names = [leg_name(person, side) for person in range(people) for side in (0, 1)]
        assert [model.body(name).mocapid[0] for name in names] == list(range(model.nmocap))
        self.geoms = np.array([model.geom(name).id for name in names], np.int64).reshape(-1, 2)
        self.reset(())

    def reset(self, people: Sequence[Pedestrian]) -> None:
        """Let these people walk, as many as the scene has legs for."""
        self._people = tuple(people)
        self._gaits = gaits_of(people)
        self._ways = [person.laid_out() for person in people]

    def __len__(self) -> int:
        return len(self._people)

    def feet(self, times: Sequence[float]) -> NDArray[np.float64]:
        """Where the legs are at some times ``(n,)`` [s]: ``(n, 2 p, 2)`` [m]."""
        feet = np.empty((len(times), 2 * len(self), 2))
        for time, row in zip(times, feet, strict=True):
            feet_at(self._gaits, time, row)
        return feet

    def positions(self, time: float) -> Feet:
        """Where the middles of their bodies are at a time [s] ``(p, 2)`` [m], in the world."""
        positions = np.empty((len(self), 2))
        for k, (person, (corners, ways)) in enumerate(zip(self._people, self._ways, strict=True)):
            way = (person.phase * ways[-1] + person.speed * time) % ways[-1]
            positions[k] = [np.interp(way, ways, column) for column in corners.T]
        return positions

    def stand_up(self, data: mujoco.MjData, time: float) -> None:
        """Put the legs of all on the floor, where they are at a time [s]."""
        data.mocap_pos[:, 2] = 0.5 * LEG_HEIGHT
        self.move(data, time)

    def move(self, data: mujoco.MjData, time: float) -> bool:
        """Put the legs where they are at a time [s]; tells whether one may touch the robot soon."""
        legs = feet_at(self._gaits, time, data.mocap_pos)
        return bool(nearest_squared(legs, data.qpos) < NEAR * NEAR)
