"""A run as a ROS bag tells it: the sensors' messages, the commands, the frames and the map."""

from collections.abc import Iterable
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from mapping.io.map_server import MapFile
from mapping.sensor_log import SensorLog


@dataclass(frozen=True, slots=True, kw_only=True)
class StaticFrame:
    """A frame that is fixed to another one."""

    parent: str
    child: str
    position: tuple[float, float, float]
    """The child's origin in the parent: x, y, z [m]."""
    yaw: float = 0.0
    """How far the child is turned in the parent [rad]."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class RecordedRun:
    """A sensor log and what happened besides; a log alone makes a bag as well."""

    log: SensorLog
    commands: NDArray[np.float64] = field(default_factory=lambda: np.empty((0, 3)))
    """Stamp [s], forward speed [m/s] and turn rate [rad/s] of each command ``(n, 3)``."""
    map_from_odom: NDArray[np.float64] = field(default_factory=lambda: np.empty((0, 4)))
    """Stamp [s] and the pose of odom in the map frame, as the mapper had it then ``(n, 4)``."""
    maps: Iterable[tuple[float, MapFile]] = ()
    """When [s] a map was published, and the map."""
    frames: tuple[StaticFrame, ...] = ()
    """The sensors' frames on the robot; when empty, the lidar's alone, from the log."""
