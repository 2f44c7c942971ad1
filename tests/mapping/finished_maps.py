"""Maps drawn from scans in a room, to be finished."""

import numpy as np

from mapping.aimed_beams import AimedBeams, aim_beams
from mapping.burger import LIDAR_RANGE_MAX
from mapping.geometry import Pose
from mapping.grid import GridConfig, OccupancyGrid
from mapping.messages import LaserScan
from mapping.ogm import OgmConfig, draw_beams
from mapping.sensor_model import read_beams
from tests.mapping.slam.rooms import Walls, box, scan_of

GRID = GridConfig(resolution=0.01, origin=(-3.0, -3.0), rows=600, columns=600, grows=False)
CONFIG = OgmConfig()

ROOM = box(-1.604, 1.604, -1.204, 1.204)
"""Its walls run 4 mm beyond a cell's edge: the cell that they run through is free by its centre
only if they stand beyond that."""

TOUR = np.array([(x, y, 0.7 * x) for x in np.linspace(-1.0, 1.0, 11) for y in (-0.6, 0.0, 0.6)])


def scans_in(walls: Walls, poses: Pose, seed: int | None = 0) -> list[LaserScan]:
    """A scan from each pose, with the noise of an LDS-01 unless there is no seed."""
    rng = None if seed is None else np.random.default_rng(seed)
    return [scan_of(walls, pose, rng) for pose in poses]


def mapped(scans: list[LaserScan], poses: Pose) -> OccupancyGrid:
    grid = OccupancyGrid(GRID)
    for scan, pose in zip(scans, poses, strict=True):
        beams = read_beams(scan, LIDAR_RANGE_MAX)
        still = np.zeros((len(beams.indices), 3))
        angles = scan.angles[beams.indices]
        draw_beams(grid, CONFIG, beams, angles, scan.angle_increment, pose, still)
    return grid


def aimed(scans: list[LaserScan], poses: Pose) -> list[AimedBeams]:
    """The beams of robots that stood still."""
    found = []
    for scan, pose in zip(scans, poses, strict=True):
        beams = read_beams(scan, LIDAR_RANGE_MAX)
        angles, still = scan.angles[beams.indices], np.zeros((len(beams.indices), 3))
        found.append(aim_beams(CONFIG, beams, angles, scan.angle_increment, pose, still))
    return found
