"""Turns an episode into the flat table of ``result.json``: counts, scores and timings."""

import resource
import sys
from dataclasses import asdict
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from evaluation.reference_tour.tour import reference_tour
from evaluation.scores.clearance import min_clearance
from evaluation.scores.map_extent import map_length_error
from mapping.compare import MapScores, score_map
from mapping.ghosts import ghost_area
from mapping.trajectory import Trajectory, path_length
from mapping.trajectory_scores import score_relative, score_trajectory

if TYPE_CHECKING:  # a replay needs no simulator, which an episode imports
    from evaluation.episode import Episode

TIMING_KEYS = (
    "wall_time_s",
    "real_time_factor",
    "map_update_ms_p50",
    "map_update_ms_p99",
    "decision_ms_p50",
    "decision_ms_p99",
    "peak_rss_mb",
)
"""Keys that differ between runs of the same seed; every other is the same to the last digit."""


def result_of(
    episode: "Episode", map_file_kb: float | None, map_reloads: bool | None = None
) -> dict[str, Any]:
    """Every key of ``result.json``; a value that cannot exist is None, never 0.

    Args:
        episode: A finished episode.
        map_file_kb: Size of the map's image file [kB], None when it was not written.
        map_reloads: Whether an independent reader finds in that file what the map says.
    """
    config, track = episode.config, episode.track
    poses_world = track.pose_world
    times = _times_of_coverage(episode)
    return {
        "world": config.world,
        "mapper": config.mapper,
        "navigator": config.navigator,
        "seed": config.seed,
        "stop_reason": episode.stop_reason,
        "sim_time_s": round(episode.sim_time, 3),
        "wall_time_s": round(episode.wall_time, 3),
        "real_time_factor": round(episode.sim_time / episode.wall_time, 1),
        "coverage": float(episode.coverages[-1]),
        **times,
        **_against_the_reference(episode, times["t95_s"]),
        "path_length_m": path_length(poses_world),
        "contacts": episode.contacts,
        "contacts_by_people": episode.contacts_by_people,
        "min_clearance_m": min_clearance(poses_world, episode.plan.solids()),
        **map_scores(score_map(episode.grid, episode.truth)),
        "ghost_area_m2": ghost_area(episode.grid, episode.truth),
        "map_length_error": map_length_error(episode.grid, episode.truth),
        **trajectory_scores(
            Trajectory(stamps=episode.trajectory.stamps, poses=episode.trajectory.poses),
            Trajectory(stamps=track.stamps, poses=track.pose_map),
            Trajectory(stamps=track.stamps, poses=poses_world),
        ),
        "map_updates": episode.map_updates,
        "scans_dropped": episode.scans_dropped,
        "map_update_ms_p50": percentile_ms(episode.map_update_seconds, 50),
        "map_update_ms_p99": percentile_ms(episode.map_update_seconds, 99),
        "decision_ms_p50": percentile_ms(episode.decision_seconds, 50),
        "decision_ms_p99": percentile_ms(episode.decision_seconds, 99),
        "map_update_rate_hz": episode.map_updates / episode.sim_time,
        **update_rates(episode.map_update_stamps),
        "map_file_kb": map_file_kb,
        "map_reloads": map_reloads,
        "peak_rss_mb": peak_rss_mb(),
        "home_distance_m": float(np.hypot(*(poses_world[-1, :2] - poses_world[0, :2]))),
        "dropped_frontiers": [asdict(frontier) for frontier in episode.dropped_frontiers],
    }


def _times_of_coverage(episode: "Episode") -> dict[str, float | None]:
    """When coverage first reached 90, 95 and 99 % [s], measured once a simulated second."""
    times: dict[str, float | None] = {}
    for share in (90, 95, 99):
        reached = np.flatnonzero(episode.coverages >= share / 100.0)
        times[f"t{share}_s"] = float(episode.coverage_times[reached[0]]) if len(reached) else None
    return times


