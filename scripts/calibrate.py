"""``burger calibrate``: the thesis's two sensor experiments (appendix A), in simulation."""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import tyro
from tqdm import tqdm

from evaluation.calibration.experiment import CalibrationConfig, take_readings
from evaluation.calibration.fit import Estimate, SensorModelFit, fit_sensor_model
from evaluation.calibration.folder import write_calibration
from evaluation.run_folder import run_folder
from mapping.sensor_model import (
    FREE_READINGS,
    LOG_ODDS_FREE,
    LOG_ODDS_OCCUPIED,
    OCCUPIED_READINGS,
    READINGS,
)
from scripts.arguments import is_terminal, parse


@dataclass(frozen=True, kw_only=True)
class Calibrate:
    """Read the beam ahead 0.5 m from a wall and before open space: how often is it right?"""

    config: Annotated[CalibrationConfig, tyro.conf.OmitArgPrefixes]
    out: Path | None = None
    """Folder for readings.csv, histogram.png and calibration.json; default
    runs/calibration-LIDAR-seedN."""


def run(arguments: list[str]) -> int:
    """Run the verb."""
    options = parse(Calibrate, "calibrate", arguments)
    config = options.config
    out = options.out or Path("runs") / f"calibration-{config.lidar}-seed{config.seed}"
    with run_folder(out):
        with tqdm(
            total=2 * config.scans, unit="scan", disable=not is_terminal(), leave=False
        ) as bar:
            fit = fit_sensor_model(take_readings(config, bar.update))
        write_calibration(fit, config, out)
    print(f"lidar {config.lidar}, {config.scans} scans each, seed {config.seed}:")
    print(_summary(fit))
    print(f"readings.csv, histogram.png and calibration.json are in {out}/")
    return 0


def _summary(fit: SensorModelFit) -> str:
    """The four figures, with their intervals and beside the thesis's."""
    rows = (
        ("p(m=1 given z=1)", fit.p_m1_given_z1, OCCUPIED_READINGS / READINGS, 3),
        ("p(m=0 given z=0)", fit.p_m0_given_z0, FREE_READINGS / READINGS, 3),
        ("lo1", fit.lo1, LOG_ODDS_OCCUPIED, 4),
        ("lo0", fit.lo0, LOG_ODDS_FREE, 4),
    )
    head = f"  {'':<17}{'measured':>9}  {'95 % interval':<18}{'thesis':>7}"
    return "\n".join(
        (head, *(_row(name, estimate, known, form) for name, estimate, known, form in rows))
    )


def _row(name: str, estimate: Estimate, known: float, decimals: int) -> str:
    value, low, high = (
        "-" if figure is None else f"{figure:.{decimals}f}"
        for figure in (estimate.value, estimate.low, estimate.high)
    )
    return f"  {name:<17}{value:>9}  {f'{low} to {high}':<18}{known:>7.{decimals}f}"
