"""What mapping by scan matching believes and how fine it is; the default is a Burger."""

import math
from dataclasses import dataclass, field

from mapping.burger import LIDAR_POSE_BASE, LIDAR_RANGE_MAX
from mapping.errors import TestbedError
from mapping.odometry_mapper import checked_pose
from mapping.ogm import OgmConfig
from mapping.sensor_model import LDS_01, RangeNoise
from mapping.slam.fusion_config import FusionConfig
from mapping.slam.local_map import LocalMapConfig
from mapping.slam.odometry_calibration import CalibrationConfig
from mapping.slam.scan_matcher import MatcherConfig

FARTHEST_POINT = 30.0
"""Points farther away are not matched [m] [assumption: of 15, 22, 30 and 45, it held best on the
whole on simulated logs of a SICK]: a degree of yaw moves them by ten cells. In a hall of 35 m the
end walls alone tell how far along it the robot is."""

FINE_CELL, COARSE_CELL = 0.03, 0.05
"""Cells of the field [m] for an LDS-01 at 5 Hz, and for lidars of which nothing is known. The bells
are as wide: the narrower, the less a wall draws what lies beside it; but a prediction must fall
within them."""


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
    """Edge of a cell of the field that scans are matched with [m]; None takes 3 cm for an LDS-01
    and 5 cm for other lidars, whose scans may come seldom and from anywhere."""
    local_keyframes: int = 15
    """A scan is matched with at most so many keyframes."""
    keyframe_distance: float = 0.3
    """A scan taken farther than this from every keyframe near by becomes one [m]."""
    keyframe_turn: float = 0.3
    """So does one that looks another way by this angle [rad]."""
    explained: float = 0.9
    """Of a scan that the map explains to this share, keyframes may be twice as far apart."""
    way: float = math.inf
    """Keyframes farther away along the matches than this [m] are no part of the local map; without
    loops to close, all are trusted to be in place."""
    matcher: MatcherConfig = field(default_factory=MatcherConfig)
    fusion: FusionConfig = field(default_factory=FusionConfig)
    calibration: CalibrationConfig = field(default_factory=CalibrationConfig)

    def __post_init__(self) -> None:
        """Refuse figures that make no mapper."""
        for name in ("max_range", "cell", "keyframe_distance", "keyframe_turn"):
            value = getattr(self, name)
            if not (math.isfinite(value) and value > 0.0):
                raise TestbedError(f"{name}: {value}; must be a finite number above 0")
        for name in ("explained", "way"):
            if not getattr(self, name) > 0.0:
                raise TestbedError(f"{name}: {getattr(self, name)}; must be a number above 0")
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

    @property
    def local_map(self) -> LocalMapConfig:
        """The neighbourhood to match with."""
        return LocalMapConfig(
            resolution=self.cell, reach=self.reach, keyframes=self.local_keyframes, way=self.way
        )
