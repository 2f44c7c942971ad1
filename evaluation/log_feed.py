"""Gives a mapper the messages of a log one period after another, and measures what that takes."""

from collections.abc import Sequence
from math import isfinite
from time import perf_counter

import numpy as np

from mapping.log_editing import shortened
from mapping.mapper import Mapper
from mapping.messages import LaserScan, Odometry
from mapping.pose_history import PoseHistory
from mapping.sensor_log import Period

STAMP_ROUNDING = 1e-6
"""Log files round stamps to the microsecond [s]; a scan that is due is not missed for that."""


class LogFeed:
    """Feeds a mapper; only the mapper's own time is measured."""

    def __init__(self, mapper: Mapper, *, max_range: float, period: float = 0.0) -> None:
        """Feed a mapper.

        Args:
            mapper: The mapper.
            max_range: The lidar's range is cut to this [m].
            period: The mapper gets a scan at most every so many seconds of the log; 0 gives all.
        """
        self._mapper = mapper
        self._max_range = max_range
        self._period = period
        self._last_scan = self._last_odometry = self._stamp = -np.inf
        self.scans = 0
        """How many scans there were, given or not."""
        self.repeated = 0
        """How many of them had the stamp of the one before; a mapper takes that for the same."""
        self.oldest, self.newest = np.inf, -np.inf
        """The earliest and the latest stamp so far [s]."""
        self.wall_time = 0.0
        """What the mapper took for all of it [s]."""
        self.map_update_seconds: list[float] = []
        """What it took for each scan that went into the map [s]."""
        self.map_update_stamps: list[float] = []
        """Stamps of those scans [s]."""
        self.online = PoseHistory()
        """Where it took the robot to be, at the newest odometry of each period."""

    def give(self, period: Period) -> None:
        """Let the mapper have the messages of one period; the scan only when it is due."""
        scan, odometry, imu = period
        due = self._due(scan)
        updates = self._mapper.updates
        started = perf_counter()
        self._mapper.update(due, odometry, imu)
        seconds = perf_counter() - started
        self.wall_time += seconds
        if self._mapper.updates > updates:
            self.map_update_seconds.append(seconds)
            if due is not None:
                self.map_update_stamps.append(due.stamp)
        self._note(scan, odometry)

    def _due(self, scan: LaserScan | None) -> LaserScan | None:
        """The scan with its range cut, or None when the mapper got one not long ago."""
        if scan is None:
            return None
        self.repeated += scan.stamp == self._stamp
        self._stamp = scan.stamp
        if self._period > 0.0 and isfinite(scan.stamp):
            if scan.stamp < self._last_scan + self._period - STAMP_ROUNDING:
                return None
            self._last_scan = scan.stamp
        return shortened(scan, self._max_range)

    def _note(self, scan: LaserScan | None, odometry: Sequence[Odometry]) -> None:
        """Count the scan, keep the time, and the pose if odometry went on."""
        self.scans += scan is not None
        newest = max((each.stamp for each in odometry if isfinite(each.stamp)), default=-np.inf)
        if newest > self._last_odometry:
            self._last_odometry = newest
            self.online.add(newest, self._mapper.pose_map)
        stamps = [each.stamp for each in odometry] + ([] if scan is None else [scan.stamp])
        finite = [stamp for stamp in stamps if isfinite(stamp)]
        self.oldest = min([self.oldest, *finite])
        self.newest = max([self.newest, *finite])
