"""Compares a map file with a floor plan or with another map file."""

from dataclasses import dataclass
from pathlib import Path

from envs.truth import truth_of_plan
from envs.worlds import load_world
from mapping.align import Alignment, align_map
from mapping.compare import MapScores, score_map
from mapping.errors import TestbedError
from mapping.grid import OCCUPIED, UNKNOWN
from mapping.io.map_server import MapFile, read_map
from mapping.truth import TruthMap, truth_map


@dataclass(frozen=True, slots=True, kw_only=True)
class Comparison:
    """A map, the truth it was held against, and how well it did."""

    map_file: MapFile
    truth: TruthMap
    scores: MapScores
    """As the map lies."""
    alignment: Alignment | None
    """Where it fits best and its scores there; None when not asked for or without walls."""


def compare_map(
    map_path: Path,
    *,
    world: str | None = None,
    truth_path: Path | None = None,
    align: bool = False,
) -> Comparison:
    """Score a map_server map.

    Args:
        map_path: The map's YAML.
        world: Floor plan to score against, a built-in name or a file.
        truth_path: Or another map_server map; all of its free space counts, since no start is
            known, and what is unknown in it counts for nothing.
        align: Whether to look for the pose that fits best as well.

    Raises:
        TestbedError: If a file cannot be used, or not exactly one truth is given.
    """
    if (world is None) == (truth_path is None):
        raise TestbedError("give one truth: --world NAME_OR_FILE or --truth MAP.yaml")
    map_file = read_map(map_path)
    if world is not None:
        truth = truth_of_plan(load_world(world), resolution=map_file.resolution)
    else:
        assert truth_path is not None
        truth = _truth_of_map(read_map(truth_path))
    return Comparison(
        map_file=map_file,
        truth=truth,
        scores=score_map(map_file, truth),
        alignment=align_map(map_file, truth) if align else None,
    )


def _truth_of_map(map_file: MapFile) -> TruthMap:
    return truth_map(
        map_file.states == OCCUPIED,
        resolution=map_file.resolution,
        origin=map_file.origin,
        start=None,
        unknown=map_file.states == UNKNOWN,
    )
