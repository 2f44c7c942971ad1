"""Readings by which a laser says that it measured nothing, in logs that do not tell which.

A laser that sees nothing sends its largest number, or one just below it. Taken for distances, such
readings are a round wall about every scan.
"""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

SICK_CODES = tuple((2**bits - 9) / 1000.0 for bits in (13, 14, 15))
"""First code [m] of a SICK LMS that counts millimetres up to 8, 16 or 32 m: a reading has 13, 14 or
15 bits, and its nine largest numbers are codes, the first of them for "farther than that" (SICK,
telegrams of the LMS 2xx). When it counts centimetres, codes begin at 81.83 m."""

LAST_CODE = 0.008
"""How far above the first code the last one lies [m]."""

ROUNDING = 0.005
"""Error of a reading written with two decimals [m]."""

CODE_SHARE, CODE_SCANS = 0.01, 20
"""From which share of all readings, and in how many scans, the very same largest reading is a code
[assumption]. The largest distance in the Intel Research Lab is 1 of 160 000 readings."""


def smallest_code(scans: Sequence[NDArray[np.floating]]) -> float:
    """The reading [m] from which on a log's readings are codes; ``inf`` if it has none.

    There are codes where the largest reading of the whole log is a code of a SICK, or comes again
    and again, to the last digit.

    Args:
        scans: Readings ``(n,)`` [m] of each scan; what is known to be none is not finite.
    """
    readings = np.concatenate([np.empty(0), *scans])
    finite = readings[np.isfinite(readings)]
    largest = float(finite.max(initial=0.0))
    if largest == 0.0:
        return np.inf
    for code in SICK_CODES:
        if code - ROUNDING <= largest <= code + LAST_CODE + ROUNDING:
            return code - ROUNDING
    share = np.count_nonzero(finite == largest) / len(readings)
    if share < CODE_SHARE or sum(largest in scan for scan in scans) < CODE_SCANS:
        return np.inf
    return largest
