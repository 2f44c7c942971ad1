"""The messages that came in a stretch of simulated time."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True, slots=True, kw_only=True)
class SensorBatch:
    """The messages of a stretch of time, oldest first."""

    odometry: NDArray[np.float64]
    """Rows ``(n, 6)``, columns messages.ODOMETRY_COLUMNS."""
    imu: NDArray[np.float64]
    """Rows ``(m, 11)``, columns messages.IMU_COLUMNS."""
    scan_stamp: float | None
    """Time of the first beam of the newest whole scan that ended in this stretch [s], if any."""
    ranges: NDArray[np.float32] | None
    """Its ranges ``(360,)`` [m]: ``+inf`` (or 0.0) is no return, 0.0 a failed beam."""
