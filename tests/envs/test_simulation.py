"""A simulation hands out every message once, at its time, and counts what the robot hits."""

import copy
import math
import pickle

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from envs.floor_plan import Box, FloorPlan, Wall
from envs.schedule import is_odometry_step, next_event
from envs.sensor_batch import SensorBatch
from envs.simulation import Simulation
from mapping.errors import TestbedError
from mapping.geometry import wrap_to_pi

ROOM = FloorPlan(
    name="room",
    start=(0.0, 0.0, 0.0),
    walls=(Wall(points=((-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)), closed=True),),
    boxes=(Box(center=(0.0, 0.6), size=(0.4, 0.2)),),
)
EXACT = {"lidar": "ideal", "odometry": "ideal", "imu": "ideal"}


def joined(batches: list[SensorBatch]) -> tuple[np.ndarray, np.ndarray, list[np.ndarray]]:
    return (
        np.concatenate([batch.odometry for batch in batches]),
        np.concatenate([batch.imu for batch in batches]),
        [batch.ranges for batch in batches if batch.ranges is not None],
    )


def test_a_control_period_brings_3_odometry_and_10_imu_messages_and_half_a_scan() -> None:
    simulation = Simulation(ROOM, rng=0)
    batches = [simulation.advance() for _ in range(10)]
    assert {(len(b.odometry), len(b.imu)) for b in batches} == {(3, 10)}
    odometry, imu, scans = joined(batches)
    np.testing.assert_allclose(imu[:, 0], np.arange(1, 101) / 100.0)
    # Odometry has the time of the physics step nearest to each thirtieth of a second.
    np.testing.assert_allclose(odometry[:, 0], np.arange(1, 31) / 30.0, atol=0.001)
    np.testing.assert_allclose(odometry[:, 0] * 500.0, np.round(odometry[:, 0] * 500.0), atol=1e-9)
    assert len(scans) == 5
    assert simulation.time == pytest.approx(1.0)


@settings(deadline=None, max_examples=20)
@given(steps=st.lists(st.integers(1, 120), min_size=1, max_size=12))
def test_however_time_is_cut_the_messages_are_the_same(steps: list[int]) -> None:
    """Without noise: each batch draws its own noise, but the physics must not know the cuts."""
    whole, cut = Simulation(ROOM, rng=0, **EXACT), Simulation(ROOM, rng=0, **EXACT)
    for simulation in (whole, cut):
        simulation.command(0.1, 0.7)
    parts = joined([cut.advance(n * 0.002) for n in steps])
    at_once = joined([whole.advance(sum(steps) * 0.002)])
    np.testing.assert_allclose(parts[0], at_once[0], atol=1e-9)
    np.testing.assert_allclose(parts[1], at_once[1], atol=1e-9)
    if at_once[2]:
        np.testing.assert_array_equal(parts[2][-1], at_once[2][-1])
    assert cut.data.qpos.tobytes() == whole.data.qpos.tobytes()


def test_nothing_is_read_more_than_10_ms_after_the_last() -> None:
    events, step = [], 0
    while step < 500:
        events.append(next_event(step) - step)
        step = next_event(step)
    assert max(events) <= 5
    assert sum(is_odometry_step(step) for step in range(1, 501)) == 30
    assert all(next_event(step) > step for step in range(200))


def test_the_robot_starts_at_the_plans_pose_with_odometry_zero() -> None:
    simulation = Simulation(ROOM, rng=0)
    np.testing.assert_allclose(simulation.pose_world, ROOM.start, atol=1e-3)
    simulation.reset((-0.5, -0.4, 2.5))
    np.testing.assert_allclose(simulation.pose_world, (-0.5, -0.4, 2.5), atol=1e-3)
    last = simulation.advance().odometry[-1]
    np.testing.assert_allclose(last[1:], 0.0, atol=1e-3)


