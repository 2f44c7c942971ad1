"""Turns where the robot is and was into the rolling scans of its LDS-01."""

import mujoco
import numpy as np
from numpy.typing import NDArray

from envs.burger_constants import LIDAR_POSITION, STEPS_PER_SECOND
from envs.lidar_kernels import block_rays, shift_origins
from envs.lidar_noise import LidarConfig, draw_unit, report
from envs.pedestrian_kernels import stop_at_legs
from envs.pedestrians import LEG_RADIUS, Feet
from envs.scene import SOLID_GROUP
from mapping.burger import LIDAR_BEAMS, LIDAR_SCAN_TIME

BLOCKS = 10
"""Blocks of one turn, each cast when its own time has come: what moves is seen where it then is."""

BLOCK_BEAMS = LIDAR_BEAMS // BLOCKS
"""Beams of a block."""

BLOCK_STEPS = round(LIDAR_SCAN_TIME / BLOCKS * STEPS_PER_SECOND)
"""Physics steps that a block takes: 20 ms."""


class Lidar:
    """An LDS-01 that looks round a MuJoCo world, 36 beams at a time.

    The beams of a block share one cast from where the sensor is in the block's middle. Each has the
    direction of its own time, and its distance is carried over to where the sensor is at its own
    time along the surface that it hit. The base is taken to move evenly between three states, 10 ms
    apart. On flat walls that is exact; what remains is an edge within the 2.2 mm that the sensor
    moves in half a block at full speed, where a beam may see the one side for the other.

    People's legs move too fast for that: 7 cm in a block. They are cylinders, so each beam is cut
    off at them by arithmetic, where they are at its own time; taken to move evenly between the same
    three states they are within 0.3 mm of the truth at 1.2 m/s, and 0.7 mm at 2 m/s.

    Beams lie in the plane of the sensor, which pitches with the robot when it speeds up or brakes.
    They meet solids and legs only, never the floor or the robot.
    """

    def __init__(self, model: mujoco.MjModel, config: LidarConfig) -> None:
        self.config = config
        self._model = model
        self._groups = np.zeros(mujoco.mjNGROUP, dtype=np.uint8)
        self._groups[SOLID_GROUP] = 1
        angles = np.arange(LIDAR_BEAMS) * (2.0 * np.pi / LIDAR_BEAMS)
        self._beams = np.stack((np.cos(angles), np.sin(angles)), axis=1)
        self._offset = np.array(LIDAR_POSITION)
        self._directions = np.empty((BLOCK_BEAMS, 3))
        self._shifts = np.empty((BLOCK_BEAMS, 3))
        self._normals = np.empty((BLOCK_BEAMS, 3))
        self._hit_geoms = np.empty(BLOCK_BEAMS, dtype=np.int32)
        self._distances = np.empty(LIDAR_BEAMS)
        self.reset(np.random.default_rng())

    def reset(self, rng: np.random.Generator) -> None:
        """Start a new turn with a new device."""
        self._rng = rng
        self._unit = draw_unit(self.config, rng)
        self._block = 0

    def cast_block(
        self, data: mujoco.MjData, base_states: NDArray[np.float64], feet: Feet | None = None
    ) -> NDArray[np.float32] | None:
        """Cast the next block of beams; the world is as it is at the block's end.

        Args:
            data: State of the world, for what stands in it.
            base_states: Position and quaternion (w, x, y, z) of base_link at the block's start,
                middle and end ``(3, 7)``.
            feet: Where people's legs are at the same times ``(3, m, 2)`` [m], if there are any.

        Returns:
            The ranges ``(360,)`` as messages.LaserScan has them if this block completed a turn,
            else None.
        """
        first = self._block * BLOCK_BEAMS
        distances = self._distances[first : first + BLOCK_BEAMS]
        self._cast(data, base_states, feet, self._beams[first : first + BLOCK_BEAMS], distances)
        self._block = (self._block + 1) % BLOCKS
        if self._block:
            return None
        return report(self._distances, self.config, self._unit, self._rng)

    def _cast(
        self,
        data: mujoco.MjData,
        base_states: NDArray[np.float64],
        feet: Feet | None,
        beams: NDArray[np.float64],
        distances: NDArray[np.float64],
    ) -> None:
        """True distances of one block's beams, into ``distances``."""
        origin = block_rays(base_states, self._offset, beams, self._directions, self._shifts)
        mujoco.mj_multiRay(
            self._model,
            data,
            origin,
            self._directions.reshape(-1),
            self._groups,
            True,  # walls are static geoms
            -1,  # no body excluded: the groups leave the robot out
            self._hit_geoms,
            distances,
            self._normals.reshape(-1),
            BLOCK_BEAMS,
            self.config.cast_range,
        )
        shift_origins(distances, self._normals, self._directions, self._shifts)
        if feet is not None:
            stop_at_legs(distances, origin, self._directions, self._shifts, feet, LEG_RADIUS)
