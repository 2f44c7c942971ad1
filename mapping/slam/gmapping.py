"""Maps with a Rao-Blackwellised particle filter, as GMapping does.

Grisetti, Stachniss, Burgard: Improved Techniques for Grid Mapping with Rao-Blackwellized Particle
Filters, IEEE Transactions on Robotics 23(1), 2007. Beyond GMapping, every beam is placed where the
robot was at its own time, beams without a return clear some space, and odometry may jump.
"""

from array import array
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from mapping.deskew import OdometryTrack
from mapping.geometry import Pose, between, compose
from mapping.grid import GridConfig, OccupancyGrid
from mapping.messages import Imu, LaserScan, Odometry
from mapping.odometry_mapper import checked_pose
from mapping.ogm import growing_grid
from mapping.pose_history import PoseHistory
from mapping.sensor_model import read_beams
from mapping.slam.gmapping_config import GmappingConfig
from mapping.slam.gmapping_filter import GmappingFilter
from mapping.slam.gmapping_odometry import SteadyOdometry
from mapping.slam.gmapping_scan import BaseBeams, beams_in_base

SURE = 1.0
"""How far beyond the grid's thresholds the log odds of a known cell are drawn."""


class Gmapping:
    """The mapper ``gmapping``.

    A scan is dropped, and counted in ``scans_dropped``, when it is older than the newest one, when
    there is no odometry for it, when no beam of it tells anything, when it is throttled, or when
    the robot has not moved enough since the last one that was processed.

    The pose is the best particle's at the last scan processed, and from there on the odometry's.
    """

    def __init__(
        self,
        config: GmappingConfig | None = None,
        *,
        start_pose_map: ArrayLike = (0.0, 0.0, 0.0),
        grid: GridConfig | None = None,
    ) -> None:
        """Start with an empty map.

        Args:
            config: Settings; None for a TurtleBot3 Burger's.
            start_pose_map: Where the robot stands in the map when its odometry starts.
            grid: The published grid. Its resolution is then the maps' too, in place of ``delta``.
        """
        config = config or GmappingConfig()
        self.start_pose_map = checked_pose("start_pose_map", start_pose_map)
        grid = grid or growing_grid(self.start_pose_map, config.delta)
        self.config = replace(config, delta=grid.resolution)
        self.updates = 0
        self.scans_dropped = 0
        self.track = OdometryTrack()
        self.filter = GmappingFilter(self.config, self.start_pose_map, grid.origin)
        self._grid = OccupancyGrid(grid)
        self._odometry = SteadyOdometry(self.config.max_speed)
        self._scan_steps = array("q")
        self._scan_motions = PoseHistory()
        self._reference_odom: Pose = np.zeros(3)
        self._predicted_odom: Pose = np.zeros(3)
        self._seen = self._newest_scan = self._processed = self._drawn = -np.inf
        self._gone = self._turned = 0.0
        self._looked_at = 0
        self._owes_redraw = False

    @property
    def grid(self) -> OccupancyGrid:
        """The best particle's map; ``redraws`` counts how often that was another's map."""
        return self._grid

    @property
    def pose_map(self) -> Pose:
        """The newest pose in the map frame ``(3,)``; the start pose before any odometry."""
        newest = self.track.newest
        return self._pose_at(self._reference_odom if newest is None else newest)

    @property
    def trajectory(self) -> PoseHistory:
        """The best particle's path: a pose for every scan with odometry, processed or not."""
        path = self.filter.paths.path(self.filter.best)
        poses = compose(path[np.array(self._scan_steps, dtype=np.int64)], self._scan_motions.poses)
        return PoseHistory.of(self._scan_motions.stamps, poses)

    def update(
        self, scan: LaserScan | None, odometry: Sequence[Odometry], imu: Sequence[Imu] = ()
    ) -> None:
        """Take the messages of one control period; IMU readings are not used."""
        self.track.add(list(self._odometry.steady(odometry)))
        if scan is None or scan.stamp == self._seen:
            return
        self._seen = scan.stamp
        pose_odom = self.track.poses_at([scan.stamp]) if scan.stamp > self._newest_scan else None
        if pose_odom is None:
            self.scans_dropped += 1
            return
        self._newest_scan = scan.stamp
        if self._take(scan, pose_odom[0]):
            self.updates += 1
        else:
            self.scans_dropped += 1
        self._scan_steps.append(self.filter.paths.steps - 1)
        self._scan_motions.add(scan.stamp, between(self._reference_odom, pose_odom[0]))

    def finish(self) -> None:
        """Draw the map if ``map_update_interval`` has put that off."""
        if self._owes_redraw:
            self._draw(True, np.ones(self.filter.maps.tables.shape[1:], dtype=np.bool_))

    def _take(self, scan: LaserScan, pose_odom: Pose) -> bool:
        """Process a scan that is due; False when it is not, or tells nothing."""
        self._looked_at += 1
        if (self._looked_at - 1) % self.config.throttle_scans != 0:
            return False
        self._follow(pose_odom)
        if not self._is_due(scan.stamp):
            return False
        beams = read_beams(scan, self.config.max_range)
        poses_odom = self.track.poses_at(scan.beam_stamps[beams.indices])
        if poses_odom is None or beams.indices.size == 0 or not np.all(np.isfinite(scan.angles)):
            return False
        self._process(
            scan.stamp,
            pose_odom,
            beams_in_base(scan, beams, poses_odom, pose_odom, self.config),
        )
        return True

    def _follow(self, pose_odom: Pose) -> None:
        """Let the particles follow the odometry; before the first map all stand at one place."""
        if self.updates > 0:
            step = between(self._predicted_odom, pose_odom)
            self.filter.predict(step)
            self._gone += float(np.hypot(step[0], step[1]))
            self._turned += abs(float(step[2]))
        self._predicted_odom = pose_odom

    def _is_due(self, stamp: float) -> bool:
        """Whether the robot moved, or time passed, enough for a scan to be processed."""
        config, waited = self.config, stamp - self._processed
        if waited < config.update_interval:
            return False
        if self.updates == 0 or 0.0 <= config.temporalUpdate < waited:
            return True
        return self._gone >= config.linearUpdate or self._turned >= config.angularUpdate

    def _process(self, stamp: float, pose_odom: Pose, beams: BaseBeams) -> None:
        """Update the filter with a scan, and the published grid with its best map."""
        if self.updates == 0:
            self.filter.start(self._pose_at(pose_odom), beams)
            is_other, changed = False, np.ones(self.filter.maps.tables.shape[1:], dtype=np.bool_)
        else:
            is_other, changed = self.filter.update(beams)
        self._reference_odom, self._processed = pose_odom, stamp
        self._gone = self._turned = 0.0
        self._grid.cover(*self.filter.bounds)
        if stamp - self._drawn < self.config.map_update_interval:
            self._owes_redraw = True
            return
        self._drawn = stamp
        self._draw(is_other or self._owes_redraw, changed)

    def _draw(self, whole: bool, changed: NDArray[np.bool_]) -> None:
        """Draw the best particle's map, all of it or the tiles that changed."""
        config = self._grid.config
        if whole:
            self._grid.log_odds[:] = 0.0
            self._grid.redraws += 1
            self._owes_redraw = False
        self.filter.maps.draw(
            self.filter.best,
            np.ones_like(changed) if whole else changed,
            self._grid,
            self.config.occ_thresh,
            config.occupied_above + SURE,
            config.free_below - SURE,
        )

    def _pose_at(self, pose_odom: Pose) -> Pose:
        """Where the robot is in the map when the odometry has it at a pose ``(3,)``."""
        best = self.filter.paths.newest[self.filter.best]
        return compose(best, between(self._reference_odom, pose_odom))
