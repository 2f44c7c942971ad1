"""Writes what came of the thesis's figures: the page, and its verdicts as JSON."""

from collections.abc import Sequence
from dataclasses import asdict
from math import isfinite
from pathlib import Path
from typing import Any

from evaluation.run_folder import write_json
from evaluation.thesis.config import ThesisConfig
from evaluation.thesis.figure import ThesisFigure
from evaluation.thesis.figures_gmapping import figures_of_gmapping
from evaluation.thesis.figures_mapping import figures_of_mapping
from evaluation.thesis.figures_odometry import figures_of_odometry
from evaluation.thesis.page import page_of
from evaluation.thesis.regenerate import Runs
from mapping.io.atomic import write_atomically

PAGE, VERDICTS = "thesis.html", "thesis.json"


def figures_of(runs: Runs) -> tuple[ThesisFigure, ...]:
    """Every figure and the table, in the order of the thesis."""
    return (*figures_of_mapping(runs), *figures_of_gmapping(runs), *figures_of_odometry(runs))


def write_thesis(
    config: ThesisConfig, runs: Runs, figures: Sequence[ThesisFigure], folder: Path
) -> None:
    """Write ``thesis.html`` and ``thesis.json``, each whole or not at all.

    Raises:
        TestbedError: The folder cannot be written.
    """
    text = page_of(config, runs, figures)
    write_atomically(folder / PAGE, lambda file: file.write(text.encode()))
    write_json(folder / VERDICTS, _told(config, figures))


def _told(config: ThesisConfig, figures: Sequence[ThesisFigure]) -> dict[str, Any]:
    return {
        "config": asdict(config),
        "figures": {
            figure.number: {
                "verdict": figure.verdict,
                "checks": [
                    {
                        "claim": check.claim,
                        "measure": check.measure,
                        "value": float(check.value) if isfinite(check.value) else None,
                        "relation": check.relation,
                        "bound": float(check.bound),
                        "unit": check.unit,
                        "holds": check.holds,
                    }
                    for check in figure.checks
                ],
            }
            for figure in figures
        },
    }
