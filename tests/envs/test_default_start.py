import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis.extra.numpy import arrays

from envs.default_start import default_start
from mapping.burger import ROBOT_RADIUS
from mapping.errors import TestbedError

RESOLUTION, ORIGIN = 0.1, (-2.0, 5.0)


def test_the_start_is_the_middle_of_the_widest_room_facing_the_door():
    free = np.zeros((21, 60), dtype=bool)
    free[3:18, 3:18] = True  # a square room, its middle cell is (10, 10)
    free[9:12, 18:55] = True  # a corridor leads east
    x, y, yaw = default_start(free, resolution=RESOLUTION, origin=ORIGIN)
    assert (x, y) == pytest.approx((-2.0 + 10.5 * RESOLUTION, 5.0 + 10.5 * RESOLUTION))
    assert yaw == pytest.approx(0.0, abs=math.radians(2.0))


def test_the_start_faces_west_within_half_a_turn():
    free = np.zeros((21, 60), dtype=bool)
    free[3:18, 42:57] = True
    free[10, 3:42] = True
    _, _, yaw = default_start(free, resolution=RESOLUTION, origin=ORIGIN)
    assert -math.pi < yaw <= math.pi
    assert abs(yaw) == pytest.approx(math.pi, abs=math.radians(2.0))


def test_the_largest_floor_is_taken_even_when_a_smaller_one_is_wider():
    free = np.zeros((30, 200), dtype=bool)
    free[1:14, 1:14] = True  # 169 cells, 13 wide
    free[18:25, 1:199] = True  # 1386 cells, 7 wide
    _, y, _ = default_start(free, resolution=RESOLUTION, origin=ORIGIN)
    assert y == pytest.approx(5.0 + 21.5 * RESOLUTION)


@given(free=arrays(np.bool_, (12, 14)))
@settings(max_examples=60, deadline=None)
def test_the_robot_fits_at_the_start_or_the_place_is_refused(free):
    try:
        x, y, _ = default_start(free, resolution=RESOLUTION, origin=(0.0, 0.0))
    except TestbedError:
        return
    framed = np.pad(free, 1)
    for row, column in np.argwhere(~framed) - 1:
        dx = max(abs(x - (column + 0.5) * RESOLUTION) - 0.5 * RESOLUTION, 0.0)
        dy = max(abs(y - (row + 0.5) * RESOLUTION) - 0.5 * RESOLUTION, 0.0)
        assert math.hypot(dx, dy) >= ROBOT_RADIUS


def test_the_outside_of_the_raster_is_not_free():
    x, y, _ = default_start(np.ones((11, 11), dtype=bool), resolution=0.1, origin=(0.0, 0.0))
    assert (x, y) == pytest.approx((0.55, 0.55))


def test_a_place_too_narrow_for_the_robot_is_refused():
    corridor = np.zeros((3, 50), dtype=bool)
    corridor[1] = True
    with pytest.raises(TestbedError, match=r"the robot needs 0\.105 m"):
        default_start(corridor, resolution=RESOLUTION, origin=ORIGIN)
