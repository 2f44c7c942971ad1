"""Stops MuJoCo from timing the stages of each step, which nobody here reads."""

from functools import cache
from typing import Any

import mujoco
from numba import cfunc


def stop_stage_clock() -> None:
    """Give MuJoCo a clock that stands; one that somebody set before stays.

    Reading the real one takes an eighth of a step of this robot. States do not depend on it;
    ``MjData.timer`` stays at zero, in the whole process.
    """
    if mujoco.get_mjcb_time() is None:
        mujoco.set_mjcb_time(_standing_clock().ctypes)


@cache
def _standing_clock() -> Any:
    """A C function that returns 0, kept for good; compiled when it is needed, not on import."""
    return cfunc("float64()", cache=True)(_no_time)


def _no_time() -> float:
    return 0.0
