"""OccGridMapp, the thesis's mapper: every scan drawn from the newest odometry pose, beam by beam.

Its 5000 x 5000 cells of 1 cm take 100 MB as float32 (the thesis's float64 takes 200 MB); to plot
from, only the part that was drawn is copied. It differs from the thesis's chapter 4 in this:

- The map keeps the map frame (x to the right, REP-103); ``mapping.thesis_plot`` draws it in that
  of fig. 4.3, with the start heading up and the start 10 m from both axes.
- The start is in the middle of the grid. The thesis's (10, 10) m soon loses what lies behind the
  start and to one side; ``start_in_grid`` sets it.
- Beams start at the lidar, 3.2 cm behind the point that odometry tells of, where the thesis has
  them start; ``lidar_pose_base`` (0, 0, 0) does that too.
"""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike

from mapping.burger import LIDAR_POSE_BASE, LIDAR_RANGE_MAX
from mapping.errors import TestbedError
from mapping.geometry import Pose, compose
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
    state_threshold: float = 3.0
    """A cell is occupied above this log odds and free below its negative (thesis 4.3.6)."""
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
        if self.cells < 1:
            raise TestbedError(f"cells: {self.cells}; must be at least 1")
        for name in ("log_odds_occupied", "log_odds_free", "max_range", "state_threshold"):
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
            occupied_above=self.state_threshold,
            free_below=-self.state_threshold,
        )


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class MapSnapshot:
    """What a mapper knew at one moment, for plotting while mapping goes on (thesis 4.3.3)."""

    grid: OccupancyGrid
    """A copy of the part of the map that was drawn."""
    path: Pose
    """Where the robot was at each scan up to then, in the map frame ``(n, 3)``."""
    start_pose_map: Pose
    """Where it started ``(3,)``."""


class OccGridMapp(OdometryMapper):
    """The thesis's chapter 4: no deskewing, no clamp, cells near a hit cleared with less weight.

    A scan's stamp is what the thesis's new-scan flag is: a scan is drawn once, however often it is
    given, and with the newest odometry there is.
    """

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
        self._low, self._high = start[:2].copy(), start[:2].copy()

    def snapshot(self) -> MapSnapshot:
        """The part of the map that was drawn, and the path; later scans do not change them.

        A copy of a room takes a few milliseconds, so that no scan is lost for it.
        """
        rows, columns = self.grid.shape
        first = np.clip(self.grid.world_to_cell(self._low), 0, (rows - 1, columns - 1))
        last = np.clip(self.grid.world_to_cell(self._high), 0, (rows - 1, columns - 1))
        part = self.grid.log_odds[first[0] : last[0] + 1, first[1] : last[1] + 1].copy()
        corner = self.grid.origin + first[::-1] * self.grid.resolution
        config = replace(
            self.grid.config,
            origin=(float(corner[0]), float(corner[1])),
            rows=part.shape[0],
            columns=part.shape[1],
        )
        grid = OccupancyGrid(config)
        grid.log_odds = part
        return MapSnapshot(
            grid=grid, path=self.trajectory.poses, start_pose_map=self.start_pose_map.copy()
        )

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
        reach = beams.lengths.max() + self.grid.resolution
        low, high = sensor[:2] - reach, sensor[:2] + reach
        self.grid.cover(float(low[0]), float(high[0]), float(low[1]), float(high[1]))
        self._low, self._high = np.minimum(self._low, low), np.maximum(self._high, high)
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
