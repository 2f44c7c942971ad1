"""When each sensor is read, in physics steps since the reset."""

from envs.burger_constants import CONTROL_PERIOD, IMU_RATE, ODOMETRY_RATE, STEPS_PER_SECOND

IMU_STEPS = STEPS_PER_SECOND // IMU_RATE
"""Steps from one IMU message to the next: 5."""

_CYCLE_STEPS = round(CONTROL_PERIOD * STEPS_PER_SECOND)
"""All sensors repeat their pattern with this period: 50 steps."""

_ODOMETRY_STEPS = frozenset(
    round(message * STEPS_PER_SECOND / ODOMETRY_RATE) % _CYCLE_STEPS
    for message in range(round(CONTROL_PERIOD * ODOMETRY_RATE))
)
"""Odometry falls on the steps nearest to the multiples of 1/30 s: 0, 17 and 33 of a cycle."""

_EVENTS = sorted({*range(IMU_STEPS, _CYCLE_STEPS + 1, IMU_STEPS), *_ODOMETRY_STEPS} - {0})
"""Steps of a cycle at which something is read; lidar blocks end on IMU steps."""

_STEPS_TO_NEXT: tuple[int, ...] = tuple(
    next(event for event in _EVENTS if event > within) - within for within in range(_CYCLE_STEPS)
)


def next_event(step: int) -> int:
    """The next step after this one at which something is read; at most 10 ms later."""
    return step + _STEPS_TO_NEXT[step % _CYCLE_STEPS]


def is_odometry_step(step: int) -> bool:
    """Whether an odometry message falls on this step."""
    return step % _CYCLE_STEPS in _ODOMETRY_STEPS
