"""Mapping by matching every scan with the map of the scans before it.

Odometry and gyroscope say about where the robot is, matching says it exactly. What was drawn stays
where it is: this mapper closes no loops (``graph_slam`` does).
"""

import math
from array import array
from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import ArrayLike, NDArray

from mapping.burger import LIDAR_POSE_BASE, LIDAR_RANGE_MAX
from mapping.errors import TestbedError
from mapping.geometry import Pose, between, compose
from mapping.grid import GridConfig, OccupancyGrid
from mapping.messages import Imu, LaserScan, Odometry
from mapping.odometry_mapper import checked_pose
from mapping.ogm import OgmConfig, growing_grid
from mapping.pose_history import PoseHistory
from mapping.sensor_model import LDS_01, RangeNoise, read_beams
from mapping.slam.fusion import FusedTrack
from mapping.slam.fusion_config import FusionConfig
from mapping.slam.keyframe_graph import KeyframeGraph, edge_between, look_of
from mapping.slam.local_map import LocalMap, LocalMapConfig
from mapping.slam.map_painter import MapPainter
from mapping.slam.odometry_calibration import CalibrationConfig, OdometryCalibration
from mapping.slam.scan_cloud import ScanCloud, make_cloud
from mapping.slam.scan_matcher import MatcherConfig, match_scan
from mapping.slam.sweep import Sweep, make_sweep

FARTHEST_POINT = 15.0
"""Points farther away are not matched [m]: a degree of yaw moves them by five cells."""

FINE_CELL, COARSE_CELL = 0.03, 0.05
"""Cells of the field [m] for an LDS-01 at 5 Hz, and for lidars of which nothing is known. The bells are as wide: the narrower, the less
a wall draws what lies beside it; but a prediction must fall within them."""

START_COVARIANCE = np.diag(np.square([0.004, 0.004, 0.0015]))
"""How sure the first pose is: as sure as the first match will be [m^2, m^2, rad^2]."""

EDGE_FLOOR = np.diag(np.square([0.01, 0.01, 0.004]))
"""No keyframe is surer of its place among the others, whose errors it takes over [m^2, m^2, rad^2]."""

STILL_SHIFT, STILL_TURN = 5e-4, 5e-4
"""A robot that moved less than this [m, rad] since its last scan is where it was."""

OLD = 20
"""A keyframe with so many after it is an old one."""


@dataclass(frozen=True, slots=True, kw_only=True)
class ScanMatchConfig:
    """Settings of mapping by scan matching; the default is a Burger."""

    max_range: float = LIDAR_RANGE_MAX
    """Farther readings only clear space, up to here [m]."""
    lidar_pose_base: tuple[float, float, float] = LIDAR_POSE_BASE
    """The lidar's pose in base_footprint."""
    range_noise: RangeNoise = LDS_01
    """How far the lidar's readings scatter."""
    field_resolution: float | None = None
    """Edge of a cell of the field that scans are matched with [m]; None takes 3 cm for an LDS-01 and
    5 cm for other lidars, whose scans may come seldom and from anywhere."""
    local_keyframes: int = 15
    """A scan is matched with at most so many keyframes."""
    keyframe_distance: float = 0.3
    """A scan taken farther than this from every keyframe near by becomes one [m]."""
    keyframe_turn: float = 0.3
    """So does one that looks another way by this angle [rad]."""
    explained: float = 0.9
    """Of a scan that the map explains to this share, keyframes may be twice as far apart."""
    matcher: MatcherConfig = field(default_factory=MatcherConfig)
    fusion: FusionConfig = field(default_factory=FusionConfig)
    calibration: CalibrationConfig = field(default_factory=CalibrationConfig)

    def __post_init__(self) -> None:
        """Refuse figures that make no mapper."""
        for name in ("max_range", "cell", "keyframe_distance", "keyframe_turn"):
            value = getattr(self, name)
            if not (math.isfinite(value) and value > 0.0):
                raise TestbedError(f"{name}: {value}; must be a finite number above 0")
        if self.local_keyframes < 1:
            raise TestbedError(f"local_keyframes: {self.local_keyframes}; must be at least 1")
        checked_pose("lidar_pose_base", self.lidar_pose_base)

    @property
    def reach(self) -> float:
        """How far from the robot points are matched [m]."""
        return min(self.max_range, FARTHEST_POINT)

    @property
    def cell(self) -> float:
        """Edge of a cell of the field [m]."""
        if self.field_resolution is not None:
            return self.field_resolution
        return FINE_CELL if self.range_noise == LDS_01 else COARSE_CELL

    @property
    def drawing(self) -> OgmConfig:
        """How the map is drawn."""
        return OgmConfig(
            max_range=self.max_range,
            lidar_pose_base=self.lidar_pose_base,
            range_noise=self.range_noise,
        )


