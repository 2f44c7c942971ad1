"""Turns a replay into the flat table of ``result.json``, with the keys that an episode's has."""

from dataclasses import asdict
from typing import Any

import numpy as np

from envs.truth import truth_of_plan
from evaluation.replay import Replay
from evaluation.result import (
    map_scores,
    peak_rss_mb,
    percentile_ms,
    trajectory_scores,
    update_rates,
)
from evaluation.scores.clearance import min_clearance
from evaluation.scores.map_extent import map_length_error
from mapping.compare import score_map
from mapping.ghosts import ghost_area
from mapping.relations import score_relations
from mapping.trajectory import path_length
from mapping.truth import TruthMap

RELATION_KEYS = ("used", "trans_mean_m", "trans_std_m", "trans_max_m", "rot_mean_deg")
"""Scores of the relations that go into the table, as ``relations_...``."""


def truth_of(replay: Replay) -> TruthMap | None:
    """What the map is scored against; None but for a run folder whose floor plan is there."""
    plan = replay.recording.plan
    if plan is None:
        return None
    return truth_of_plan(plan, resolution=replay.grid.resolution)


def result_of_replay(
    replay: Replay,
    truth: TruthMap | None,
    map_file_kb: float | None,
    map_reloads: bool | None = None,
) -> dict[str, Any]:
    """Every key of ``result.json``; a value that cannot exist is None, never 0.

    Beside an episode's keys stand ``log`` and the ``relations_...``. What a robot did comes from
    the true poses, or from the trajectory where there are none.

    Args:
        replay: A finished replay.
        truth: What its map is scored against, of ``truth_of``.
        map_file_kb: Size of the map's image file [kB], None when it was not written.
        map_reloads: Whether an independent reader finds in that file what the map says.
    """
    config, recording = replay.config, replay.recording
    real = replay.trajectory if recording.ground_truth is None else recording.ground_truth
    seconds = replay.map_update_seconds
    plan = recording.plan
    scores = None if truth is None else score_map(replay.grid, truth)
    return {
        "log": str(config.log),
        "world": recording.world,
        "mapper": config.mapper,
        "navigator": None,
        "seed": config.seed,
        "stop_reason": replay.stop_reason,
        "sim_time_s": round(replay.log_time, 3),
        "wall_time_s": round(replay.wall_time, 3),
        "real_time_factor": round(replay.log_time / replay.wall_time, 1),
        "coverage": None if scores is None else scores.coverage,
        "t90_s": None,
        "t95_s": None,
        "t99_s": None,
        "t_ref95_s": None,
        "efficiency": None,
        "path_length_m": path_length(real.poses),
        "contacts": None,
        "contacts_by_people": None,
        "min_clearance_m": None if plan is None else min_clearance(real.poses, plan.solids()),
        **map_scores(scores),
        "ghost_area_m2": None if truth is None else ghost_area(replay.grid, truth),
        "map_length_error": None if truth is None else map_length_error(replay.grid, truth),
        **trajectory_scores(replay.trajectory, replay.online, recording.ground_truth),
        **_relation_scores(replay),
        "map_updates": replay.map_updates,
        "scans_dropped": replay.scans_dropped,
        "map_update_ms_p50": percentile_ms(seconds, 50),
        "map_update_ms_p99": percentile_ms(seconds, 99),
        "decision_ms_p50": None,
        "decision_ms_p99": None,
        "map_update_rate_hz": replay.map_updates / replay.log_time if replay.log_time else None,
        **update_rates(replay.map_update_stamps),
        "map_file_kb": map_file_kb,
        "map_reloads": map_reloads,
        "peak_rss_mb": peak_rss_mb(),
        "home_distance_m": float(np.hypot(*(real.poses[-1, :2] - real.poses[0, :2]))),
        "dropped_frontiers": None,
    }


def _relation_scores(replay: Replay) -> dict[str, float | None]:
    """Errors of the relations; all None when the replay was given none."""
    relations = replay.recording.relations
    if relations is None:
        return {f"relations_{key}": None for key in RELATION_KEYS}
    scores = asdict(score_relations(replay.trajectory, relations))
    return {f"relations_{key}": scores[key] for key in RELATION_KEYS}
