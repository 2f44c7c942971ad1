"""Maps of rooms of straight walls, and drives through them for localisers."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from scipy import ndimage

from mapping.geometry import Pose, between, compose
from mapping.grid import FREE, OCCUPIED, UNKNOWN
from mapping.io.map_server import MapFile
from mapping.localization.known_map import KnownMap, known_map
from mapping.localization.localizer import Localizer
from tests.mapping.slam.rooms import Period, Walls, box, drive, outline, post

RESOLUTION = 0.02

L_ROOM = outline([(0.0, 0.0), (4.0, 0.0), (4.0, 1.8), (2.4, 1.8), (2.4, 3.4), (0.0, 3.4)])
"""An L-shaped room: no pose looks like another."""

L_ROOM_WAY = [(0.6, 0.7), (3.3, 0.7), (1.2, 1.2), (1.2, 2.8)]

EVEN_ROOM = box(0.0, 4.0, 0.0, 2.4)
"""Turned by half a turn it is the same."""

EVEN_WAY = [(0.9, 0.7), (2.9, 0.8), (2.0, 1.6)]


def map_of(walls: Walls, inside: tuple[float, float]) -> KnownMap:
    """A perfect map of walls; free is what can be walked to from a place."""
    low = walls.reshape(-1, 2).min(axis=0) - 0.3
    high = walls.reshape(-1, 2).max(axis=0) + 0.3
    columns, rows = np.ceil((high - low) / RESOLUTION).astype(int)
    occupied = np.zeros((rows, columns), dtype=bool)
    for x0, y0, x1, y1 in walls:
        count = 4 * int(np.hypot(x1 - x0, y1 - y0) / RESOLUTION) + 2
        shares = np.linspace(0.0, 1.0, count)
        points = np.column_stack((x0 + shares * (x1 - x0), y0 + shares * (y1 - y0)))
        cells = np.floor((points - low) / RESOLUTION).astype(int)
        occupied[cells[:, 1], cells[:, 0]] = True
    labels, _ = ndimage.label(~occupied)
    column, row = np.floor((np.array(inside) - low) / RESOLUTION).astype(int)
    states = np.full(occupied.shape, UNKNOWN, dtype=np.int8)
    states[labels == labels[row, column]] = FREE
    states[occupied] = OCCUPIED
    return known_map(
        MapFile(resolution=RESOLUTION, origin=(float(low[0]), float(low[1])), states=states)
    )


def with_posts() -> Walls:
    return np.concatenate((EVEN_ROOM, post(1.2, 1.7, 0.15), post(2.8, 0.7, 0.15)))


def driven(
    localizer: Localizer, walls: Walls, way: Sequence[tuple[float, float]], seed: int = 0
) -> tuple[Pose, list[Period]]:
    """Let a localiser ride along; returns the true pose at the end and what it was given."""
    run = drive(walls, way, np.random.default_rng(seed))
    for scan, odometry in run.periods:
        localizer.update(scan, odometry)
    return run.truth[-1], run.periods


def error(localizer: Localizer, truth: Pose) -> tuple[float, float]:
    """How far the pose of the newest scan is off: metres, radians.

    Odometry runs on to the end of the scan, 0.2 s after its first beam.
    """
    x, y, yaw = between(truth, localizer.hypotheses[0].pose)
    return float(np.hypot(x, y)), abs(float(yaw))


def later(periods: Sequence[Period], stamp: float, pose_odom: Pose) -> list[Period]:
    """The same drive, beginning later and from another pose of the odometry."""
    moved = []
    for scan, odometry in periods:
        assert scan is not None
        messages = [
            replace(each, stamp=each.stamp + stamp, pose_odom=compose(pose_odom, each.pose_odom))
            for each in odometry
        ]
        moved.append((replace(scan, stamp=scan.stamp + stamp), messages))
    return moved
