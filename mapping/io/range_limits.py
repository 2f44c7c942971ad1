"""What readings at a laser's maximum mean in files: nothing was there, whatever the number."""

import numpy as np
from numpy.typing import NDArray


def without_codes(ranges: NDArray[np.float32], range_max: float) -> NDArray[np.float32]:
    """Readings ``(n,)`` [m], those at or beyond a ``range_max`` above 0 made ``+inf``.

    So lasers meant them before REP-117 gave "nothing was there" the number ``+inf``.
    """
    if not range_max > 0.0:
        return ranges
    return np.where(ranges >= np.float32(range_max), np.float32(np.inf), ranges)


def hits_below_maximum(ranges: NDArray[np.float32], range_max: float) -> NDArray[np.float32]:
    """Readings ``(n,)`` [m] of which a hit at exactly ``range_max`` stands a last digit nearer.

    Read back it must stay a hit.
    """
    maximum = np.float32(range_max)
    is_hit = np.isfinite(ranges) & (ranges == maximum)
    return np.where(is_hit, np.nextafter(maximum, np.float32(0.0)), ranges)
