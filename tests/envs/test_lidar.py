"""Scans without noise equal analytic ray casts, each beam from the pose of its own time."""

import math

import mujoco
import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

from envs.burger_constants import LIDAR_POSITION
from envs.floor_plan import Box, FloorPlan, Wall
from envs.lidar import BLOCK_BEAMS, Lidar
from envs.lidar_kernels import block_rays, shift_origins
from envs.lidar_noise import LIDAR_PRESETS
from envs.scene import build_scene
from envs.simulation import Simulation
from envs.solids import Disc
from envs.worlds import load_world
from mapping.burger import LIDAR_BEAMS, LIDAR_POSE_BASE, LIDAR_RANGE_MAX, LIDAR_SCAN_TIME
from mapping.geometry import compose

MILLIMETRE = 1e-3
ROTATED_ROOM = FloorPlan(
    name="rotated room",
    start=(0.3, 0.2, 2.0),
    walls=(
        Wall(points=((-2.0, -0.6), (0.7, -2.1), (2.2, 0.9), (0.4, 2.3), (-1.2, 1.9)), closed=True),
    ),
    boxes=(Box(center=(-0.8, 0.9), size=(0.6, 0.3), yaw=0.8),),
)


def analytic_ranges(plan: FloorPlan, poses: np.ndarray) -> np.ndarray:
    """Distances ``(360,)`` along beam i from base pose i, by shapely and by circle equations."""
    sensors = compose(poses, LIDAR_POSE_BASE)
    solids = plan.solids()
    outlines = [shapely.Polygon(s.vertices).exterior for s in solids if not isinstance(s, Disc)]
    walls = shapely.union_all(outlines)
    ranges = np.full(LIDAR_BEAMS, np.inf)
    for i, (x, y, yaw) in enumerate(sensors):
        ray = np.array((math.cos(yaw + math.radians(i)), math.sin(yaw + math.radians(i))))
        origin = np.array((x, y))
        line = shapely.LineString((origin, origin + 2.0 * LIDAR_RANGE_MAX * ray))
        hit = line.intersection(walls)
        ranges[i] = shapely.Point(origin).distance(hit) if not hit.is_empty else np.inf
        for disc in (solid for solid in solids if isinstance(solid, Disc)):
            ranges[i] = min(ranges[i], circle_range(origin - disc.center, ray, disc.radius))
    ranges[ranges > LIDAR_RANGE_MAX] = np.inf
    return ranges


def circle_range(start: np.ndarray, ray: np.ndarray, radius: float) -> float:
    """Where a ray first meets a circle round the origin."""
    along = float(start @ ray)
    root = along**2 - (float(start @ start) - radius**2)
    return -along - math.sqrt(root) if root >= 0.0 > along else math.inf


def scan_and_poses(
    plan: FloorPlan, linear: float, angular: float, start: tuple[float, float, float] | None = None
) -> tuple[np.ndarray, np.ndarray]:
    """The third scan of a drive, and the true pose ``(360, 3)`` at the time of each beam.

    The poses come from a second simulation, equal to the last bit, stopped at every physics step.
    """
    scanned, traced = (Simulation(plan, lidar="ideal", odometry="truth", rng=0) for _ in range(2))
    for simulation in (scanned, traced):
        simulation.reset(start)
        simulation.command(linear, angular)
    batches = [scanned.advance(LIDAR_SCAN_TIME) for _ in range(3)]
    times, poses = [traced.time], [traced.pose_world]
    while traced.time < scanned.time - 1e-9:
        traced.advance(0.002)
        times.append(traced.time)
        poses.append(traced.pose_world)
    assert np.array_equal(poses[-1], scanned.pose_world)
    stamp, track = batches[-1].scan_stamp, np.array(poses)
    assert stamp == pytest.approx(0.4)
    beams = stamp + np.arange(LIDAR_BEAMS) / 1800.0
    track[:, 2] = np.unwrap(track[:, 2])
    at_beams = [np.interp(beams, times, column) for column in track.T]
    return batches[-1].ranges.astype(np.float64), np.stack(at_beams, axis=1)


def assert_equal_ranges(ranges: np.ndarray, expected: np.ndarray) -> None:
    assert np.array_equal(np.isinf(ranges), np.isinf(expected))
    hit = np.isfinite(expected)
    np.testing.assert_allclose(ranges[hit], expected[hit], rtol=0.0, atol=MILLIMETRE)


