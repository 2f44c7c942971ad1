"""Turns a bound on a key of ``result.json`` into met, or into words that say what was missed."""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Literal

from evaluation.scenarios.yaml_lines import nearest
from mapping.errors import TestbedError

Bound = Literal["min", "max", "is", "max_ratio"]

BOUND_WORDS: dict[Bound, str] = {"min": "at least", "max": "at most", "is": ""}

TEXTS = ("stop_reason", "navigator", "mapper", "world")
"""Keys of a result that are words."""

FLAGS = ("map_reloads",)
"""Keys of a result that are true or false."""

NUMBERS = tuple(
    "sim_time_s wall_time_s real_time_factor coverage t90_s t95_s t99_s t_ref95_s efficiency "
    "path_length_m contacts contacts_by_people min_clearance_m f1_5cm f1_10cm adnn_m h95_m "
    "free_iou false_free ghost_area_m2 wall_thickness_ratio map_length_error ate_rmse_m ate_max_m "
    "yaw_error_max_deg ate_aligned_rmse_m ate_online_rmse_m rpe_trans_rmse_m rpe_rot_rmse_deg "
    "map_updates scans_dropped map_update_ms_p50 map_update_ms_p99 map_update_rate_hz "
    "decision_ms_p50 decision_ms_p99 "
    "map_update_rate_min_hz map_update_rate_median_hz "
    "map_file_kb peak_rss_mb home_distance_m dropped_frontiers seed".split()
)
"""Keys of a result that are numbers; a list such as ``dropped_frontiers`` counts for its length."""

COVERAGE_IN = "coverage_in."
"""Before the name of a region: the coverage of that region alone."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Criterion:
    """A bound that one key of a result must keep; a value that is null keeps none."""

    key: str
    """A key of ``result.json``, or ``coverage_in.REGION``."""
    bound: Bound
    """``min`` and ``max`` include the value; ``max_ratio`` is a multiple of another result's."""
    value: float | str | bool
    """The bound itself."""
    of: str = ""
    """With ``max_ratio``: the scenario, by name or file, whose result of the same seed counts."""

    def __post_init__(self) -> None:
        """Refuse a bound that no result could be held against."""
        if self.key not in (*TEXTS, *FLAGS, *NUMBERS) and not self.key.startswith(COVERAGE_IN):
            known = (*TEXTS, *FLAGS, *NUMBERS, f"{COVERAGE_IN}REGION")
            raise TestbedError(
                f"{self.key}: unknown key; {nearest(self.key, known)}"
                f"must be one of {', '.join(known)}"
            )
        _check_value(self)
        if (self.bound == "max_ratio") != bool(self.of):
            raise TestbedError("of: must name a scenario beside max_ratio, and only there")

    def missed(self, result: Mapping[str, Any], other: Mapping[str, Any] | None = None) -> str:
        """What was missed: measured and required, in words; empty when the bound is kept.

        Args:
            result: The result to judge.
            other: With ``max_ratio``, the result of the scenario ``of``.
        """
        measured = _measured(result, self.key)
        if self.bound == "is":
            required = str(self.value).lower() if self.key in FLAGS else str(self.value)
            return "" if measured == self.value else f"{self.key} {_told(measured)}, not {required}"
        limit, required = self._limit(other or {})
        if measured is not None and limit is not None:
            kept = measured >= limit if self.bound == "min" else measured <= limit
            if kept:
                return ""
        return f"{self.key} {_told(measured, limit)}, must be {required}"

    def _limit(self, other: Mapping[str, Any]) -> tuple[float | None, str]:
        """The number that bounds the measured one, if there is any, and how it is told."""
        value = float(self.value)
        if self.bound != "max_ratio":
            return value, f"{BOUND_WORDS[self.bound]} {value:g}"
        reference = _measured(other, self.key)
        told = f"{value:g} x {self.of}'s {_told(reference)}"
        if reference is None:
            return None, f"at most {told}"
        return value * reference, f"at most {told} = {value * reference:g}"


def _check_value(criterion: Criterion) -> None:
    """Refuse a bound whose kind or value does not fit its key."""
    key, bound, value = criterion.key, criterion.bound, criterion.value
    told = f"{key}: {bound}: {value!r}"
    if key in TEXTS + FLAGS and bound != "is":
        raise TestbedError(f"{key}: {bound}: is no number; must have the bound is")
    if key in FLAGS and not isinstance(value, bool):
        raise TestbedError(f"{told}; must be true or false")
    if key in TEXTS and not isinstance(value, str):
        raise TestbedError(f"{told}; must be a word")
    if key in TEXTS + FLAGS:
        return
    if isinstance(value, bool) or not isinstance(value, int | float) or math.isnan(value):
        raise TestbedError(f"{told}; must be a number")
    if bound == "max_ratio" and not 0.0 < value < math.inf:
        raise TestbedError(f"{told}; must be above 0 and finite")


def _measured(result: Mapping[str, Any], key: str) -> Any:
    """A key's value; of a list, its length."""
    value = result.get(key)
    return len(value) if isinstance(value, list) else value


def _told(measured: object, limit: float | None = None) -> str:
    """A measured value in words, with all its figures where six would read as the limit."""
    if measured is None:
        return "null"
    if isinstance(measured, bool) or not isinstance(measured, int | float):
        return str(measured).lower() if isinstance(measured, bool) else str(measured)
    short = f"{measured:.6g}"
    return repr(measured) if limit is not None and float(short) == limit else short
