"""Mapping by matching every scan with the map of the scans before it.

Odometry and gyroscope say about where the robot is, matching says it exactly. What was drawn stays
where it is: this mapper closes no loops (``graph_slam`` does).
"""

from array import array
from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from mapping.geometry import Pose, between, compose
from mapping.grid import GridConfig, OccupancyGrid
from mapping.messages import Imu, LaserScan, Odometry
from mapping.odometry_mapper import checked_pose
from mapping.ogm import growing_grid
from mapping.pose_history import PoseHistory
from mapping.sensor_model import read_beams
from mapping.slam.keyframe_graph import KeyframeGraph, edge_between, view_of
from mapping.slam.map_painter import MapPainter
from mapping.slam.scan_cloud import ScanCloud, make_cloud
from mapping.slam.scan_match_config import ScanMatchConfig
from mapping.slam.scan_tracker import ScanTracker
from mapping.slam.sweep import Sweep, make_sweep

EDGE_FLOOR = np.diag(np.square([0.01, 0.01, 0.004]))
"""No keyframe is surer of its place among the others, whose errors it shares [m^2, m^2, rad^2]."""

RECKONED_FLOOR = np.diag(np.square([0.005, 0.005, 3e-4]))
"""Nor is a motion that was reckoned [m^2, m^2, rad^2]."""

FAR_APART = 2.0
"""Of a scan that the map explains, keyframes may be so many times as far apart."""

OLD = 20
"""A keyframe with so many after it is an old one."""


