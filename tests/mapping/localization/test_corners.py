"""Corners of scans and of maps, by the same rules."""

import math

import numpy as np
import pytest

from mapping.geometry import compose, wrap_to_pi
from mapping.localization.map_corners import map_corners
from mapping.localization.scan_corners import Corners, find_corners
from tests.mapping.localization.places import L_ROOM, map_of
from tests.mapping.slam.rooms import Walls, box, cloud_of, post, scan_of

L_CORNERS = [(0.0, 0.0), (4.0, 0.0), (4.0, 1.8), (2.4, 1.8), (2.4, 3.4), (0.0, 3.4)]


def seen(walls: Walls, pose: tuple[float, float, float], seed: int = 0) -> Corners:
    scan = scan_of(walls, np.array(pose), np.random.default_rng(seed))
    return find_corners(cloud_of(scan).points)


def in_map(corners: Corners, pose: tuple[float, float, float]) -> np.ndarray:
    return np.array([compose(pose, [*place, 0.0])[:2] for place in corners.places]).reshape(-1, 2)


def test_a_room_from_inside_has_four_hollow_corners() -> None:
    pose = (1.7, 1.1, 0.6)
    corners = seen(box(0.0, 3.0, 0.0, 2.4), pose)
    assert len(corners) == 4
    assert corners.hollow.all()
    for place, direction in zip(in_map(corners, pose), corners.directions, strict=True):
        wall = min([(0, 0), (3, 0), (3, 2.4), (0, 2.4)], key=lambda c: math.dist(c, place))
        # two lines of a dozen and more readings of 1 to 2 cm noise
        assert math.dist(wall, place) < 0.05
        inwards = math.atan2(1.2 - wall[1], 1.5 - wall[0])
        expected = math.copysign(1.0, math.cos(inwards)), math.copysign(1.0, math.sin(inwards))
        diagonal = math.atan2(expected[1], expected[0]) - pose[2]
        assert abs(wrap_to_pi(direction - diagonal)) < 0.08


def test_a_box_from_outside_has_a_corner_that_stands_out() -> None:
    corners = seen(box(0.0, 1.0, 0.0, 1.0), (-0.7, -0.7, 0.2))
    assert len(corners) == 1
    assert not corners.hollow[0]
    assert in_map(corners, (-0.7, -0.7, 0.2))[0] == pytest.approx([0.0, 0.0], abs=0.04)


@pytest.mark.parametrize("seed", range(5))
def test_a_round_post_and_a_bare_wall_have_none(seed: int) -> None:
    assert len(seen(post(1.0, 0.3, 0.15, corners=60), (0.0, 0.0, 0.1), seed)) == 0
    assert len(seen(np.array([(-3.0, 1.0, 3.0, 1.0)]), (0.0, 0.0, 0.1), seed)) == 0


@pytest.mark.parametrize("yaw", [0.0, 1.0, 2.5])
def test_the_corners_stay_where_they_are_when_the_robot_turns(yaw: float) -> None:
    pose = (1.2, 0.9, yaw)
    corners = seen(L_ROOM, pose)
    assert len(corners) >= 4, "of six, some with few readings beside them"
    for place, hollow in zip(in_map(corners, pose), corners.hollow, strict=True):
        nearest = min(L_CORNERS, key=lambda corner: math.dist(corner, place))
        assert math.dist(nearest, place) < 0.08
        assert hollow == (nearest != (2.4, 1.8))


def test_a_map_has_the_corners_of_its_plan() -> None:
    corners = map_corners(map_of(L_ROOM, (0.5, 0.5)))
    assert len(corners) == 6
    for place in L_CORNERS:
        away = np.hypot(*(corners.places - place).T)
        assert away.min() < 0.04
        assert corners.hollow[np.argmin(away)] == (place != (2.4, 1.8))


def test_a_scan_without_points_has_none() -> None:
    assert len(find_corners(np.zeros((0, 2)))) == 0
    assert len(find_corners(np.array([[1.0, 0.0]]))) == 0