def test_running_into_a_wall_is_a_contact_and_standing_is_none() -> None:
    simulation = Simulation(ROOM, rng=0)
    simulation.advance(1.0)
    assert simulation.contacts == 0
    for _ in range(60):
        simulation.command(0.2, 0.0)
        simulation.advance()
    assert simulation.contacts >= 1
    assert simulation.pose_world[0] < 1.0 - 0.05 - 0.038 + 0.005  # its front is 38 mm ahead
    simulation.reset()
    assert simulation.contacts == 0


def test_a_second_touch_is_a_second_contact() -> None:
    counts = []
    simulation = Simulation(ROOM, rng=0)
    for speed, periods in ((0.2, 80), (-0.2, 20), (0.2, 40)):
        for _ in range(periods):
            simulation.command(speed, 0.0)
            simulation.advance()
        counts.append(simulation.contacts)
    # The front of the base and the wheels can touch; three seconds of pushing are one contact each.
    assert 1 <= counts[0] <= 3
    assert counts[1] == counts[0]
    assert counts[2] > counts[1]


def test_the_same_seed_gives_the_same_messages_to_the_last_bit() -> None:
    def run(seed: int) -> bytes:
        simulation = Simulation(ROOM, rng=seed)
        parts = []
        for k in range(8):
            simulation.command(0.1, math.sin(k))
            batch = simulation.advance()
            parts += [batch.odometry.tobytes(), batch.imu.tobytes()]
            parts += [batch.ranges.tobytes()] if batch.ranges is not None else []
        return b"".join(parts)

    assert run(5) == run(5)
    assert run(5) != run(6)


def test_each_sensor_has_its_own_randomness() -> None:
    """What one sensor draws must not change what another reports."""
    noisy = Simulation(ROOM, rng=5, lidar="measured", odometry="typical").advance(0.4)
    exact = Simulation(ROOM, rng=5, lidar="ideal", odometry="ideal").advance(0.4)
    np.testing.assert_array_equal(noisy.imu, exact.imu)


def test_a_new_episode_has_new_errors() -> None:
    simulation = Simulation(ROOM, rng=5)
    first = simulation.advance(0.2).imu
    simulation.reset()
    assert not np.array_equal(first, simulation.advance(0.2).imu)


@pytest.mark.parametrize("sensor", ["lidar", "odometry", "imu"])
def test_an_unknown_preset_is_refused_with_the_known_ones(sensor: str) -> None:
    with pytest.raises(TestbedError, match=rf"{sensor}: 'perfect'; must be one of .*ideal"):
        Simulation(ROOM, **{sensor: "perfect"})


@pytest.mark.parametrize("dt", [0.0, -1.0, 0.0005])
def test_time_must_pass_by_a_step_at_least(dt: float) -> None:
    with pytest.raises(TestbedError, match="dt: "):
        Simulation(ROOM).advance(dt)


def test_a_copy_drives_on_as_the_original_does() -> None:
    simulation = Simulation(ROOM, rng=3)
    simulation.command(0.1, 0.5)
    simulation.advance()
    twins = [simulation, copy.deepcopy(simulation), pickle.loads(pickle.dumps(simulation))]
    for twin in twins:
        twin.command(0.2, 0.5)
        twin.advance()
    assert all(np.array_equal(twin.pose_world, simulation.pose_world) for twin in twins)
    assert simulation.velocity_base[1] > 0.3


def test_odometry_from_the_imu_tells_the_turn_rate_and_the_heading_of_its_own_time() -> None:
    """Its messages do not come at the IMU's times."""
    simulation = Simulation(ROOM, **EXACT, rng=0)
    start = simulation.pose_world
    for _ in range(30):
        simulation.command(0.0, 1.0)
        rows = simulation.advance().odometry
    assert rows[:, 5] == pytest.approx(np.ones(3), abs=0.01)
    assert rows[-1, 3] == pytest.approx(wrap_to_pi(simulation.pose_world[2] - start[2]), abs=0.002)
