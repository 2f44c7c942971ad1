"""People are seen where they are at each beam's time, and touches are laid at the right door."""

import math
from dataclasses import replace

import mujoco
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from envs.floor_plan import Box, FloorPlan, Pedestrian, Wall
from envs.pedestrian_kernels import stop_at_legs
from envs.pedestrians import LEG_RADIUS, feet_at, gaits_of
from envs.scene import LEG_GROUP, SOLID_GROUP, lean_of
from envs.simulation import Simulation
from mapping.burger import LIDAR_BEAMS, LIDAR_POSE_BASE, LIDAR_RANGE_MAX, LIDAR_SCAN_TIME
from mapping.geometry import compose

RING = ((-4.0, -4.0), (4.0, -4.0), (4.0, 4.0), (-4.0, 4.0))
CONTROL_PERIOD = 0.1


def hall(*people: Pedestrian, start: tuple[float, float, float] = (0.0, 0.0, 0.0)) -> FloorPlan:
    walls = (Wall(points=RING, closed=True),)
    return FloorPlan(name="hall", start=start, walls=walls, pedestrians=people)


PASSING = Pedestrian(waypoints=((-3.0, 0.7), (3.0, 0.7)), speed=1.2, phase=0.2)
ROUND = Pedestrian(waypoints=((1.0, -2.0), (2.0, 1.0), (1.2, 2.0), (-2.0, 1.5)), speed=0.5)


def range_to_legs(sensor: np.ndarray, feet: np.ndarray) -> float:
    """Distance along x of a sensor pose to the nearest of circles."""
    nearest = math.inf
    cos, sin = math.cos(sensor[2]), math.sin(sensor[2])
    for x, y in feet - sensor[:2]:
        along, across = cos * x + sin * y, cos * y - sin * x
        if abs(across) < LEG_RADIUS and along > 0.0:
            nearest = min(nearest, along - math.sqrt(LEG_RADIUS**2 - across**2))
    return nearest


@pytest.mark.parametrize("command", [(0.0, 0.0), (0.15, 0.6)])
def test_each_beam_meets_the_legs_where_they_are_at_its_own_time(
    command: tuple[float, float],
) -> None:
    """Within 1 mm but at the rims of legs, where 0.3 mm to the side may be many in depth."""
    plan = hall(PASSING, ROUND)
    scanned = Simulation(plan, lidar="ideal", odometry="truth", rng=0)
    traced = Simulation(plan, lidar="ideal", odometry="truth", rng=0)
    gaits, hits, errors = gaits_of(plan.pedestrians), 0, []
    for simulation in (scanned, traced):
        simulation.command(*command)
    for _ in range(2):
        times, poses = [traced.time], [traced.pose_world]
        ranges = scanned.advance(LIDAR_SCAN_TIME).ranges
        while traced.time < scanned.time - 1e-9:
            traced.advance(0.002)
            times.append(traced.time)
            poses.append(traced.pose_world)
        stamps = times[0] + np.arange(LIDAR_BEAMS) / 1800.0
        at = np.stack([np.interp(stamps, times, column) for column in np.array(poses).T], axis=1)
        for i, pose in enumerate(compose(at, LIDAR_POSE_BASE)):
            sensor = pose + (0.0, 0.0, math.radians(i))
            expected = range_to_legs(sensor, feet_at(gaits, float(stamps[i])))
            if expected < LIDAR_RANGE_MAX:
                hits += 1
                errors.append(abs(expected - ranges[i]))
    assert hits > 20
    assert np.mean(np.array(errors) < 1e-3) > 0.9


def test_a_beam_among_standing_legs_equals_a_ray_of_mujoco() -> None:
    simulation = Simulation(hall(PASSING, ROUND), lidar="ideal", rng=0)
    simulation.advance(0.5)
    origin = np.array((simulation.data.qpos[0], simulation.data.qpos[1], 0.18))
    groups = np.zeros(mujoco.mjNGROUP, dtype=np.uint8)
    groups[[SOLID_GROUP, LEG_GROUP]] = 1
    feet = np.repeat(simulation.data.mocap_pos[None, :, :2], 3, axis=0)
    hit, legs_met = np.empty(1, dtype=np.int32), 0
    mujoco.mj_kinematics(simulation.model, simulation.data)
    for angle in np.arange(0.0, 2.0 * math.pi, 0.01):
        ray = np.array([[math.cos(angle), math.sin(angle), 0.0]])
        args = simulation.model, simulation.data, origin, ray[0]
        both = mujoco.mj_ray(*args, groups, 1, -1, hit)
        solids = mujoco.mj_ray(*args, groups * (np.arange(6) != LEG_GROUP), 1, -1, hit)
        cut = np.array([solids])
        stop_at_legs(cut, origin, ray, np.zeros((1, 3)), feet, LEG_RADIUS)
        assert cut[0] == pytest.approx(both, abs=1e-9)
        legs_met += both < solids
    assert legs_met > 10


def walked_into(speed: float, drive: tuple[float, float] = (0.0, 0.0)) -> Simulation:
    """A person who walks along x through the place where the robot starts, from behind it."""
    person = Pedestrian(waypoints=((-3.0, 0.08), (3.0, 0.08)), speed=speed, phase=0.2)
    simulation = Simulation(hall(person), rng=0)
    for _ in range(round(2.0 / speed / CONTROL_PERIOD)):
        simulation.command(*drive)
        simulation.advance()
    return simulation


