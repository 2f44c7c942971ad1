"""A mapper and a navigator make an agent: observation in, action out."""

from array import array
from time import perf_counter

import numpy as np
from numpy.typing import NDArray

from mapping.mapper import Mapper
from mapping.messages import Imu, LaserScan, Observation, Odometry
from nav.navigator import Navigator

Action = NDArray[np.float32]


class MappingAgent:
    """Maps every observation, then asks the navigator where to go on that map."""

    def __init__(self, mapper: Mapper, navigator: Navigator) -> None:
        self.mapper = mapper
        self.navigator = navigator
        self._scan: LaserScan | None = None
        self.map_update_seconds = array("f")
        """Wall time of each mapper update that took in a scan [s]."""
        self.map_update_stamps = array("d")
        """Stamps of those scans [s]."""
        self.navigator_seconds = array("f")
        """Wall time of each navigator command [s]."""
        self.decision_seconds = array("f")
        """The same of those commands in which it weighed where to go [s]."""

    def act(self, observation: Observation) -> Action:
        """Update the map with all messages of the last control period, then command.

        Returns:
            The action ``(2,)`` as (forward speed [m/s], turn rate [rad/s]).
        """
        if self._scan is None or observation["scan_stamp"][0] != self._scan.stamp:
            self._scan = LaserScan.from_observation(observation)
        scan = self._scan
        before = self.mapper.updates
        started = perf_counter()
        self.mapper.update(
            scan, Odometry.from_observation(observation), Imu.from_observation(observation)
        )
        mapped = perf_counter()
        if self.mapper.updates > before:
            self.map_update_seconds.append(mapped - started)
            if scan is not None:
                self.map_update_stamps.append(scan.stamp)
        decisions = self.navigator.decisions
        twist = self.navigator.command(self.mapper.grid, self.mapper.pose_map, scan)
        self.navigator_seconds.append(perf_counter() - mapped)
        if self.navigator.decisions > decisions:
            self.decision_seconds.append(self.navigator_seconds[-1])
        return np.array([twist.linear_x, twist.angular_z], dtype=np.float32)
