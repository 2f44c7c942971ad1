"""Occupancy grid mapping with deskewed scans, free wedges and readings weighted by their noise.

As the thesis's mapper it trusts the odometry's pose, but every beam is drawn from where the robot
was when it was shot, each cell changes once a scan, with hits winning, and log odds are clamped,
so that what has gone disappears from the map within a second however long it stood there.

The settings were tuned in turtlebot3_world and in an empty room of 6 x 6 m crossed 2.5 m from its
walls, at 1 cm, with the datasheet's noise and true poses. In the second, all that is seen of the
walls are far readings of 3.5 cm standard deviation: there a smaller margin before the reading, or a
hit worth less, wipes out more wall than it draws. In the first, a margin only costs free space.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from mapping.burger import LIDAR_POSE_BASE, LIDAR_RANGE_MAX
from mapping.deskew_kernels import aim, bounds
from mapping.errors import TestbedError
from mapping.geometry import Pose
from mapping.grid import GridConfig, OccupancyGrid
from mapping.hit_cells import hit_cells, raise_to, raised_values
from mapping.messages import LaserScan
from mapping.odometry_mapper import OdometryMapper, checked_pose
from mapping.polygon_fill import lower_inside
from mapping.scan_polygon import compare_neighbours, free_outline
from mapping.sensor_model import LDS_01, Beams, RangeNoise, range_sigma, read_beams

START_CELLS = 512
"""Cells along each side of the grid at the start; it grows from there."""

BEHIND_CELLS = 0.5
"""A reading tells where a thing begins; the cell whose centre lies in the thing is half a cell
farther on. Without this, half of the cells before every wall would be drawn as wall."""

WIDEST_WEDGE = 1.5
"""Beams farther apart than this many of the scan's increments are no neighbours: those between
them failed, or the robot turned between the scan's last beam and its first."""


@dataclass(frozen=True, slots=True, kw_only=True)
class OgmConfig:
    """Settings of the mapper, tuned as the module tells."""

    miss: float = 1.6
    """Log odds that a cell loses in a scan that saw it free; two such scans call it free."""
    hit: float = 2.4
    """Log odds that a cell gains from a reading whose standard deviation is a cell or less; a
    noisier one, which may be off by as many cells as it is noisier, is worth that much less."""
    lowest: float = -6.5
    """Lower clamp; a thing that comes is on the map after four near scans, 0.8 s."""
    highest: float = 7.0
    """Upper clamp; a thing that goes is off the map after three scans, 0.6 s."""
    clear_sigmas: float = 2.0
    """Before a reading, this many times the noise that exceeds ``sharp_cells`` is not cleared."""
    sharp_cells: float = 1.6
    """Up to this standard deviation, in cells, readings of one wall fall into the same few cells
    often enough to outweigh those that went too far, and space is cleared up to the reading."""
    link: float = 0.1
    """Readings in turn that end this near to one another [m] belong to one wall (thesis 5.1:
    narrower than the robot's 0.178 m, so no passage is lost)."""
    max_range: float = LIDAR_RANGE_MAX
    """Farther readings only clear space, up to here [m]."""
    lidar_pose_base: tuple[float, float, float] = LIDAR_POSE_BASE
    """The lidar's pose in base_footprint."""
    range_noise: RangeNoise = LDS_01
    """How far the lidar's readings scatter."""

    def __post_init__(self) -> None:
        """Refuse figures that make no mapper."""
        for name in ("miss", "hit", "max_range"):
            value = getattr(self, name)
            if not (np.isfinite(value) and value > 0.0):
                raise TestbedError(f"{name}: {value}; must be a finite number above 0")
        for name in ("clear_sigmas", "sharp_cells", "link"):
            value = getattr(self, name)
            if not (np.isfinite(value) and value >= 0.0):
                raise TestbedError(f"{name}: {value}; must be a finite number, 0 or more")
        if not -np.inf < self.lowest < 0.0 < self.highest < np.inf:
            raise TestbedError(
                f"lowest, highest: {self.lowest}, {self.highest}; must be finite and around 0"
            )
        checked_pose("lidar_pose_base", self.lidar_pose_base)


