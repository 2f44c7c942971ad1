"""Turns a calibration into its files: the table of readings, the histogram, the figures."""

import csv
import io
from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

from evaluation.calibration.experiment import WALL_DISTANCE, CalibrationConfig
from evaluation.calibration.fit import CONFIDENCE, RIGHT, SensorModelFit, ValueCount
from evaluation.calibration.picture import save_histogram
from evaluation.run_folder import describe, start_run, write_json
from mapping.io.atomic import write_atomically

TABLE, PICTURE, FIGURES = "readings.csv", "histogram.png", "calibration.json"


def write_calibration(fit: SensorModelFit, config: CalibrationConfig, folder: Path) -> None:
    """Write all three, each whole or not at all, ``calibration.json`` last.

    Raises:
        TestbedError: The folder cannot be written.
    """
    start_run(folder)
    (folder / FIGURES).unlink(missing_ok=True)  # an earlier one would vouch for these readings
    write_atomically(folder / TABLE, lambda file: file.write(_table(fit.table).encode()))
    save_histogram(folder / PICTURE, fit, config)
    write_json(folder / FIGURES, _figures(fit, config))


def _table(rows: Sequence[ValueCount]) -> str:
    """Value and how many, as appendix A has it."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(("experiment", "reading_m", "count", "counts_as"))
    for row in rows:
        writer.writerow((row.experiment, row.reading, row.count, row.counts_as))
    return text.getvalue()


def _figures(fit: SensorModelFit, config: CalibrationConfig) -> dict[str, Any]:
    """What ``calibration.json`` says."""
    told = asdict(fit)
    del told["table"]
    return {
        **told,
        "confidence": CONFIDENCE,
        "right_values_m": [row.reading for row in fit.rows("wall") if row.counts_as == RIGHT],
        "wall_distance_m": WALL_DISTANCE,
        "settings": describe(config),
        "lidar_settings": asdict(config.lidar_settings),
    }
