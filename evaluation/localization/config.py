"""Everything that defines a localisation."""

from dataclasses import dataclass
from pathlib import Path
from typing import Literal

import numpy as np

from mapping.errors import TestbedError
from mapping.localization.localizers import FilterName, check_localizer

TIME_TO_FIND = 60.0
"""Time a run gives the localiser, from the start and after a kidnapping [s]."""


@dataclass(frozen=True, slots=True, kw_only=True)
class LocalizationConfig:
    """Everything that defines a run; the same config gives the same run."""

    map: Path
    """The map's YAML, as map_server writes it; its frame must be the world's."""
    world: str
    """A built-in world by name, random:SEED, or a floor plan file."""
    filter: FilterName = "particle"
    """particle, histogram or ekf (which needs a known start)."""
    start: Literal["uniform", "known"] = "uniform"
    """uniform: all poses on the map are equally likely to the localiser; known: it is told."""
    kidnap: float | None = None
    """Time at which the robot is put down elsewhere without being told [s]."""
    odometry: str = "typical"
    """Wheel and odometry errors: ideal, typical, poor, or truth (no error at all)."""
    odometry_yaw: Literal["encoders", "imu"] = "imu"
    """Where odometry takes its yaw from."""
    lidar: str = "datasheet"
    """Lidar noise: datasheet, worst_case, measured, dropouts or ideal."""
    seed: int = 0
    """Seed of every random number, the start pose and the place of the kidnapping among them."""
    time_limit: float | None = None
    """Simulated time after which the run ends [s]; None gives 60 s, and 60 s after a kidnapping."""

    def __post_init__(self) -> None:
        """Refuse figures that make no run."""
        if self.seed < 0:
            raise TestbedError(f"seed: {self.seed}; must be 0 or more")
        for name in ("kidnap", "time_limit"):
            value = getattr(self, name)
            if value is not None and not 1.0 <= value < np.inf:
                raise TestbedError(f"{name}: {value} s; must be finite and 1 or more")
        if self.kidnap is not None and self.kidnap >= self.end:
            raise TestbedError(f"kidnap: {self.kidnap} s; must be before the end, {self.end} s")
        check_localizer(self.filter, knows_start=self.start == "known")

    @property
    def end(self) -> float:
        """When the run ends [s]."""
        if self.time_limit is not None:
            return self.time_limit
        return TIME_TO_FIND + (0.0 if self.kidnap is None else self.kidnap)
