import time

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from envs.floor_space import floor_space
from envs.plan_raster import rasterize
from envs.raster_plan import plan_from_states, read_map_plan
from mapping.errors import TestbedError
from mapping.grid import FREE, OCCUPIED, UNKNOWN
from mapping.io.map_server import MapFile, write_map

RESOLUTION, ORIGIN = 0.05, (-1.0, 2.0)


def room():
    """A room with one wall that was never seen, in unknown surroundings."""
    states = np.full((60, 80), UNKNOWN, dtype=np.int8)
    states[10:50, 10:70] = FREE
    states[10, 10:70] = states[49, 10:70] = OCCUPIED
    states[10:50, 10] = OCCUPIED
    states[30, 40] = OCCUPIED
    return states


@given(states=arrays(np.int8, (9, 11), elements=st.sampled_from([UNKNOWN, FREE, OCCUPIED])))
@settings(max_examples=60, deadline=None)
def test_solid_is_what_is_occupied_or_unknown_beside_free(states):
    states[3:6, 3:6] = FREE  # where the robot starts
    resolution = 0.1
    plan = plan_from_states(
        states, resolution=resolution, origin=(0.0, 0.0), name="p", start=(0.45, 0.45, 0.0)
    )
    rows, columns = states.shape
    wanted = np.zeros((rows + 2, columns + 2), dtype=bool)
    framed = np.pad(states, 1, constant_values=UNKNOWN)
    for row, column in np.ndindex(wanted.shape):
        around = framed[max(row - 1, 0) : row + 2, max(column - 1, 0) : column + 2]
        unseen_beside_free = framed[row, column] == UNKNOWN and bool(np.any(around == FREE))
        wanted[row, column] = framed[row, column] == OCCUPIED or unseen_beside_free
    solid = rasterize(
        plan, resolution=resolution, origin=(-resolution, -resolution), shape=wanted.shape
    )
    np.testing.assert_array_equal(solid, wanted)


def test_a_room_with_an_unseen_wall_is_enclosed_by_few_boxes():
    plan = plan_from_states(room(), resolution=RESOLUTION, origin=ORIGIN, name="room")
    space = floor_space(plan, resolution=RESOLUTION)
    assert space.enclosed
    assert space.area == pytest.approx((38 * 59 - 1) * RESOLUTION**2)
    assert len(plan.boxes) <= 10  # walls with the corners of the shell beside them, one speckle


def test_a_map_that_is_free_to_its_rim_gets_a_rim():
    states = np.full((20, 30), FREE, dtype=np.int8)
    plan = plan_from_states(states, resolution=RESOLUTION, origin=ORIGIN, name="open")
    assert len(plan.boxes) == 4
    assert plan.bounds == pytest.approx((-1.05, 0.55, 1.95, 3.05))


def test_a_map_that_was_written_by_map_server_loads(tmp_path):
    path = write_map(
        tmp_path / "office.yaml", MapFile(resolution=RESOLUTION, origin=ORIGIN, states=room())
    )
    plan = read_map_plan(path)
    direct = plan_from_states(room(), resolution=RESOLUTION, origin=ORIGIN, name="office")
    assert plan.name == "office"
    assert plan.start == pytest.approx(direct.start)
    assert len(plan.boxes) == len(direct.boxes)


@pytest.mark.parametrize("state", [UNKNOWN, OCCUPIED])
def test_a_map_without_free_cells_is_refused_by_name(state, tmp_path):
    states = np.full((20, 30), state, dtype=np.int8)
    path = write_map(
        tmp_path / "void.yaml", MapFile(resolution=RESOLUTION, origin=ORIGIN, states=states)
    )
    with pytest.raises(TestbedError, match=r"void\.yaml: the map has zero free area"):
        read_map_plan(path)


def test_a_large_noisy_map_becomes_a_plan_within_two_seconds():
    rng = np.random.default_rng(0)
    states = np.full((1000, 1700), FREE, dtype=np.int8)
    states[::100] = states[:, ::100] = OCCUPIED
    states[50::100] = states[:, 50::100] = FREE
    states[rng.random(states.shape) < 0.002] = OCCUPIED
    plan_from_states(room(), resolution=RESOLUTION, origin=ORIGIN, name="compiles the kernel")
    begun = time.perf_counter()
    plan = plan_from_states(states, resolution=RESOLUTION, origin=ORIGIN, name="large")
    assert time.perf_counter() - begun < 2.0  # measured 0.4 s
    assert len(plan.boxes) < 5000  # 3400 speckles and the pieces of 26 lines between doors