class ScanMatch:
    """Matches scans with the keyframes around, draws them, and takes new keyframes.

    A scan is dropped, and counted in ``scans_dropped``, when its stamp is older than the newest
    seen or not finite, when there is no odometry for it, when an angle of it is not finite, or when
    no beam of it tells anything. A scan that cannot be matched is taken to be where the odometry
    says.
    """

    def __init__(
        self,
        config: ScanMatchConfig | None = None,
        *,
        start_pose_map: ArrayLike = (0.0, 0.0, 0.0),
        grid: GridConfig | None = None,
    ) -> None:
        self.config = config or ScanMatchConfig()
        start = checked_pose("start_pose_map", start_pose_map)
        self.graph = KeyframeGraph()
        self.painter = MapPainter(
            OccupancyGrid(grid or growing_grid(start)), self.config.drawing, self.graph
        )
        self.updates = 0
        self.scans_dropped = 0
        self.pose_map: Pose = start
        """The newest pose in the map frame ``(3,)``; the start pose before any odometry."""
        self._tracker = ScanTracker(self.config, self.graph, start)
        self._newest_scan = -np.inf
        self._nearest = 0
        self._history = PoseHistory()
        self._references = array("i")

    @property
    def grid(self) -> OccupancyGrid:
        """The map so far."""
        return self.painter.grid

    @property
    def way_disagreement(self) -> tuple[float, float]:
        """How much longer ways are by matching than by the odometry, relative; and its variance."""
        return self._tracker.way_disagreement

    @property
    def trajectory(self) -> PoseHistory:
        """Poses at the stamps of the scans, each where its keyframe is believed to be now."""
        if len(self._history) == 0:
            return PoseHistory()
        references = np.array(self._references)
        poses = compose(self.graph.poses[references], self._history.poses)
        return PoseHistory.of(self._history.stamps, self.painter.corrected(poses))

    def update(
        self, scan: LaserScan | None, odometry: Sequence[Odometry], imu: Sequence[Imu] = ()
    ) -> None:
        """Take the messages of one control period."""
        self._tracker.add(odometry, imu)
        if scan is not None and scan.stamp != self._newest_scan:
            if scan.stamp > self._newest_scan and self._take(scan):
                self.updates += 1
            else:
                self.scans_dropped += 1
        self.pose_map = self._pose_now()

    def finish(self) -> None:
        """Nothing is put off."""

    def _take(self, scan: LaserScan) -> bool:
        """Match a new scan and draw it; False when it cannot be used."""
        self._newest_scan = scan.stamp
        if not np.all(np.isfinite(scan.angles)):
            return False
        beams = read_beams(scan, self.config.max_range)
        stamps = np.append(scan.stamp, scan.beam_stamps[beams.indices])
        poses_odom = self._tracker.poses_at(stamps)
        if poses_odom is None or len(beams.indices) == 0:
            return False
        poses_base = between(poses_odom[0], poses_odom[1:])
        config = self.config
        cloud = make_cloud(
            scan,
            beams,
            poses_base,
            lidar_pose_base=config.lidar_pose_base,
            range_noise=config.range_noise,
            resolution=config.cell,
            reach=config.reach,
        )
        score = self._tracker.locate(cloud, poses_odom[0], self._nearest)
        self._note(scan.stamp, cloud, make_sweep(scan, beams, poses_base), score)
        return True

    def _note(self, stamp: float, cloud: ScanCloud, sweep: Sweep, score: float) -> None:
        """Draw a scan where it was found; make it a keyframe if there is none like it."""
        if self._is_new(cloud, score):
            self._nearest = self._add_keyframe(cloud)
        graph = self.graph
        self._history.add(stamp, between(graph.poses[self._nearest], self._tracker.pose))
        self._references.append(self._nearest)
        self.painter.paint(sweep, self.painter.to_map(self._nearest, self._tracker.pose))
        self._keep(sweep)

    def _is_new(self, cloud: ScanCloud, score: float) -> bool:
        """Whether the map has no keyframe like this scan; notes the nearest one.

        One that sees too little to be matched becomes a keyframe too, or a hall wider than the
        lidar sees would be a single step from wall to wall that no loop can bend.
        """
        graph, config = self.graph, self.config
        if len(graph) == 0:
            return True
        known = self._tracker.local.keyframes or [self._nearest]
        offsets = graph.poses[known, :2] - self._tracker.pose[:2]
        distances = np.hypot(offsets[:, 0], offsets[:, 1])
        turned = np.abs(
            np.remainder(graph.poses[known, 2] - self._tracker.pose[2] + np.pi, 2 * np.pi) - np.pi
        )
        costs = distances / config.keyframe_distance
        can_match = self._can_match(cloud)
        if can_match and not cloud.looks_around:
            costs = costs + turned / config.keyframe_turn
        nearest = int(np.argmin(costs))
        self._nearest = known[nearest]
        apart = 1.0 if can_match and score < config.explained else FAR_APART
        return bool(costs[nearest] > apart)

    def _can_match(self, cloud: ScanCloud) -> bool:
        """Whether it shows enough to be matched, or to match others with."""
        return len(cloud) >= self.config.matcher.least_points

    def _add_keyframe(self, cloud: ScanCloud) -> int:
        """Make the newest scan a keyframe, tied to those that it was matched with."""
        graph, pose = self.graph, self._tracker.pose
        ties = self._ties(view_of(pose, cloud)) if len(graph) and self._can_match(cloud) else []
        number = graph.add(pose, cloud)
        covariance = (self._tracker.covariance + EDGE_FLOOR) * max(len(ties), 1)
        for other in ties:
            graph.connect(edge_between(other, number, graph.poses[other], pose, covariance))
        if number > 0:
            self._connect_reckoned(number)
        return number

    def _connect_reckoned(self, number: int) -> None:
        """Tie a keyframe to the one before it by odometry and gyroscope alone.

        They know nothing of walls, and the gyroscope's heading hardly drifts: no chain of matches
        and no false loop turns the map against it.
        """
        tracker = self._tracker
        covariance = tracker.reckoned_covariance + RECKONED_FLOOR
        edge = edge_between(number - 1, number, np.zeros(3), tracker.reckoned, covariance)
        self.graph.connect(edge)
        tracker.forget_reckoned()

    def _ties(self, view: NDArray[np.float64]) -> list[int]:
        """The keyframes that a new one is tied to: newest, nearest, and nearest of the old ones.

        None that shows too little to be matched with: where it is, no match has told.
        """
        graph = self.graph
        known = np.array(self._tracker.local.keyframes or [self._nearest])
        known = known[[self._can_match(graph.clouds[k]) for k in known]]
        if len(known) == 0:
            return []
        away = np.hypot(*(graph.views[known] - view).T)
        ties = {int(known.max()), int(known[np.argmin(away)])}
        if self._nearest in known:
            ties.add(self._nearest)
        old = known < len(graph) - OLD
        if np.any(old):
            ties.add(int(known[old][np.argmin(away[old])]))
        return sorted(ties)

    def _keep(self, sweep: Sweep) -> None:
        """A map that is never drawn anew needs no scans."""

    def _pose_now(self) -> Pose:
        """The newest pose: that of the last scan, and on from there as the odometry says."""
        motion, pose = self._tracker.motion_since_scan(), self._tracker.pose
        if motion is None:
            return self.pose_map
        if len(self.graph) > 0:
            pose = self.painter.to_map(self._nearest, pose)
        return compose(pose, motion)
