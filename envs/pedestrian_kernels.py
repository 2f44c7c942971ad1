"""Numba kernels of people: where their legs are, and how they shorten the lidar's beams."""

import math

import numpy as np
from numba import njit
from numpy.typing import NDArray


@njit(cache=True)
def feet_at_time(
    footsteps: NDArray[np.float64],
    firsts: NDArray[np.int64],
    step_times: NDArray[np.float64],
    first_steps: NDArray[np.float64],
    time: float,
    feet: NDArray[np.float64],
) -> None:
    """Where the legs of each person are at a time.

    In step ``k`` foot ``k`` stands and the other swings from footstep ``k - 1`` to ``k + 1``, by
    the share ``u^2 (3 - 2 u)`` of the way after the share ``u`` of the time.

    Args:
        footsteps: Of all people, each an even number ``(n, 2)`` [m].
        firsts: Where each person's begin, and where the last one's end ``(p + 1,)``.
        step_times: How long a step takes each ``(p,)`` [s].
        first_steps: Steps that each has taken at time 0 ``(p,)``.
        time: The time [s].
        feet: Gets the places ``(2 p, 2)`` [m], of each person the left foot, then the right. It may
            have more columns, which stay as they are.
    """
    for person in range(len(step_times)):
        first = firsts[person]
        count = firsts[person + 1] - first
        taken = time / step_times[person] + first_steps[person]
        whole = math.floor(taken)
        share = taken - whole
        swung = share * share * (3.0 - 2.0 * share)
        step = int(whole) % count
        lifted = first + (step - 1 + count) % count
        landing = first + (step + 1) % count
        standing, swinging = 2 * person + step % 2, 2 * person + 1 - step % 2
        for axis in range(2):
            feet[standing, axis] = footsteps[first + step, axis]
            feet[swinging, axis] = footsteps[lifted, axis] + swung * (
                footsteps[landing, axis] - footsteps[lifted, axis]
            )


@njit(cache=True)
def nearest_squared(feet: NDArray[np.float64], place: NDArray[np.float64]) -> float:
    """The squared distance [m2] of the nearest of ``feet`` ``(m, 2)`` or wider to a place."""
    nearest = math.inf
    for leg in range(len(feet)):
        x, y = feet[leg, 0] - place[0], feet[leg, 1] - place[1]
        nearest = min(nearest, x * x + y * y)
    return nearest


@njit(cache=True)
def stop_at_legs(
    distances: NDArray[np.float64],
    origin: NDArray[np.float64],
    directions: NDArray[np.float64],
    shifts: NDArray[np.float64],
    feet: NDArray[np.float64],
    radius: float,
) -> None:
    """Shorten the beams of one block that meet a leg first, in place.

    Each beam meets the legs where they are at its own time: they move from the first state to the
    second in the first half of the block and on to the third in the second half.

    Args:
        distances: Along each beam from its own start to the next solid ``(n,)`` [m].
        origin: The sensor in the middle of the block ``(3,)`` [m].
        directions: Unit directions of the beams ``(n, 3)``.
        shifts: Start of each beam, seen from ``origin`` ``(n, 3)`` [m].
        feet: Axes of the legs at the block's start, middle and end ``(3, m, 2)`` [m].
        radius: Radius of the legs [m], which are upright and higher than any beam.
    """
    for i in range(len(distances)):
        along = 2.0 * i / len(distances)
        half = int(along)
        share = along - half
        dx, dy = directions[i, 0], directions[i, 1]
        flat = dx * dx + dy * dy
        for leg in range(feet.shape[1]):
            x = feet[half, leg, 0] + share * (feet[half + 1, leg, 0] - feet[half, leg, 0])
            y = feet[half, leg, 1] + share * (feet[half + 1, leg, 1] - feet[half, leg, 1])
            x -= origin[0] + shifts[i, 0]
            y -= origin[1] + shifts[i, 1]
            ahead = x * dx + y * dy
            beyond = x * x + y * y - radius * radius
            root = ahead * ahead - flat * beyond
            if root < 0.0 or (ahead < 0.0 < beyond):
                continue
            distance = 0.0 if beyond < 0.0 else (ahead - math.sqrt(root)) / flat
            distances[i] = min(distances[i], distance)
