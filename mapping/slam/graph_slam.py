"""Graph SLAM: scans matched with the local map in front, GTSAM behind, the map drawn anew between.

Every match is an edge of a graph of keyframes; places seen before add edges that close loops, and
the poses that agree best with all of them are where the map is drawn from.
"""

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import ArrayLike

from mapping.errors import TestbedError
from mapping.geometry import Pose, between, compose
from mapping.grid import GridConfig
from mapping.slam.loop_closer import LoopCloser, LoopConfig
from mapping.slam.metric_scale import MetricScaleConfig, lidar_scale_error
from mapping.slam.pose_graph_optimizer import PoseGraphOptimizer
from mapping.slam.scan_cloud import ScanCloud
from mapping.slam.scan_match import ScanMatch
from mapping.slam.scan_match_config import ScanMatchConfig
from mapping.slam.sweep import Sweep


@dataclass(frozen=True, slots=True, kw_only=True)
class GraphConfig(ScanMatchConfig):
    """Settings of graph SLAM; the default is a Burger."""

    way: float = 8.0
    """Keyframes farther away along the matches than this [m] are no part of the local map until a
    loop is closed."""
    rest: int = 2
    """After a loop, so many keyframes look for none."""
    redraw_above: float = 0.02
    """The map is drawn anew when something in it lies farther than this from its place [m]."""
    redraw_sweeps: int = 3
    """So many scans of the new map are drawn in one update."""
    keep_shift: float = 0.08
    """A scan is kept for drawing when the robot moved this far since the last one kept [m]."""
    keep_turn: float = 0.15
    """Or turned so far [rad]."""
    kept_each: int = 6
    """At most so many are kept for each keyframe."""
    refine: bool = True
    """Whether the finished map's surfaces are moved to where all kept scans say."""
    last_rounds: int = 10
    """Steps of the last optimisation."""
    scale_step: float = 2e-4
    """A change of the metric scale by less than this is none: 5 mm over 25 m."""
    metric_scale: MetricScaleConfig = field(default_factory=MetricScaleConfig)
    loops: LoopConfig = field(default_factory=LoopConfig)

    def __post_init__(self) -> None:
        """Refuse figures that make no mapper, or a map that is never drawn to its end."""
        ScanMatchConfig.__post_init__(self)
        for name in ("redraw_sweeps", "kept_each", "last_rounds"):
            if getattr(self, name) < 1:
                raise TestbedError(f"{name}: {getattr(self, name)}; must be at least 1")
        for name in ("rest", "redraw_above", "keep_shift", "keep_turn", "scale_step"):
            if not getattr(self, name) >= 0.0:
                raise TestbedError(f"{name}: {getattr(self, name)}; must be a number, 0 or more")


class GraphSlam(ScanMatch):
    """Scan matching that closes loops."""

    config: GraphConfig

    def __init__(
        self,
        config: GraphConfig | None = None,
        *,
        start_pose_map: ArrayLike = (0.0, 0.0, 0.0),
        grid: GridConfig | None = None,
    ) -> None:
        config = config or GraphConfig()
        super().__init__(config, start_pose_map=start_pose_map, grid=grid)
        self.loops = 0
        """How many edges that close loops there are."""
        self._closer = LoopCloser(self.graph, config.local_map, config.matcher, config.loops)
        self._optimizer = PoseGraphOptimizer()
        self._resting = 0
        self._may_keep = 0
        self._kept_pose: Pose | None = None

    def finish(self) -> None:
        """Optimise to the end, draw the map anew if it is off, and refine its surfaces."""
        if self.loops:
            self._correct(self._nearest, self.config.last_rounds)
        self.painter.scale = self._metric_scale()
        if self.painter.is_redrawing or self.painter.error > self.grid.resolution:
            self.painter.redraw()
            self.painter.work(len(self.painter))
        if self.config.refine:
            self.painter.refine()
        self.pose_map = self._pose_now()

    def _add_keyframe(self, cloud: ScanCloud) -> int:
        """Also look whether the keyframe closes a loop."""
        number = super()._add_keyframe(cloud)
        self._may_keep, self._kept_pose = self.config.kept_each, None
        scale = self._metric_scale()
        if abs(scale - self.painter.scale) > self.config.scale_step:
            self.painter.scale = scale
        self._resting = max(self._resting - 1, 0)
        if self._resting == 0 and self._can_match(cloud):
            self._close_loops(number)
        return number

    def _metric_scale(self) -> float:
        """What a metre of the lidar is [m], by what the wheels say of the same ways."""
        config = self.config
        difference, variance = self.way_disagreement
        error = lidar_scale_error(
            difference, variance, config.range_noise.scale_sigma, config.metric_scale
        )
        return 1.0 / (1.0 + error)

    def _close_loops(self, number: int) -> None:
        edges = self._closer.edges(number, self._tracker.local.keyframes)
        for edge in edges:
            self.graph.connect(edge)
        if edges:
            self.loops += len(edges)
            self._resting = self.config.rest
            self._correct(number)

    def _correct(self, reference: int, rounds: int = 1) -> None:
        """Move the keyframes to where all edges agree best, and the robot with one of them."""
        place = between(self.graph.poses[reference], self._tracker.pose)
        self.graph.correct(self._optimizer.optimize(self.graph.poses, self.graph.edges, rounds))
        self._tracker.pose = compose(self.graph.poses[reference], place)

    def _keep(self, sweep: Sweep) -> None:
        """Keep the scan if it shows something new; go on drawing the new map, or begin one."""
        config = self.config
        if self._may_keep > 0 and self._moved_enough():
            self._may_keep -= 1
            self._kept_pose = self._tracker.pose
            self.painter.keep(self._nearest, self._tracker.pose, sweep)
        self.painter.work(config.redraw_sweeps)
        if not self.painter.is_redrawing and self.painter.error > config.redraw_above:
            self.painter.redraw()

    def _moved_enough(self) -> bool:
        """Whether the robot has moved since the last scan that was kept."""
        if self._kept_pose is None:
            return True
        x, y, turn = between(self._kept_pose, self._tracker.pose)
        return bool(np.hypot(x, y) > self.config.keep_shift or abs(turn) > self.config.keep_turn)
