"""MuJoCo's timing of its own stages."""

import mujoco
import numpy as np

from envs.simulation import Simulation
from envs.stage_clock import stop_stage_clock
from envs.worlds import load_world


def test_a_simulation_does_not_time_the_stages_of_its_steps() -> None:
    simulation = Simulation(load_world("empty_room"), rng=0)
    simulation.advance()
    assert not np.any([timer.duration for timer in simulation.data.timer])


def test_a_clock_that_somebody_set_stays() -> None:
    before, calls = mujoco.get_mjcb_time(), []
    try:
        mujoco.set_mjcb_time(lambda: calls.append(None) or 1.0)
        stop_stage_clock()
        Simulation(load_world("empty_room"), rng=0).advance()
        assert calls
    finally:
        mujoco.set_mjcb_time(before)
