"""Makes a mapper by its name."""

from collections.abc import Mapping
from dataclasses import dataclass, fields, replace
from typing import Any, TypeVar

from numpy.typing import ArrayLike

from mapping.errors import TestbedError
from mapping.grid import GridConfig
from mapping.mapper import Mapper
from mapping.occ_grid_mapp import OccGridMapp, OccGridMappConfig
from mapping.odometry_mapper import checked_pose
from mapping.ogm import Ogm, OgmConfig, growing_grid
from mapping.slam.gmapping import Gmapping
from mapping.slam.gmapping_config import GmappingConfig
from mapping.slam.graph_slam import GraphConfig, GraphSlam
from mapping.slam.scan_match import ScanMatch
from mapping.slam.scan_match_config import ScanMatchConfig

Config = TypeVar(
    "Config", OgmConfig, OccGridMappConfig, ScanMatchConfig, GmappingConfig, GraphConfig
)

THESIS_SIDE = 50.0
"""Edge of the thesis's grid [m] (4.3.2), kept at other resolutions."""


LEAST_RESOLUTION, MOST_RESOLUTION = 0.002, 0.5
"""Edges of a cell that a run may ask for [m]: below any lidar's noise, and as wide as a door."""


def check_resolution(resolution: float | None) -> None:
    """Refuse an edge of a cell [m] that makes no map; None, a mapper's own, passes."""
    if resolution is not None and not LEAST_RESOLUTION <= resolution <= MOST_RESOLUTION:
        raise TestbedError(
            f"resolution: {resolution} m; must be {LEAST_RESOLUTION} to {MOST_RESOLUTION}"
        )


def make_mapper(
    name: str,
    *,
    start_pose_map: ArrayLike = (0.0, 0.0, 0.0),
    resolution: float | None = None,
    grid: GridConfig | None = None,
    settings: Mapping[str, Any] | None = None,
) -> Mapper:
    """Make the mapper called ``name``.

    Args:
        name: One of MAPPERS.
        start_pose_map: Where the robot stands in the map frame when its odometry starts:
            x [m], y [m], yaw [rad].
        resolution: Edge of a cell [m] of the mapper's own grid; None keeps its default: 5 cm for
            gmapping, 1 cm for the others.
        grid: The whole grid instead; ``resolution`` must then be None.
        settings: Fields of the mapper's config that differ from their defaults.

    Raises:
        TestbedError: No such mapper or setting, or a value that makes none.
    """
    if name not in MAPPERS:
        raise TestbedError(f"mapper: {name!r}; must be one of {', '.join(MAPPERS)}")
    if grid is not None and resolution is not None:
        raise TestbedError(f"resolution: {resolution} m; must not be given beside a grid")
    if resolution is not None:
        GridConfig(resolution=resolution)  # refuses what makes no grid, before it is divided by
    return MAPPERS[name](
        checked_pose("start_pose_map", start_pose_map), resolution, grid, settings or {}
    )


def _make_occ_grid_mapp(
    start: ArrayLike, resolution: float | None, grid: GridConfig | None, settings: Mapping[str, Any]
) -> Mapper:
    config = _configured(OccGridMappConfig(), settings)
    if resolution is not None:
        config = replace(config, resolution=resolution, cells=round(THESIS_SIDE / resolution))
    return OccGridMapp(config, start_pose_map=start, grid=grid)


def _make_ogm(
    start: ArrayLike, resolution: float | None, grid: GridConfig | None, settings: Mapping[str, Any]
) -> Mapper:
    config = _configured(OgmConfig(), settings)
    return Ogm(config, start_pose_map=start, grid=grid or growing_grid(start, resolution))


def _make_scan_match(
    start: ArrayLike, resolution: float | None, grid: GridConfig | None, settings: Mapping[str, Any]
) -> Mapper:
    config = _configured(ScanMatchConfig(), settings)
    return ScanMatch(config, start_pose_map=start, grid=grid or growing_grid(start, resolution))


def _make_gmapping(
    start: ArrayLike, resolution: float | None, grid: GridConfig | None, settings: Mapping[str, Any]
) -> Mapper:
    config = _configured(GmappingConfig(), settings)
    if resolution is not None:
        config = replace(config, delta=resolution)
    return Gmapping(config, start_pose_map=start, grid=grid)


def _make_graph(
    start: ArrayLike, resolution: float | None, grid: GridConfig | None, settings: Mapping[str, Any]
) -> Mapper:
    config = _configured(GraphConfig(), settings)
    return GraphSlam(config, start_pose_map=start, grid=grid or growing_grid(start, resolution))


def _configured(config: Config, settings: Mapping[str, Any]) -> Config:
    """The config with settings changed, or one clear error about a setting that there is not."""
    known = [field.name for field in fields(config)]
    for name in settings:
        if name not in known:
            raise TestbedError(f"mapper setting: {name!r}; must be one of {', '.join(known)}")
    return replace(config, **settings)


MAPPERS = {
    "graph": _make_graph,
    "gmapping": _make_gmapping,
    "scan_match": _make_scan_match,
    "ogm": _make_ogm,
    "occgridmapp": _make_occ_grid_mapp,
}
"""The mappers by name."""


@dataclass(frozen=True, slots=True)
class NoSettings:
    """What a mapper can be set to that is in MAPPERS alone."""


CONFIGS: dict[str, type] = {
    "graph": GraphConfig,
    "gmapping": GmappingConfig,
    "scan_match": ScanMatchConfig,
    "ogm": OgmConfig,
    "occgridmapp": OccGridMappConfig,
}
"""The class of each mapper's settings, for those that have any. A replay sets its ``max_range``,
``range_noise``, ``lidar_pose_base`` and ``seed``, if there are such, and what ``--set`` says."""