def _against_the_reference(episode: "Episode", t95: float | None) -> dict[str, float | None]:
    """How fast one who knows the plan sees 95 % of it [s], and that time over the robot's own.

    ``t_ref95_s`` is None where no tour sees so much, 0 where the start does; there, and where the
    robot did not get so far, ``efficiency`` is None.
    """
    tour = reference_tour(episode.truth, episode.plan.start, share=0.95)
    t_ref95 = round(tour.time_s, 3) if tour.sees_share else None
    efficiency = t_ref95 / t95 if t_ref95 and t95 else None
    return {"t_ref95_s": t_ref95, "efficiency": efficiency}


def map_scores(scores: MapScores | None) -> dict[str, float | None]:
    """The scores of a map, but for its coverage; all None without any."""
    keys = (
        "f1_5cm",
        "f1_10cm",
        "adnn_m",
        "h95_m",
        "free_iou",
        "false_free",
        "wall_thickness_ratio",
    )
    return {key: None if scores is None else getattr(scores, key) for key in keys}


def trajectory_scores(
    corrected: Trajectory, online: Trajectory, truth: Trajectory | None
) -> dict[str, float | None]:
    """Errors of a trajectory, unaligned but for one: map and world share their frame.

    Args:
        corrected: Where the mapper takes the robot to have been, in the end: ``ate_rmse_m``,
            ``ate_max_m``, ``yaw_error_max_deg``, and per second ``rpe_trans_rmse_m`` and
            ``rpe_rot_rmse_deg``. ``ate_aligned_rmse_m`` is after the rigid motion that fits best,
            as benchmarks have it that do not know the start.
        online: Where it took it to be at the time: ``ate_online_rmse_m``.
        truth: The true trajectory; without it, or without poses in its time, all are None.
    """
    keys = ("ate_rmse_m", "ate_max_m", "yaw_error_max_deg")
    others = ("ate_aligned_rmse_m", "ate_online_rmse_m", "rpe_trans_rmse_m", "rpe_rot_rmse_deg")
    scores: dict[str, float | None] = dict.fromkeys((*keys, *others))
    if truth is None:
        return scores
    if _overlap(corrected, truth):
        absolute, relative = score_trajectory(corrected, truth), score_relative(corrected, truth)
        scores.update({key: getattr(absolute, key) for key in keys})
        scores["ate_aligned_rmse_m"] = score_trajectory(corrected, truth, align=True).ate_rmse_m
        if relative is not None:
            scores["rpe_trans_rmse_m"] = relative.trans_rmse_m
            scores["rpe_rot_rmse_deg"] = relative.rot_rmse_deg
    if _overlap(online, truth):
        scores["ate_online_rmse_m"] = score_trajectory(online, truth).ate_rmse_m
    return scores


def _overlap(estimate: Trajectory, truth: Trajectory) -> bool:
    """Whether a pose of the estimate lies within the truth's time."""
    first, last = truth.stamps[[0, -1]]
    return bool(np.any((estimate.stamps >= first) & (estimate.stamps <= last)))


def update_rates(stamps: NDArray[np.float64]) -> dict[str, float | None]:
    """How slow map updates came at worst, and in the middle, as the thesis has it (Table 5.3).

    A rate [Hz] is 1 over the simulated or logged time between the scans of two successive updates.
    Time in which scans are dropped, as the thesis's mapper does in turns, lowers the least rate.

    Args:
        stamps: Of the scans that went into the map ``(n,)`` [s]; with fewer than two at different
            times, or not in order, there is no rate.
    """
    keys = ("map_update_rate_min_hz", "map_update_rate_median_hz")
    gaps = np.diff(stamps)
    if gaps.size == 0 or not np.all(gaps > 0.0):
        return dict.fromkeys(keys)
    return dict(zip(keys, (float(1.0 / gaps.max()), float(1.0 / np.median(gaps))), strict=True))


def percentile_ms(seconds: NDArray[np.float64], share: float) -> float | None:
    """The percentile of wall times ``(n,)`` [s], in ms; None when there are none."""
    return round(1e3 * float(np.percentile(seconds, share)), 4) if len(seconds) else None


def peak_rss_mb() -> float:
    """The most memory this process ever held [MB]; Linux counts in kB, macOS in bytes."""
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    return round(peak / (1e6 if sys.platform == "darwin" else 1e3), 1)
