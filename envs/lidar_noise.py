"""Turns true distances into the ranges that an LDS-01 reports: noise, wrong and failed beams."""

import math
from dataclasses import dataclass
from typing import Literal, get_args

import numpy as np
from numpy.typing import NDArray

from mapping.burger import LIDAR_RANGE_MAX, LIDAR_RANGE_MIN
from mapping.errors import TestbedError
from mapping.sensor_model import LDS_01, SIGMAS_IN_PRECISION

NoReturn = Literal["inf", "zero"]
"""What stands for "nothing within range": ``+inf`` (REP-117) or the real driver's ``0.0``."""


@dataclass(frozen=True, slots=True, kw_only=True)
class LidarConfig:
    """How far an LDS-01 is from the truth; the default is its datasheet.

    The datasheet (ROBOTIS e-manual, LDS-01) gives both figures in two parts, absolute below 0.5 m
    and relative from there to 3.5 m: the precision is ``LDS_01`` of ``mapping.sensor_model``, the
    accuracy +-15 mm and +-5 %.
    """

    near_range: float = LDS_01.near_range
    """Distance [m] at which the relative figures take over from the absolute ones."""
    near_sigma: float = LDS_01.near_precision / SIGMAS_IN_PRECISION
    """Standard deviation of a near beam [m]."""
    far_sigma: float = LDS_01.far_precision / SIGMAS_IN_PRECISION
    """The same of a far beam, as a share of the distance."""
    scale_sigma: float = LDS_01.scale_sigma
    """Standard deviation of the scale error of a unit, drawn once an episode."""
    near_bias: float = 0.0
    """Constant error of a unit near by [m]; its sign is drawn once an episode."""
    far_bias: float = 0.0
    """The same far away, as a share of the distance; the same sign."""
    resolution: float = 0.001
    """Step of the reported ranges [m]: the device sends whole millimetres; 0 for none."""
    wrong: float = 0.0
    """Share of hits that are reported at a wrong distance."""
    wrong_sigma: float = 0.0
    """Standard deviation of a wrong distance about the true one [m]."""
    dropout: float = 0.0
    """Share of hits that fail and are reported as 0.0."""
    open_dropout: float = 0.0
    """Share of beams into open space that fail and are reported as 0.0."""
    no_return: NoReturn = "inf"
    """What is reported for nothing within range."""

    def __post_init__(self) -> None:
        """Refuse figures that are no errors or no shares."""
        for name in ("near_sigma", "far_sigma", "scale_sigma", "resolution", "wrong_sigma"):
            _check(name, getattr(self, name), 0.0, math.inf)
        for name in ("near_range", "near_bias", "far_bias"):
            _check(name, getattr(self, name), 0.0, LIDAR_RANGE_MAX)
        for name in ("wrong", "dropout", "open_dropout"):
            _check(name, getattr(self, name), 0.0, 1.0)
        _check("wrong + dropout", self.wrong + self.dropout, 0.0, 1.0)
        if self.no_return not in get_args(NoReturn):
            raise TestbedError(f"lidar no_return: {self.no_return!r}; must be 'inf' or 'zero'")

    @property
    def cast_range(self) -> float:
        """How far to look [m]: a wall past 3.5 m can be measured nearer, up to four sigma."""
        return LIDAR_RANGE_MAX * (1.0 + 4.0 * (self.far_sigma + self.scale_sigma) + self.far_bias)


def _check(name: str, value: float, least: float, most: float) -> None:
    """Refuse NaN and what lies outside [least, most]."""
    if not (least <= value <= most and math.isfinite(value)):
        bound = f"from {least:g} to {most:g}" if math.isfinite(most) else f"finite, {least:g} up"
        raise TestbedError(f"lidar {name}: {value}; must be {bound}")


LIDAR_PRESETS: dict[str, LidarConfig] = {
    "datasheet": LidarConfig(),
    # The full accuracy figure as an error of the unit, on top of the precision.
    "worst_case": LidarConfig(scale_sigma=0.0, near_bias=0.015, far_bias=0.05),
    # Appendix A of the thesis, 1000 readings each: 0.5 m from a wall 991 read 0.500, 0.501 or
    # 0.502 m, the other 9 wrong or 0.0; into an open hallway 994 read inf, 6 read 0.0. Hits are
    # taken to fail as often as open beams, the rest of the 9 to be wrong by the datasheet's
    # precision, and the spread to grow with the distance as the datasheet's does. At 0.3 mm three
    # values hold 99.9 % of it wherever in a millimetre the wall is; at 0.6 mm the 991 would be 979.
    "measured": LidarConfig(
        near_sigma=0.0003,
        far_sigma=0.0006,
        scale_sigma=0.0,
        wrong=0.003,
        wrong_sigma=LDS_01.near_precision,
        dropout=0.006,
        open_dropout=0.006,
    ),
    # Every tenth beam fails: far more than the appendix counted; dust, sunlight or black things.
    "dropouts": LidarConfig(dropout=0.1, open_dropout=0.1),
    "ideal": LidarConfig(near_sigma=0.0, far_sigma=0.0, scale_sigma=0.0, resolution=0.0),
}
"""Named settings of the lidar."""


@dataclass(frozen=True, slots=True, kw_only=True)
class LidarUnit:
    """The errors of one device, the same throughout an episode."""

    scale: float
    """Relative error of every distance."""
    bias_sign: float
    """Sign of the constant error, +1 or -1."""


def draw_unit(config: LidarConfig, rng: np.random.Generator) -> LidarUnit:
    """The device that an episode gets."""
    return LidarUnit(
        scale=config.scale_sigma * rng.standard_normal(), bias_sign=float(rng.choice((-1.0, 1.0)))
    )


def report(
    distances: NDArray[np.float64],
    config: LidarConfig,
    unit: LidarUnit,
    rng: np.random.Generator,
) -> NDArray[np.float32]:
    """The ranges ``(n,)`` [m] that a device reports.

    Args:
        distances: True distances ``(n,)`` [m]; ``+inf`` where nothing was hit.
        config: Figures of the device's kind.
        unit: Errors of this very device.
        rng: Source of the noise; every call draws equally much.

    Returns:
        Ranges from 0.12 to 3.5 m, ``+inf`` (or 0.0, by ``no_return``) for nothing within range, and
        0.0 for beams that failed or came out nearer than 0.12 m, as the LDS-01 has it.
    """
    noise, lot = rng.standard_normal(len(distances)), rng.random(len(distances))
    hit = np.isfinite(distances)
    true = np.where(hit, distances, 0.0)
    far = true >= config.near_range
    sigma = np.where(far, config.far_sigma * true, config.near_sigma)
    if config.wrong > 0.0:
        sigma[lot < config.wrong] = config.wrong_sigma
    measured = (1.0 + unit.scale) * true + sigma * noise
    if config.near_bias > 0.0 or config.far_bias > 0.0:
        measured += unit.bias_sign * np.where(far, config.far_bias * true, config.near_bias)
    if config.resolution > 0.0:
        measured = np.round(measured / config.resolution) * config.resolution
    no_return = math.inf if config.no_return == "inf" else 0.0
    ranges = np.where(hit & (measured <= LIDAR_RANGE_MAX), measured, no_return)
    ranges[ranges < LIDAR_RANGE_MIN] = 0.0
    if config.dropout > 0.0 or config.open_dropout > 0.0:
        ranges[lot >= 1.0 - np.where(hit, config.dropout, config.open_dropout)] = 0.0
    return ranges.astype(np.float32)
