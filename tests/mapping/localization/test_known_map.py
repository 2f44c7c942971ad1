"""What localisers take from a map: where the robot fits and where its walls face."""

import numpy as np
import pytest

from mapping.burger import ROBOT_RADIUS
from mapping.errors import TestbedError
from mapping.grid import FREE, OCCUPIED, UNKNOWN
from mapping.io.map_server import MapFile
from mapping.localization.known_map import known_map
from mapping.localization.map_surface import map_surface
from tests.mapping.localization.places import L_ROOM, RESOLUTION, map_of


def test_poses_are_drawn_all_over_where_the_robot_fits_and_nowhere_else() -> None:
    known = map_of(L_ROOM, (0.5, 0.5))
    poses = known.draw_poses(4000, np.random.default_rng(0))
    x, y = poses[:, 0], poses[:, 1]
    margin = ROBOT_RADIUS - 2.0 * RESOLUTION
    assert np.all((x > margin) & (y > margin))
    assert np.all((x < 4.0 - margin) & (y < 3.4 - margin))
    assert not np.any((x > 2.4 - margin) & (y > 1.8 - margin)), "the notch of the L"
    upper = np.mean(y > 1.8)
    area = (2.4 - 2 * ROBOT_RADIUS) * (1.6 - ROBOT_RADIUS)
    whole = area + (4.0 - 2 * ROBOT_RADIUS) * (1.8 - ROBOT_RADIUS)
    assert upper == pytest.approx(area / whole, abs=0.05)
    assert abs(np.mean(np.exp(1j * poses[:, 2]))) < 0.06, "headings are uniform"


def test_walls_face_the_free_side() -> None:
    surface = map_surface(map_of(L_ROOM, (0.5, 0.5)), 0.03)
    low = np.abs(surface[:, 1] - 0.01) < 0.02
    middle = low & (surface[:, 0] > 0.5) & (surface[:, 0] < 3.5)
    assert surface[middle, 3:] == pytest.approx(np.tile([0.0, 1.0], (middle.sum(), 1)), abs=0.05)
    # a point of weight 1 stands for 3 cm: the walls are 14.8 m long, and drawn with stairs
    assert surface[:, 2].sum() * 0.03 == pytest.approx(14.8, rel=0.15)


def test_a_map_that_cannot_be_localised_on_is_refused() -> None:
    def states(value: int) -> MapFile:
        return MapFile(
            resolution=0.05, origin=(0.0, 0.0), states=np.full((20, 20), value, dtype=np.int8)
        )

    with pytest.raises(TestbedError, match="walls"):
        known_map(states(FREE))
    with pytest.raises(TestbedError, match="fit"):
        known_map(states(OCCUPIED))
    with pytest.raises(TestbedError, match="walls"):
        known_map(states(UNKNOWN))
