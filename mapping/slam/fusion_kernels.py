"""The filter's arithmetic: turns from gyroscope readings, moving a Gaussian pose, correcting it.

The state is x [m], y [m], yaw [rad, not wrapped], the gyroscope's bias [rad/s], the relative error
of the odometry's turns and that of its ways [1].
"""

import math

import numpy as np
from numba import njit
from numpy.typing import NDArray

X, Y, YAW, BIAS, TURN_SCALE, WAY_SCALE = range(6)
"""Places in the state."""

STATES = 6

Array = NDArray[np.float64]


@njit(cache=True)
def keep_rates(kept: Array, new: Array, since: float, fastest: float, most: int) -> Array:
    """Readings ``(n, 2)`` of stamp and rate, old and new, that are still to be used.

    Dropped are new ones that are not finite, faster than ``fastest`` or no newer than the newest,
    and old ones but the last at or before ``since``; at most ``most`` stay, the newest.
    """
    rows = np.empty((len(kept) + len(new), 2))
    count = 0
    for source in (kept, new):
        for i in range(len(source)):
            stamp, rate = source[i, 0], source[i, 1]
            if not (math.isfinite(stamp) and abs(rate) <= fastest):
                continue
            if count > 0 and stamp <= rows[count - 1, 0]:
                continue
            if count > 0 and stamp <= since:
                count = 0
            rows[count, 0], rows[count, 1] = stamp, rate
            count += 1
    return rows[max(count - most, 0) : count].copy()


@njit(cache=True)
def turn_between(
    rates: Array, begin: float, end: float, window: float, widest_gap: float
) -> tuple[float, float, float, bool]:
    """What the gyroscope turned from ``begin`` to ``end`` [s].

    A reading is the mean rate of the window before its stamp, no farther back than the reading
    before. Between windows the rate goes along a line; before the first reading and after the last
    it is theirs.

    Args:
        rates: Readings ``(n, 2)`` of stamp [s] and rate [rad/s], stamps rising.
        begin: Start of the interval [s].
        end: Its end [s].
        window: How long a reading is the mean of [s]; 0 is a rate of the moment.
        widest_gap: Readings farther apart than this, or from the ends, do not tell [s].

    Returns:
        The angle [rad], the sum of the squared steps [s2] (times a reading's variance it is the
        angle's), the largest rate by size [rad/s], and whether readings covered the interval.
    """
    angle = squares = fastest = 0.0
    count = len(rates)
    if count == 0 or rates[0, 0] - begin > widest_gap or end - rates[count - 1, 0] > widest_gap:
        return angle, squares, fastest, False
    place = 0
    while place < count and rates[place, 0] <= begin:
        place += 1
    stamp = begin
    while stamp < end:
        before, after = rates[max(place - 1, 0)], rates[min(place, count - 1)]
        gap = after[0] - before[0]
        if gap > widest_gap:
            return angle, squares, fastest, False
        opens = after[0] - window if gap > 0.0 else stamp  # beyond the ends one reading holds
        until = min(after[0], end) if place < count else end
        if stamp < opens:
            until = min(until, opens)
            slope = (after[1] - before[1]) / (opens - before[0])
            rate = before[1] + slope * (stamp - before[0])
            next_rate = before[1] + slope * (until - before[0])
        else:
            rate = next_rate = after[1]
        step = until - stamp
        angle += 0.5 * (rate + next_rate) * step
        squares += step * step
        fastest = max(fastest, abs(rate), abs(next_rate))
        stamp = until
        if place < count and stamp >= rates[place, 0]:
            place += 1
    return angle, squares, fastest, True


@njit(cache=True)
def move(
    state: Array,
    covariance: Array,
    motion: tuple[float, float, float],
    gains: tuple[float, float],
    variances: tuple[float, float, float, float],
) -> tuple[float, float]:
    """Move the pose, in place, and let its covariance grow.

    The turn's error is a random walk along the way: what it adds to the place is spread over it.

    Args:
        state: ``(6,)``.
        covariance: ``(6, 6)``.
        motion: Way ahead and to the left [m] in the frame of the heading before, and turn [rad].
        gains: What the bias [rad per rad/s] and the turn scale [rad] add to the turn.
        variances: Of the way along itself [m2], of the turn [rad2], of the place in every
            direction [m2], and of the bias's own walk [rad2/s2].

    Returns:
        The displacement [m] in the frame of the state.
    """
    ahead, left, turn = motion
    way_variance, turn_variance, place_variance, walk_variance = variances
    cos, sin = math.cos(state[YAW]), math.sin(state[YAW])
    across, along = cos * ahead - sin * left, sin * ahead + cos * left
    state[X] += across
    state[Y] += along
    state[YAW] += turn
    jacobian = np.eye(STATES)
    jacobian[X, YAW], jacobian[Y, YAW] = -along, across
    for place, gain in ((BIAS, gains[0]), (TURN_SCALE, gains[1])):
        jacobian[X, place], jacobian[Y, place] = -0.5 * along * gain, 0.5 * across * gain
        jacobian[YAW, place] = gain
    jacobian[X, WAY_SCALE], jacobian[Y, WAY_SCALE] = -across, -along
    moved = jacobian @ covariance @ jacobian.T
    way = math.hypot(across, along)
    ux, uy = (across / way, along / way) if way > 0.0 else (cos, sin)
    third, half = turn_variance / 3.0, turn_variance / 2.0
    moved[X, X] += ux * ux * way_variance + along * along * third + place_variance
    moved[Y, Y] += uy * uy * way_variance + across * across * third + place_variance
    moved[X, Y] += ux * uy * way_variance - along * across * third
    moved[X, YAW] -= along * half
    moved[Y, YAW] += across * half
    moved[YAW, YAW] += turn_variance
    moved[BIAS, BIAS] += walk_variance
    _mirror(moved, covariance)
    return across, along


@njit(cache=True)
def correct(
    state: Array,
    covariance: Array,
    innovation: float,
    sensitivity: Array,
    shared: Array,
    variance: float,
    gate: float,
) -> bool:
    """Correct the state, in place, by one measurement (Bar-Shalom et al. 2001, 8.3).

    Args:
        state: ``(6,)``.
        covariance: ``(6, 6)``.
        innovation: What was measured less what was expected.
        sensitivity: How the expectation changes with the state ``(6,)``; where ``shared`` is not
            0 it must be.
        shared: Covariance of the measurement's error with the state's newest error ``(6,)``.
        variance: Of the measurement's error.
        gate: Innovations of more standard deviations than this are not believed.

    Returns:
        Whether the measurement was believed.
    """
    spread = covariance @ sensitivity
    total = sensitivity @ spread + variance
    if not innovation * innovation <= gate * gate * total:
        return False
    gain = (spread + shared) / total
    for i in range(STATES):
        state[i] += gain[i] * innovation
    _mirror(covariance - total * np.outer(gain, gain), covariance)
    return True


@njit(cache=True)
def _mirror(upper: Array, covariance: Array) -> None:
    """Write the upper triangle into a covariance, both sides alike."""
    for i in range(STATES):
        for j in range(i, STATES):
            covariance[i, j] = covariance[j, i] = upper[i, j]