@pytest.mark.parametrize("speed", [0.5, 0.8, 1.2])
def test_a_person_who_walks_into_a_standing_robot_is_no_contact_of_the_robots(
    speed: float,
) -> None:
    simulation = walked_into(speed)
    assert simulation.contacts == 0
    assert simulation.contacts_by_people >= 1


def test_nor_is_one_who_overtakes_a_robot_that_drives_away() -> None:
    simulation = walked_into(1.2, drive=(0.1, 0.0))
    assert simulation.contacts == 0
    assert simulation.contacts_by_people >= 1


def test_a_robot_that_drives_into_a_person_has_done_it_itself() -> None:
    """Who walks very slowly across its way stands on one leg most of the time."""
    person = Pedestrian(waypoints=((0.6, -1.0), (0.6, 1.0)), speed=0.1, phase=0.15)
    simulation = Simulation(hall(person), rng=0)
    for _ in range(60):
        simulation.command(0.2, 0.0)
        simulation.advance()
    assert simulation.contacts == 1
    assert simulation.contacts_by_people == 0


def test_a_robot_that_turns_its_back_into_a_person_has_done_it_itself() -> None:
    """The right foot stands at (0, 0.17) for two seconds; the corners behind reach 0.124 m."""
    person = Pedestrian(waypoints=((-3.1, 0.27), (2.9, 0.27)), speed=0.1, phase=0.2501)
    simulation = Simulation(hall(person), rng=0)
    for _ in range(10):
        simulation.command(0.0, -2.0)
        simulation.advance()
    assert simulation.contacts == 1


def test_a_robot_that_was_walked_into_still_stands_and_meets_the_person_once() -> None:
    simulation = walked_into(1.2)
    _, _, _, w, x, y, z = simulation.data.qpos[:7]
    assert w * w + z * z - x * x - y * y > 0.99
    assert simulation.contacts_by_people <= 2


def test_people_far_away_change_nothing_but_the_scan() -> None:
    runs = []
    for people in ((), (PASSING,)):
        simulation = Simulation(hall(*people), rng=3)
        simulation.command(0.1, 0.5)
        batch = simulation.advance(0.4)
        runs.append((batch.odometry.tobytes(), batch.imu.tobytes(), batch.ranges))
    assert runs[0][:2] == runs[1][:2]
    assert not np.array_equal(runs[0][2], runs[1][2])


def test_time_is_cut_anywhere_and_the_touches_are_the_same() -> None:
    counts = []
    for period in (0.1, 0.034):
        person = Pedestrian(waypoints=((-3.0, 0.08), (3.0, 0.08)), speed=0.8, phase=0.2)
        simulation = Simulation(hall(person), rng=0)
        while simulation.time < 2.5:
            simulation.advance(period)
        counts.append((simulation.contacts, simulation.contacts_by_people))
    assert counts[0] == counts[1]


def pushed_into_a_box() -> Simulation:
    """Somebody has come along from behind and pushed the robot aside, where a box stands."""
    person = Pedestrian(waypoints=((-3.0, -0.14), (3.0, -0.14)), speed=1.2, phase=0.2)
    box = Box(center=(0.0, 0.65), size=(6.0, 1.0))
    simulation = Simulation(replace(hall(person), boxes=(box,)), rng=0)
    while simulation.time < 3.0:
        simulation.advance()
    return simulation


def test_what_a_person_pushes_the_robot_into_is_the_persons_doing() -> None:
    simulation = pushed_into_a_box()
    assert simulation.contacts == 0
    assert simulation.contacts_by_people >= 2, "the person's, and the box's"


def test_what_the_robot_drives_into_afterwards_is_its_own_doing() -> None:
    simulation = pushed_into_a_box()
    by_people = simulation.contacts_by_people
    simulation.carry_off((2.0, -3.6, -0.5 * math.pi))
    for _ in range(30):
        simulation.command(0.2, 0.0)
        simulation.advance()
    assert simulation.contacts >= 1
    assert simulation.contacts_by_people == by_people


@given(st.floats(-math.pi, math.pi), st.floats(-math.pi, math.pi), st.floats(0.0, math.pi))
def test_a_robot_leans_as_far_as_its_axis_is_from_upright(
    yaw: float, direction: float, lean: float
) -> None:
    axis = Rotation.from_euler("z", yaw)
    tilt = Rotation.from_rotvec(lean * np.array((math.cos(direction), math.sin(direction), 0.0)))
    x, y, z, w = (tilt * axis).as_quat()
    assert lean_of(np.array((0.0, 0.0, 0.0, w, x, y, z))) == pytest.approx(lean, abs=1e-6)


def test_a_robot_that_lies_on_its_side_has_toppled_and_one_that_drives_has_not() -> None:
    simulation = Simulation(hall(), rng=0)
    simulation.command(0.22, 0.0)
    simulation.advance(0.4)
    assert not simulation.has_toppled
    simulation.data.qpos[2:7] = (0.1, math.sqrt(0.5), math.sqrt(0.5), 0.0, 0.0)
    simulation.advance(1.0)
    assert simulation.has_toppled