@pytest.mark.parametrize(
    "start",
    [(-2.0, -0.5, 0.0), (0.55, 0.55, 1.234), (1.6, -1.0, -2.5)],
)
def test_a_scan_at_rest_equals_the_analytic_one_in_turtlebot3_world(
    start: tuple[float, float, float],
) -> None:
    plan = load_world("turtlebot3_world")
    ranges, poses = scan_and_poses(plan, 0.0, 0.0, start)
    assert_equal_ranges(ranges, analytic_ranges(plan, poses))


@pytest.mark.parametrize("yaw", [0.0, 0.7, 2.0, -2.9])
def test_a_scan_at_rest_equals_the_analytic_one_in_a_rotated_room(yaw: float) -> None:
    ranges, poses = scan_and_poses(ROTATED_ROOM, 0.0, 0.0, (0.3, 0.2, yaw))
    assert_equal_ranges(ranges, analytic_ranges(ROTATED_ROOM, poses))


@pytest.mark.parametrize(
    ("linear", "angular"), [(0.0, 1.0), (0.0, -1.0), (0.2, 0.0), (-0.2, 0.0), (0.1, 1.0)]
)
def test_each_beam_of_a_moving_robot_is_taken_from_the_pose_of_its_own_time(
    linear: float, angular: float
) -> None:
    ranges, poses = scan_and_poses(ROTATED_ROOM, linear, angular)
    assert_equal_ranges(ranges, analytic_ranges(ROTATED_ROOM, poses))


def test_each_beam_of_a_turning_robot_is_right_among_pillars_too() -> None:
    plan = load_world("turtlebot3_world")
    ranges, poses = scan_and_poses(plan, 0.0, 1.0)
    assert_equal_ranges(ranges, analytic_ranges(plan, poses))


def test_at_full_spin_nearly_all_beams_are_right() -> None:
    """Beams at edges may see the other side: the sensor moves 0.8 mm in half a block."""
    ranges, poses = scan_and_poses(ROTATED_ROOM, 0.0, 2.5)
    errors = np.abs(ranges - analytic_ranges(ROTATED_ROOM, poses))
    assert np.mean(errors < MILLIMETRE) >= 0.97


def test_a_scan_taken_at_once_would_be_wrong_by_centimetres() -> None:
    """What the rolling scan is for: the pose at the scan's start does not explain its beams."""
    ranges, poses = scan_and_poses(ROTATED_ROOM, 0.0, 1.0)
    at_once = analytic_ranges(ROTATED_ROOM, np.tile(poses[0], (LIDAR_BEAMS, 1)))
    assert np.abs(ranges - at_once).max() > 0.05


def test_blocks_cast_together_equal_single_rays() -> None:
    plan = load_world("turtlebot3_world")
    simulation = Simulation(plan, lidar="ideal", odometry="truth", rng=0)
    ranges = simulation.advance(LIDAR_SCAN_TIME).ranges
    x, y, yaw = compose(simulation.pose_world, LIDAR_POSE_BASE)
    hit, solids = np.empty(1, dtype=np.int32), np.array([1, 0, 0, 0, 0, 0], dtype=np.uint8)
    origin = np.array((x, y, simulation.data.qpos[2] + LIDAR_POSITION[2]))
    for i in range(0, LIDAR_BEAMS, 7):
        ray = np.array((math.cos(yaw + math.radians(i)), math.sin(yaw + math.radians(i)), 0.0))
        single = mujoco.mj_ray(simulation.model, simulation.data, origin, ray, solids, 1, -1, hit)
        if 0.0 <= single <= LIDAR_RANGE_MAX:
            assert ranges[i] == pytest.approx(single, abs=MILLIMETRE)
        else:
            assert np.isinf(ranges[i])


def test_the_lidar_sees_neither_the_robot_nor_the_floor() -> None:
    far = FloorPlan(
        name="far wall", start=(0.0, 0.0, 0.0), boxes=(Box(center=(30.0, 0.0), size=(1.0, 1.0)),)
    )
    simulation = Simulation(far, lidar="ideal", odometry="truth", rng=0)
    for speed in (0.22, -0.22, 0.22):  # each stop pitches the robot
        simulation.command(speed, 0.0)
        assert np.isinf(simulation.advance(LIDAR_SCAN_TIME).ranges).all()