class ScanMatch:
    """Matches scans with the keyframes around, draws them, and takes new keyframes.

    A scan is dropped, and counted in ``scans_dropped``, when its stamp is older than the newest
    seen or not finite, when there is no odometry for it, or when no beam of it tells anything. A
    scan that cannot be matched is taken to be where the odometry says.
    """

    way = np.inf
    """How far along the matches keyframes are trusted to be in place [m]: all of them are."""

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
        self._track = FusedTrack(self.config.fusion)
        self._calibration = OdometryCalibration(self.config.calibration)
        self._local = LocalMap(self.graph, self._local_config())
        self._has_gyro = False
        self._newest_scan = -np.inf
        self._pose = start
        self._covariance = START_COVARIANCE
        self._scan_odom: Pose | None = None
        self._nearest = 0
        self._history = PoseHistory()
        self._references = array("i")

    @property
    def grid(self) -> OccupancyGrid:
        """The map so far."""
        return self.painter.grid

    @property
    def trajectory(self) -> PoseHistory:
        """Poses at the stamps of the scans, each where its keyframe is believed to be now."""
        if len(self._history) == 0:
            return PoseHistory()
        references = np.array(self._references)
        poses = compose(self.graph.poses[references], self._history.poses)
        return PoseHistory.of(self._history.stamps, poses)

    def update(
        self, scan: LaserScan | None, odometry: Sequence[Odometry], imu: Sequence[Imu] = ()
    ) -> None:
        """Take the messages of one control period."""
        self._track.add(odometry, imu)
        self._has_gyro = self._has_gyro or len(imu) > 0
        if scan is not None and scan.stamp != self._newest_scan:
            if scan.stamp > self._newest_scan and self._take(scan):
                self.updates += 1
            else:
                self.scans_dropped += 1
        self.pose_map = self._pose_now()

    def finish(self) -> None:
        """Nothing is put off."""

    def _local_config(self) -> LocalMapConfig:
        config = self.config
        return LocalMapConfig(
            resolution=config.cell,
            reach=config.reach,
            keyframes=config.local_keyframes,
            way=self.way,
        )

    def _take(self, scan: LaserScan) -> bool:
        """Match a new scan and draw it; False when it cannot be used."""
        self._newest_scan = scan.stamp
        beams = read_beams(scan, self.config.max_range)
        stamps = np.append(scan.stamp, scan.beam_stamps[beams.indices])
        poses_odom = self._track.poses_at(stamps)
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
        sweep = make_sweep(scan, beams, poses_base)
        score = self._locate(cloud, poses_odom[0])
        self._note(scan.stamp, cloud, sweep, score)
        return True

    def _locate(self, cloud: ScanCloud, pose_odom: Pose) -> float:
        """Find where a scan was taken; returns which share of it the map explains."""
        last = self._scan_odom
        if last is None:
            self._pose, self._scan_odom = compose(self._pose, pose_odom), pose_odom
            self._track.mark()
            return 0.0
        motion = between(last, pose_odom)
        if _is_still(motion):
            return 1.0
        spread, self._scan_odom = self._track.motion_covariance(), pose_odom
        self._track.mark()
        predicted = compose(self._pose, self._calibration.corrected(motion))
        spread = self._calibration.widened(motion, spread, has_gyro=self._has_gyro)
        covariance = _carried(self._covariance, self._pose, predicted, spread)
        self._local.follow(self._nearest, _view(predicted, cloud))
        match = match_scan(self._local.field, cloud, predicted, covariance, self.config.matcher)
        if not match.refused:
            self._calibration.learn(
                motion, between(self._pose, match.seen), covariance + match.seen_covariance
            )
        self._pose = match.pose
        self._covariance = match.covariance
        return match.score

    def _note(self, stamp: float, cloud: ScanCloud, sweep: Sweep, score: float) -> None:
        """Draw a scan where it was found; make it a keyframe if there is none like it."""
        if self._is_new(cloud, score):
            self._nearest = self._add_keyframe(cloud)
        graph = self.graph
        self._history.add(stamp, between(graph.poses[self._nearest], self._pose))
        self._references.append(self._nearest)
        self.painter.paint(sweep, self.painter.to_map(self._nearest, self._pose))
        self._keep(sweep)

    def _is_new(self, cloud: ScanCloud, score: float) -> bool:
        """Whether the map has no keyframe like this scan; notes the nearest one."""
        graph, config = self.graph, self.config
        if len(graph) == 0:
            return True
        known = self._local.keyframes or [self._nearest]
        offsets = graph.poses[known, :2] - self._pose[:2]
        distances = np.hypot(offsets[:, 0], offsets[:, 1])
        turned = np.abs(
            np.remainder(graph.poses[known, 2] - self._pose[2] + np.pi, 2 * np.pi) - np.pi
        )
        costs = distances / config.keyframe_distance
        if not cloud.looks_around:
            costs = costs + turned / config.keyframe_turn
        nearest = int(np.argmin(costs))
        self._nearest = known[nearest]
        return bool(costs[nearest] > (2.0 if score >= config.explained else 1.0))

    def _add_keyframe(self, cloud: ScanCloud) -> int:
        """Make the newest scan a keyframe, tied to those that it was matched with."""
        graph = self.graph
        ties = self._ties(_view(self._pose, cloud)) if len(graph) else []
        number = graph.add(self._pose, cloud)
        for other in ties:
            covariance = (self._covariance + EDGE_FLOOR) * len(ties)
            graph.connect(edge_between(other, number, graph.poses[other], self._pose, covariance))
        return number

    def _ties(self, view: NDArray[np.float64]) -> list[int]:
        """The keyframes that a new one is tied to: newest, nearest, and nearest of the old ones."""
        graph = self.graph
        known = np.array(self._local.keyframes or [self._nearest])
        away = np.hypot(*(graph.views[known] - view).T)
        ties = {int(known.max()), int(known[np.argmin(away)]), self._nearest}
        old = known < len(graph) - OLD
        if np.any(old):
            ties.add(int(known[old][np.argmin(away[old])]))
        return sorted(ties)

    def _keep(self, sweep: Sweep) -> None:
        """A map that is never drawn anew needs no scans."""

    def _pose_now(self) -> Pose:
        """The newest pose: that of the last scan, and on from there as the odometry says."""
        newest = self._track.newest
        if newest is None:
            return self.pose_map
        if self._scan_odom is None:
            return compose(self._pose, newest)
        motion = self._calibration.corrected(between(self._scan_odom, newest))
        return compose(self.painter.to_map(self._nearest, self._pose), motion)


def _view(pose: Pose, cloud: ScanCloud) -> NDArray[np.float64]:
    """The middle of what a scan saw from a pose ``(2,)``."""
    return compose(pose, np.append(look_of(cloud), 0.0))[:2]


def _is_still(motion: Pose) -> bool:
    return math.hypot(motion[0], motion[1]) < STILL_SHIFT and abs(motion[2]) < STILL_TURN


def _carried(
    covariance: NDArray[np.float64], pose: Pose, moved: Pose, spread: NDArray[np.float64]
) -> NDArray[np.float64]:
    """The covariance after a motion, in the map frame."""
    dx, dy = moved[:2] - pose[:2]
    cos, sin = math.cos(pose[2]), math.sin(pose[2])
    carry = np.array([[1.0, 0.0, -dy], [0.0, 1.0, dx], [0.0, 0.0, 1.0]])
    turn = np.array([[cos, -sin, 0.0], [sin, cos, 0.0], [0.0, 0.0, 1.0]])
    return np.asarray(carry @ covariance @ carry.T + turn @ spread @ turn.T)
