import numpy as np
import pytest

from envs.floor_plan import FloorPlan, Wall
from envs.truth import truth_of_plan
from envs.worlds import load_world
from mapping.errors import TestbedError

ROOM = Wall(points=((-0.05, -0.05), (3.05, -0.05), (3.05, 2.05), (-0.05, 2.05)), closed=True)
PLAN = FloorPlan(name="room", start=(1.0, 1.0, 0.0), walls=(ROOM,))


def test_all_of_a_bare_room_can_be_seen_and_its_middle_be_reached():
    truth = truth_of_plan(PLAN, resolution=0.02)
    assert np.count_nonzero(truth.visible_free) * 0.02**2 == pytest.approx(3.0 * 2.0)
    # A wall's cells may reach half a cell out of the wall, so the robot is kept off that much more.
    reachable = np.count_nonzero(truth.reachable) * 0.02**2
    assert reachable == pytest.approx((3.0 - 0.21) * (2.0 - 0.21), abs=0.02 * 10.0)


def test_the_raster_lies_on_whole_cells_and_holds_the_plan_with_its_margin():
    truth = truth_of_plan(PLAN, resolution=0.05, margin=0.2)
    assert truth.origin == pytest.approx((-0.3, -0.3))
    assert truth.shape == (52, 72)


def test_a_truth_of_no_resolution_is_refused():
    with pytest.raises(TestbedError, match="resolution"):
        truth_of_plan(PLAN, resolution=0.0)


def test_the_second_room_behind_the_narrow_door_counts():
    truth = truth_of_plan(load_world("narrow_door"), resolution=0.02)
    column = int((6.0 - truth.origin[0]) / truth.resolution)
    row = int((1.0 - truth.origin[1]) / truth.resolution)
    assert truth.reachable[row, column]
    assert truth.visible_free[row, column]