class Ogm(OdometryMapper):
    """Occupancy grid mapping from deskewed scans."""

    def __init__(
        self,
        config: OgmConfig | None = None,
        *,
        start_pose_map: ArrayLike = (0.0, 0.0, 0.0),
        grid: GridConfig | None = None,
    ) -> None:
        self.config = config or OgmConfig()
        start = checked_pose("start_pose_map", start_pose_map)
        super().__init__(OccupancyGrid(grid or growing_grid(start)), start)

    def draw(self, scan: LaserScan) -> bool:
        """Draw the scan, each beam from the pose of its own time; needs odometry near that time."""
        beams = read_beams(scan, self.config.max_range)
        poses_odom = self.track.poses_at(scan.beam_stamps[beams.indices])
        if poses_odom is None or beams.indices.size == 0:
            return False
        angles = scan.angles[beams.indices]
        draw_beams(
            self.grid,
            self.config,
            beams,
            angles,
            scan.angle_increment,
            self.start_pose_map,
            poses_odom,
        )
        return True


def draw_beams(
    grid: OccupancyGrid,
    config: OgmConfig,
    beams: Beams,
    angles: NDArray[np.float64],
    increment: float,
    start_pose_map: Pose,
    poses: Pose,
) -> None:
    """Draw the beams of one scan, each from where the robot was when it was shot.

    What they passed is lowered, but what they hit wins: it is raised from before that. Beams
    without a return keep a margin too: a wall just out of range may be just within.

    Args:
        grid: Grows to hold them, if it grows.
        config: How to draw.
        beams: What they saw, at least one.
        angles: Their directions in the sensor frame ``(n,)`` [rad].
        increment: Angle between neighbours [rad].
        start_pose_map: The frame of ``poses``, in the map ``(3,)``.
        poses: Pose of base_footprint at each beam's time ``(n, 3)``.
    """
    origins, directions, ends = aim(
        start_pose_map,
        poses,
        config.lidar_pose_base,
        angles,
        beams.lengths + BEHIND_CELLS * grid.resolution,
    )
    grid.cover(*bounds(origins, ends))
    sigmas = range_sigma(beams.lengths, config.range_noise)
    gains = config.hit * np.minimum(1.0, grid.resolution / sigmas)
    cells, cell_gains = hit_cells(
        (ends[beams.hits] - grid.origin) / grid.resolution,
        gains[beams.hits],
        config.link / grid.resolution,
        grid.shape,
    )
    outline = _free_outline(grid, config, beams, sigmas, origins, directions, increment)
    raised = raised_values(grid.log_odds, cells, cell_gains, np.float32(config.highest))
    lower_inside(grid.log_odds, outline, np.float32(config.miss), np.float32(config.lowest))
    raise_to(grid.log_odds, cells, raised)


def _free_outline(
    grid: OccupancyGrid,
    config: OgmConfig,
    beams: Beams,
    sigmas: NDArray[np.float64],
    origins: NDArray[np.float64],
    directions: NDArray[np.float64],
    increment: float,
) -> NDArray[np.float64]:
    """The edges around what the beams saw free, in cells; wants them counter-clockwise."""
    blur = np.maximum(sigmas - config.sharp_cells * grid.resolution, 0.0)
    free = np.maximum(beams.lengths - config.clear_sigmas * blur, 0.0)
    order = slice(None) if increment > 0.0 else slice(None, None, -1)
    pairs = compare_neighbours(
        directions[order],
        beams.lengths[order],
        sigmas[order],
        beams.hits[order],
        WIDEST_WEDGE * abs(increment),
    )
    return np.asarray(
        free_outline(
            (origins[order] - grid.origin) / grid.resolution,
            directions[order],
            free[order] / grid.resolution,
            pairs,
        )
    )


def growing_grid(start_pose_map: ArrayLike, resolution: float | None = None) -> GridConfig:
    """A small grid around the start, its corner whole cells away from the map frame's origin."""
    edge = GridConfig().resolution if resolution is None else resolution
    start = np.asarray(start_pose_map, dtype=np.float64)[:2]
    corner = (np.round(start / edge) - START_CELLS // 2) * edge
    return GridConfig(
        resolution=edge,
        origin=(float(corner[0]), float(corner[1])),
        rows=START_CELLS,
        columns=START_CELLS,
    )
