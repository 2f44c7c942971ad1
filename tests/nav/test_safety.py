"""The safety layer against exact polygon distances."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from shapely import MultiPoint
from shapely.affinity import rotate, translate
from shapely.geometry import box
from shapely.ops import unary_union

from mapping.grid import OccupancyGrid
from mapping.messages import Twist
from nav.outline import BURGER_OUTLINE
from nav.safety import Safety, SafetyConfig
from nav.safety_kernels import outline_distance

OUTLINE = BURGER_OUTLINE


@given(
    seed=st.integers(0, 10_000),
    x=st.floats(-1.0, 1.0),
    y=st.floats(-1.0, 1.0),
    yaw=st.floats(-3.0, 3.0),
)
@settings(max_examples=40, deadline=None)
def test_the_distance_to_the_outline_equals_shapelys(
    seed: int, x: float, y: float, yaw: float
) -> None:
    points = np.random.default_rng(seed).uniform(-1.0, 1.0, (20, 2))
    shape = unary_union([box(-back, -side, front, side) for front, back, side in OUTLINE])
    outline = translate(rotate(shape, yaw, (0, 0), True), x, y)
    expected = outline.distance(MultiPoint(points))
    assert outline_distance(points, x, y, yaw, OUTLINE) == pytest.approx(expected, abs=1e-9)


@given(seed=st.integers(0, 10_000), linear=st.floats(-0.22, 0.22), angular=st.floats(-2.0, 2.0))
@settings(max_examples=60, deadline=None)
def test_a_twist_is_only_ever_slowed_and_then_keeps_its_distance(
    seed: int, linear: float, angular: float
) -> None:
    points = np.random.default_rng(seed).uniform(-0.5, 0.5, (6, 2))
    safety = Safety()
    limited = safety.limit(
        Twist(linear_x=linear, angular_z=angular), np.zeros(3), points, OccupancyGrid()
    )
    assert 0.0 <= limited.linear_x * np.sign(linear) <= abs(linear)
    assert 0.0 <= limited.angular_z * np.sign(angular) <= abs(angular)
    real = points[[outline_distance(p[None], 0.0, 0.0, 0.0, OUTLINE) > 0.0 for p in points]]
    allowed = min(SafetyConfig().margin, outline_distance(real, 0.0, 0.0, 0.0, OUTLINE))
    x = y = yaw = 0.0
    for _ in range(60):
        x += 0.01 * limited.linear_x * np.cos(yaw)
        y += 0.01 * limited.linear_x * np.sin(yaw)
        yaw += 0.01 * limited.angular_z
        # 2 mm: between two of the six looks the outline moves 2 cm, nearest in their middle
        assert outline_distance(real, x, y, yaw, OUTLINE) > allowed - 0.004


def test_a_wall_ahead_stops_the_robot_but_not_its_way_back() -> None:
    wall = np.column_stack((np.full(41, 0.07), np.linspace(-0.2, 0.2, 41)))
    safety = Safety()
    ahead = safety.limit(Twist(linear_x=0.2), np.zeros(3), wall, OccupancyGrid())
    back = safety.limit(Twist(linear_x=-0.2), np.zeros(3), wall, OccupancyGrid())
    assert ahead.linear_x <= 0.05
    assert back.linear_x == -0.2


def test_what_the_lidar_is_too_near_to_see_is_remembered_from_the_map() -> None:
    grid = OccupancyGrid()
    rows, columns = grid.world_to_cell([[0.06, y] for y in np.linspace(-0.05, 0.05, 11)]).T
    grid.log_odds[rows, columns] = 5.0
    nothing = np.zeros((0, 2))
    limited = Safety().limit(Twist(linear_x=0.2), np.zeros(3), nothing, grid)
    assert limited.linear_x == 0.0


def test_without_obstacles_nothing_is_changed() -> None:
    twist = Twist(linear_x=0.2, angular_z=-1.0)
    assert Safety().limit(twist, np.zeros(3), np.zeros((0, 2)), OccupancyGrid()) == twist
