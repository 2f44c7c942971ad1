import numpy as np
import pytest

from mapping.align import align_map, move_map
from mapping.geometry import inverse
from mapping.grid import FREE, OCCUPIED, UNKNOWN, OccupancyGrid
from mapping.io.map_server import MapFile
from tests.mapping.arena import arena_truth


def arena_map(resolution: float = 0.02) -> MapFile:
    truth = arena_truth(resolution)
    states = np.full(truth.shape, UNKNOWN, dtype=np.int8)
    states[truth.visible_free] = FREE
    states[truth.visible_surface] = OCCUPIED
    return MapFile(resolution=resolution, origin=truth.origin, states=states)


@pytest.mark.parametrize("pose", [(0.0, 0.0, 0.0), (0.3, -0.2, 0.1), (-0.4, 0.3, -0.14)])
def test_a_map_that_was_moved_is_brought_back(pose: tuple[float, float, float]) -> None:
    askew = move_map(arena_map(), np.array(pose))
    found = align_map(askew, arena_truth(0.02))
    assert found is not None
    # half a cell of 2 cm, and what that turns over the room's half width of 2 m
    assert found.pose == pytest.approx(inverse(pose), abs=0.01)
    assert found.scores.f1_5cm == pytest.approx(1.0, abs=0.01)


def test_moving_by_whole_cells_moves_the_states() -> None:
    map_ = arena_map()
    moved = move_map(map_, np.array([0.1, -0.06, 0.0]))
    assert moved.origin == pytest.approx((map_.origin[0] + 0.1, map_.origin[1] - 0.06))
    rows, columns = map_.states.shape
    assert np.array_equal(moved.states[:rows, :columns], map_.states)


def test_a_map_without_walls_cannot_be_aligned() -> None:
    assert align_map(OccupancyGrid(), arena_truth(0.05)) is None
