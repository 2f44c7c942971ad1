import numpy as np
import pytest

from envs.floor_plan import Box, FloorPlan, Wall
from envs.floor_space import enclosed_cells, floor_space

SQUARE = ((-0.05, -0.05), (4.05, -0.05), (4.05, 3.05), (-0.05, 3.05))
TWO_ROOMS = (Wall(points=SQUARE, closed=True), Wall(points=((2.0, 0.0), (2.0, 3.0))))


def test_the_floor_is_the_room_that_the_start_is_in():
    plan = FloorPlan(name="p", start=(1.0, 1.0, 0.0), walls=TWO_ROOMS)
    space = floor_space(plan, resolution=0.01)
    assert space.enclosed
    assert space.area == pytest.approx(1.95 * 3.0, abs=1e-9)


def test_a_room_with_a_gap_is_not_enclosed():
    plan = FloorPlan(name="p", start=(1.0, 1.0, 0.0), walls=(Wall(points=SQUARE),))
    assert not floor_space(plan, resolution=0.02).enclosed


def test_a_start_beyond_the_bounds_has_no_floor():
    box = Box(center=(5.0, 5.0), size=(1.0, 1.0))
    space = floor_space(FloorPlan(name="p", start=(0.0, 0.0, 0.0), boxes=(box,)), resolution=0.05)
    assert not space.enclosed
    assert space.area == 0.0


def test_enclosed_cells_are_those_without_a_way_to_the_rim():
    solid = np.zeros((9, 12), dtype=bool)
    solid[2:7, 2:7] = True
    solid[3:6, 3:6] = False  # a room
    solid[2:7, 8:] = True
    solid[3:6, 9:] = False  # a bay, open at the rim
    found = enclosed_cells(solid)
    assert found[3:6, 3:6].all()
    assert found.sum() == 9
