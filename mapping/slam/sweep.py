"""A scan kept for drawing the map anew: 7 kB for 360 beams."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mapping.aimed_beams import AimedBeams, aim_beams
from mapping.geometry import Pose
from mapping.grid import OccupancyGrid
from mapping.messages import LaserScan
from mapping.ogm import OgmConfig, draw_beams
from mapping.sensor_model import Beams


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Sweep:
    """What a scan saw, and from where, relative to the robot at its first beam."""

    indices: NDArray[np.int16]
    """Beams that tell something ``(n,)``."""
    lengths: NDArray[np.float32]
    """How far each is known to have gone ``(n,)`` [m]."""
    hits: NDArray[np.bool_]
    """Whether it met something there ``(n,)``."""
    poses_base: NDArray[np.float32]
    """Where the robot was at each of them ``(n, 3)``."""
    angle_min: float
    angle_increment: float

    def draw(
        self, grid: OccupancyGrid, config: OgmConfig, pose_map: Pose, scale: float = 1.0
    ) -> None:
        """Draw the scan as taken from a pose ``(3,)``; a scan without beams draws nothing.

        ``scale`` is what a metre that the lidar measured is believed to be [m].
        """
        if len(self.indices) > 0:
            beams, angles, poses = self._in_metres(scale)
            draw_beams(grid, config, beams, angles, self.angle_increment, pose_map, poses)

    def aimed(self, config: OgmConfig, pose_map: Pose, scale: float = 1.0) -> AimedBeams | None:
        """The beams in the map, None if there are none; arguments as those of ``draw``."""
        if len(self.indices) == 0:
            return None
        beams, angles, poses = self._in_metres(scale)
        return aim_beams(config, beams, angles, self.angle_increment, pose_map, poses)

    def _in_metres(self, scale: float) -> tuple[Beams, NDArray[np.float64], Pose]:
        """The beams, their directions ``(n,)`` [rad], and the robot's poses at them ``(n, 3)``."""
        beams = Beams(
            indices=self.indices.astype(np.int64),
            lengths=scale * self.lengths.astype(np.float64),
            hits=self.hits,
        )
        angles = self.angle_min + self.indices.astype(np.float64) * self.angle_increment
        return beams, angles, self.poses_base.astype(np.float64) * (scale, scale, 1.0)


def make_sweep(scan: LaserScan, beams: Beams, poses_base: Pose) -> Sweep:
    """Keep the beams of a scan and where the robot was at each ``(n, 3)``."""
    return Sweep(
        indices=beams.indices.astype(np.int16),
        lengths=beams.lengths.astype(np.float32),
        hits=beams.hits,
        poses_base=poses_base.astype(np.float32),
        angle_min=scan.angle_min,
        angle_increment=scan.angle_increment,
    )
