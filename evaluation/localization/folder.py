"""Turns a localisation into the files of a run folder."""

from pathlib import Path
from typing import Any

import numpy as np

from evaluation.localization.picture import save_localization_picture
from evaluation.localization.recording import LocalizationRun
from evaluation.localization.result import errors_of, result_of
from evaluation.run_folder import describe, start_run, write_json
from mapping.io.atomic import write_atomically
from mapping.io.tum import write_tum

BELIEF_COLUMNS = ("stamp_s", "size", "weight", "ambiguous", "error_m", "error_deg")


def write_localization(run: LocalizationRun, folder: Path) -> dict[str, Any]:
    """Write every file of the run folder, each whole or not at all; returns the result.

    ``config.json``, ``trajectory.tum`` (the best guess of the moment), ``ground_truth.tum``,
    ``odometry.tum``, ``belief.csv`` (how large and how sure the belief was over time),
    ``localize.png``, and last ``result.json``: a folder that has one is complete.
    """
    start_run(folder)
    write_json(folder / "config.json", describe(run.config))
    track = run.track
    write_tum(folder / "trajectory.tum", track.stamps, track.pose_map)
    write_tum(folder / "ground_truth.tum", track.stamps, track.pose_world)
    write_tum(folder / "odometry.tum", track.stamps, track.pose_odom)
    _write_belief(run, folder / "belief.csv")
    result = result_of(run)
    save_localization_picture(folder / "localize.png", run, result)
    write_json(folder / "result.json", result)
    return result


def _write_belief(run: LocalizationRun, path: Path) -> None:
    """A row a control period, columns BELIEF_COLUMNS."""
    errors = errors_of(run)
    rows = np.column_stack(
        (errors.stamps, run.sizes, run.weights, run.ambiguous, errors.meters, errors.degrees)
    )
    header = ",".join(BELIEF_COLUMNS)
    formats = ("%.1f", "%d", "%.4f", "%d", "%.4f", "%.3f")
    write_atomically(
        path,
        lambda file: np.savetxt(
            file, rows, fmt=list(formats), delimiter=",", header=header, comments=""
        ),
    )
