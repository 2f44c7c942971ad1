"""Stops MuJoCo from timing the stages of each step, which nobody here reads."""

import mujoco
from numba import cfunc


@cfunc("float64()", cache=True)
def _no_time() -> float:
    """A clock that stands."""
    return 0.0


def stop_stage_clock() -> None:
    """Give MuJoCo a clock that stands; one that somebody set before stays.

    Reading the real one takes an eighth of a step of this robot. States do not depend on it;
    ``MjData.timer`` stays at zero, in the whole process.
    """
    if mujoco.get_mjcb_time() is None:
        mujoco.set_mjcb_time(_no_time.ctypes)