def test_a_scan_comes_every_fifth_of_a_second_with_the_stamp_of_its_first_beam() -> None:
    simulation = Simulation(ROTATED_ROOM, rng=0)
    stamps = [simulation.advance().scan_stamp for _ in range(6)]
    assert stamps[0::2] == [None] * 3
    assert stamps[1::2] == pytest.approx([0.0, 0.2, 0.4])


@settings(deadline=None, max_examples=30)
@given(
    motion=st.lists(st.floats(-0.01, 0.01), min_size=6, max_size=6),
    yaw=st.floats(-math.pi, math.pi),
)
def test_the_rays_of_a_block_equal_a_slow_reference(motion: list[float], yaw: float) -> None:
    states = np.array([base_state(k, np.array(motion), yaw) for k in range(3)])
    angles = np.radians(np.arange(BLOCK_BEAMS) + 72)
    beams = np.stack((np.cos(angles), np.sin(angles)), axis=1)
    directions, shifts = np.empty((BLOCK_BEAMS, 3)), np.empty((BLOCK_BEAMS, 3))
    offset = np.array(LIDAR_POSITION)
    middle = block_rays(states, offset, beams, directions, shifts)
    np.testing.assert_allclose(middle, states[1, :3] + matrix(states[1, 3:]) @ offset, atol=1e-12)
    for i in range(BLOCK_BEAMS):
        time = 2.0 * i / BLOCK_BEAMS
        state = np.array([np.interp(time, (0, 1, 2), column) for column in states.T])
        turned = matrix(state[3:] / np.linalg.norm(state[3:]))
        np.testing.assert_allclose(directions[i], turned @ (*beams[i], 0.0), atol=1e-12)
        np.testing.assert_allclose(shifts[i], state[:3] + turned @ offset - middle, atol=1e-12)


def base_state(k: int, motion: np.ndarray, yaw: float) -> np.ndarray:
    """Position and quaternion after ``k`` small motions: moved by 3 figures, turned by 3."""
    turn = np.array((0.0, 0.0, yaw)) + k * motion[3:]
    quaternion = np.empty(4)
    mujoco.mju_axisAngle2Quat(
        quaternion, turn / (np.linalg.norm(turn) or 1.0), np.linalg.norm(turn)
    )
    return np.concatenate((k * motion[:3], quaternion))


def matrix(quaternion: np.ndarray) -> np.ndarray:
    turned = np.empty(9)
    mujoco.mju_quat2Mat(turned, quaternion)
    return turned.reshape(3, 3)


@settings(deadline=None, max_examples=50)
@given(slope=st.floats(-1.2, 1.2), shift=st.tuples(st.floats(-0.01, 0.01), st.floats(-0.01, 0.01)))
def test_distances_to_a_wall_are_carried_over_exactly(
    slope: float, shift: tuple[float, float]
) -> None:
    """A wall through (2, 0) with this slope of its normal: the ray along x meets it by geometry."""
    normal = np.array((-math.cos(slope), -math.sin(slope), 0.0))
    distances = np.array((2.0, -1.0))
    shift_origins(
        distances,
        np.stack((normal, np.zeros(3))),
        np.array(((1.0, 0.0, 0.0), (0.0, 1.0, 0.0))),
        np.array(((*shift, 0.0), (0.0, 0.0, 0.0))),
    )
    # Points of the wall obey (x - 2) cos + y sin = 0; the moved ray runs at y = shift[1].
    assert distances[0] == pytest.approx(2.0 - shift[1] * math.tan(slope) - shift[0])
    assert np.isinf(distances[1])


def test_a_new_episode_starts_a_new_turn() -> None:
    model = build_scene(ROTATED_ROOM)
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    lidar = Lidar(model, LIDAR_PRESETS["ideal"])
    states = np.tile(data.qpos[:7], (3, 1))
    for _ in range(4):
        lidar.cast_block(data, states)
    lidar.reset(np.random.default_rng(0))
    whole = [lidar.cast_block(data, states) is not None for _ in range(20)]
    assert whole == ([False] * 9 + [True]) * 2
