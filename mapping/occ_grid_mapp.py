"""OccGridMapp, the thesis's mapper: every scan drawn from the newest odometry pose, beam by beam.

The map keeps the frame of the start pose (x to the right, REP-103). The thesis draws its maps with
the start heading up and starts 10 m from the corner of the grid, so that what lies behind and to
the left of the start is soon lost; here the start is in the middle unless told otherwise.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from mapping.burger import LIDAR_POSE_BASE, LIDAR_RANGE_MAX
from mapping.errors import TestbedError
from mapping.geometry import compose
from mapping.grid import GridConfig, OccupancyGrid
from mapping.messages import LaserScan
from mapping.odometry_mapper import OdometryMapper, checked_pose
from mapping.ray_trace import trace_beams
from mapping.sensor_model import LOG_ODDS_FREE, LOG_ODDS_OCCUPIED, read_beams

RANGE_DECIMALS = 3
"""Ranges are rounded to the LDS-01's millimetres (thesis 4.3.5)."""


@dataclass(frozen=True, slots=True, kw_only=True)
class OccGridMappConfig:
    """Settings of the thesis's mapper."""

    cells: int = 5000
    """Cells along each side of the grid (thesis 4.3.2)."""
    resolution: float = 0.01
    """Edge of a cell [m] (thesis 4.3.2)."""
    start_in_grid: tuple[float, float] = (25.0, 25.0)
    """Where the start pose lies, x and y from the grid's corner [m]; the thesis's is (10, 10)."""
    turn_gate: float | None = 0.2
    """A scan is dropped while the robot turns faster [rad/s] (thesis 5.3); None draws them all."""
    log_odds_occupied: float = LOG_ODDS_OCCUPIED
    """lo1, what a hit tells."""
    log_odds_free: float = LOG_ODDS_FREE
    """lo0, what a beam passing through tells."""
    max_range: float = LIDAR_RANGE_MAX
    """Farther readings only clear space, up to here [m]."""
    lidar_pose_base: tuple[float, float, float] = LIDAR_POSE_BASE
    """The lidar's pose in base_footprint."""

    def __post_init__(self) -> None:
        """Refuse figures that make no mapper."""
        for name in ("log_odds_occupied", "log_odds_free", "max_range"):
            value = getattr(self, name)
            if not (np.isfinite(value) and value > 0.0):
                raise TestbedError(f"{name}: {value}; must be a finite number above 0")
        if self.turn_gate is not None and not self.turn_gate >= 0.0:
            raise TestbedError(f"turn_gate: {self.turn_gate} rad/s; must be 0 or more, or None")
        checked_pose("lidar_pose_base", self.lidar_pose_base)

    def grid(self, start_pose_map: ArrayLike) -> GridConfig:
        """The fixed grid that has the start pose in its place."""
        start = np.asarray(start_pose_map, dtype=np.float64)[:2]
        corner = np.round((start - self.start_in_grid) / self.resolution) * self.resolution
        return GridConfig(
            resolution=self.resolution,
            origin=(float(corner[0]), float(corner[1])),
            rows=self.cells,
            columns=self.cells,
            grows=False,
        )


class OccGridMapp(OdometryMapper):
    """The thesis's chapter 4: no deskewing, no clamp, cells near a hit cleared with less weight."""

    def __init__(
        self,
        config: OccGridMappConfig | None = None,
        *,
        start_pose_map: ArrayLike = (0.0, 0.0, 0.0),
        grid: GridConfig | None = None,
    ) -> None:
        self.config = config or OccGridMappConfig()
        start = checked_pose("start_pose_map", start_pose_map)
        super().__init__(OccupancyGrid(grid or self.config.grid(start)), start)

    def draw(self, scan: LaserScan) -> bool:
        """Draw the scan's beams from the newest pose, unless the robot turns too fast."""
        config = self.config
        beams = read_beams(scan, config.max_range)
        gate = config.turn_gate
        if self.track.newest is None or beams.indices.size == 0:
            return False
        if gate is not None and abs(self.track.newest_turn_rate) > gate:
            return False
        sensor = compose(self.pose_map, config.lidar_pose_base)
        angles = sensor[2] + scan.angles[beams.indices]
        if self.grid.config.grows:
            reach = float(beams.lengths.max())
            x, y = float(sensor[0]), float(sensor[1])
            self.grid.cover(x - reach, x + reach, y - reach, y + reach)
        trace_beams(
            self.grid.log_odds,
            (sensor[:2] - self.grid.origin) / self.grid.resolution,
            np.column_stack((np.cos(angles), np.sin(angles))),
            np.round(beams.lengths, RANGE_DECIMALS) / self.grid.resolution,
            beams.hits,
            np.float32(config.log_odds_occupied),
            np.float32(config.log_odds_free),
        )
        return True
