"""Kernels for poles: hits that stand alone in a scan, and what a scan says of places."""

import math

import numpy as np
from numba import njit
from numpy.typing import NDArray

from mapping.scan_polygon import APART

SIGHTING_COLUMNS = 5
"""x and y of the middle of a sighting, the beam's unit vector, and the length's deviation [m]."""

LOOK_COLUMNS = 3
"""Number of the place, beams that went by or met it, and how many of them met it."""


@njit(cache=True)
def lone_hits(
    origins: NDArray[np.float64],
    directions: NDArray[np.float64],
    lengths: NDArray[np.float64],
    sigmas: NDArray[np.float64],
    hits: NDArray[np.bool_],
    pairs: NDArray[np.uint8],
    thickest: float,
    gap: float,
    gap_sigmas: float,
) -> NDArray[np.float64]:
    """Runs of hits with free space to both sides and nothing else near ``(k, 5)``.

    Args:
        origins: Where each beam starts ``(n, 2)`` [m].
        directions: Unit vectors of the beams ``(n, 2)``, counter-clockwise one after another.
        lengths: Lengths of the beams ``(n,)`` [m].
        sigmas: Their standard deviations ``(n,)`` [m].
        hits: Whether a beam met something ``(n,)``.
        pairs: How each beam and the next go together ``(n,)``, of ``compare_neighbours``.
        thickest: A run wider than this is no pole [m].
        gap: The beams beside a run go this much farther, at least [m].
        gap_sigmas: And this many standard deviations.
    """
    count = len(lengths)
    found = np.empty((count, SIGHTING_COLUMNS))
    made = 0
    if count < 3:
        return found[:0]
    for first in range(count):
        before = (first - 1) % count
        if not hits[first] or pairs[before] == APART:
            continue
        if lengths[before] - lengths[first] < gap + gap_sigmas * math.hypot(
            sigmas[before], sigmas[first]
        ):
            continue
        last, size = first, 1
        alone = False
        while size < count:
            after = (last + 1) % count
            if pairs[last] == APART:
                break
            step = lengths[after] - lengths[last]
            least = gap + gap_sigmas * math.hypot(sigmas[after], sigmas[last])
            if step >= least:
                alone = True
                break
            if not hits[after] or step <= -least:
                break
            last, size = after, size + 1
            sine = (
                directions[first, 0] * directions[last, 1]
                - directions[first, 1] * directions[last, 0]
            )
            if sine * lengths[first] > thickest:
                break
        if not alone:
            continue
        x, y, dx, dy, sigma = 0.0, 0.0, 0.0, 0.0, 0.0
        for step_along in range(size):
            i = (first + step_along) % count
            x += origins[i, 0] + lengths[i] * directions[i, 0]
            y += origins[i, 1] + lengths[i] * directions[i, 1]
            dx += directions[i, 0]
            dy += directions[i, 1]
            sigma += sigmas[i]
        norm = math.hypot(dx, dy)
        found[made, 0], found[made, 1] = x / size, y / size
        found[made, 2], found[made, 3] = dx / norm, dy / norm
        found[made, 4] = sigma / size / math.sqrt(size)
        made += 1
    return found[:made]


@njit(cache=True)
def looks_at(
    places: NDArray[np.float64],
    numbers: NDArray[np.int64],
    origins: NDArray[np.float64],
    directions: NDArray[np.float64],
    lengths: NDArray[np.float64],
    sigmas: NDArray[np.float64],
    hits: NDArray[np.bool_],
    half_width: float,
    tolerance: float,
    tolerance_sigmas: float,
) -> NDArray[np.float64]:
    """What a scan says of places ``(k, 3)``: number, beams that tell of it, those that met it.

    A beam tells of a place that it goes past, or to, within ``half_width``. Places that such a beam
    was stopped on the way to are left out.
    """
    count = len(lengths)
    looks = np.empty((len(numbers), LOOK_COLUMNS))
    made = 0
    for number in numbers:
        x, y = places[number]
        told, met = 0, 0
        hidden = False
        for i in range(count):
            ahead_x, ahead_y = x - origins[i, 0], y - origins[i, 1]
            along = ahead_x * directions[i, 0] + ahead_y * directions[i, 1]
            if along <= 0.0:
                continue
            aside = ahead_x * directions[i, 1] - ahead_y * directions[i, 0]
            if abs(aside) > half_width:
                continue
            reach = tolerance + tolerance_sigmas * sigmas[i]
            if lengths[i] < along - reach:
                hidden = True
                break
            if lengths[i] > along + reach:
                told += 1
            elif hits[i]:
                told += 1
                met += 1
        if told > 0 and not hidden:
            looks[made, 0], looks[made, 1], looks[made, 2] = number, told, met
            made += 1
    return looks[:made]


@njit(cache=True)
def belief(
    met: NDArray[np.bool_],
    chances: NDArray[np.float64],
    mistaken: float,
    lowest: float,
    highest: float,
) -> tuple[float, float]:
    """Whether somewhere is a pole, by scans in turn, oldest first.

    Args:
        met: Whether each scan met something there ``(n,)``.
        chances: How likely each would, were it there ``(n,)``.
        mistaken: How likely any scan is mistaken.
        lowest: Lower clamp of the log odds, after each scan.
        highest: Upper clamp.

    Returns:
        The log odds after the last scan, and after which share of the scans, from the first that
        met something on, they were above 0; 0 if none did.
    """
    odds = 0.0
    above, since = 0, 0
    for i in range(len(met)):
        chance = min(max(chances[i], mistaken), 1.0 - mistaken)
        if met[i]:
            odds += math.log(chance / mistaken)
        else:
            odds += math.log((1.0 - chance) / (1.0 - mistaken))
        odds = min(max(odds, lowest), highest)
        if met[i] or since > 0:
            since += 1
            above += odds > 0.0
    return odds, above / max(since, 1)
