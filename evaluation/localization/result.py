"""Turns a localisation into the flat table of ``result.json``: when it was found, how exactly."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from evaluation.episode import CONTROL_PERIOD
from evaluation.localization.recording import LocalizationRun
from evaluation.result import percentile_ms
from mapping.geometry import between

NEAR_M, NEAR_DEG = 0.25, 10.0
"""The robot is located when the best guess is this near to the truth [m, deg] ..."""

STAYS_S = 5.0
"""... and stays so for this long [s]."""

FAR_M = 0.5
"""A guess farther off than this [m] is of another place."""

TIMING_KEYS = (
    "wall_time_s",
    "real_time_factor",
    "update_ms_p50",
    "update_ms_p99",
    "update_ms_max",
)
"""Keys that differ between runs of the same seed; every other is the same to the last digit."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Errors:
    """How far the best guess was from the truth at every control period."""

    stamps: NDArray[np.float64]
    """Times ``(n,)`` [s]."""
    meters: NDArray[np.float64]
    """Distances ``(n,)`` [m]."""
    degrees: NDArray[np.float64]
    """Differences of heading ``(n,)`` [deg], 0 to 180."""


def errors_of(run: LocalizationRun) -> Errors:
    """The errors of a run's best guesses."""
    apart = between(run.track.pose_world, run.track.pose_map)
    return Errors(
        stamps=run.track.stamps,
        meters=np.hypot(apart[:, 0], apart[:, 1]),
        degrees=np.degrees(np.abs(apart[:, 2])),
    )


def located_at(errors: Errors, begin: float, end: float) -> float | None:
    """When, from ``begin`` until before ``end`` [s], the robot was located; None if it was not.

    That is the first moment from which on the guess was near for STAYS_S.
    """
    since = None
    for stamp, meters, degrees in zip(errors.stamps, errors.meters, errors.degrees, strict=True):
        if not begin <= stamp < end:
            continue
        if meters >= NEAR_M or degrees >= NEAR_DEG:
            since = None
        elif since is None:
            since = float(stamp)
        if since is not None and stamp - since >= STAYS_S - 0.5 * CONTROL_PERIOD:
            return since
    return None


def result_of(run: LocalizationRun) -> dict[str, Any]:
    """The flat table; a value that cannot exist is None.

    Times to locate count from the start and from the kidnapping. Errors count from the moment at
    which the robot was located on, until the kidnapping, and again from being located after it.
    """
    config, errors = run.config, errors_of(run)
    stamps = errors.stamps
    end = float(stamps[-1])
    kidnapped = run.kidnapped_at
    until = np.inf if kidnapped is None else kidnapped
    found = located_at(errors, 0.0, until)
    found_again = None if kidnapped is None else located_at(errors, kidnapped + 1e-9, np.inf)
    tracked = np.zeros(len(stamps), dtype=np.bool_)
    if found is not None:
        tracked |= (stamps >= found) & (stamps <= until)
    if found_again is not None:
        tracked |= stamps >= found_again
    sure = (run.weights > 0.0) & ~run.ambiguous
    return {
        "world": config.world,
        "map": str(config.map),
        "filter": config.filter,
        "start": config.start,
        "seed": config.seed,
        "sim_time_s": end,
        "wall_time_s": run.wall_time,
        "real_time_factor": end / run.wall_time,
        "localized_at_s": found,
        "kidnapped_at_s": kidnapped,
        "relocalized_after_s": None
        if found_again is None
        else round(found_again - (kidnapped or 0.0), 6),
        "error_rmse_m": _rms(errors.meters[tracked]),
        "error_max_m": _max(errors.meters[tracked]),
        "yaw_rmse_deg": _rms(errors.degrees[tracked]),
        "yaw_max_deg": _max(errors.degrees[tracked]),
        "ambiguous_s": float(np.count_nonzero(run.ambiguous)) * CONTROL_PERIOD,
        "surely_wrong_s": float(np.count_nonzero(sure & (errors.meters > FAR_M))) * CONTROL_PERIOD,
        "updates": len(run.update_seconds),
        "size_first": int(run.sizes[0]),
        "size_median": float(np.median(run.sizes)),
        "size_max": int(run.sizes.max()),
        "update_ms_p50": percentile_ms(run.update_seconds, 50),
        "update_ms_p99": percentile_ms(run.update_seconds, 99),
        "update_ms_max": percentile_ms(run.update_seconds, 100),
    }


def is_found(result: dict[str, Any]) -> bool:
    """Whether the robot was located, and again after a kidnapping."""
    again = result["kidnapped_at_s"] is None or result["relocalized_after_s"] is not None
    return result["localized_at_s"] is not None and again


def _rms(values: NDArray[np.float64]) -> float | None:
    return float(np.sqrt(np.mean(values**2))) if len(values) else None


def _max(values: NDArray[np.float64]) -> float | None:
    return float(values.max()) if len(values) else None
