"""The least gap between robot and things, against shapely."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from shapely.affinity import rotate, translate
from shapely.geometry import Point, Polygon, box
from shapely.ops import unary_union

from envs.solids import Disc, Prism
from evaluation.scores.clearance import min_clearance
from nav.outline import BURGER_OUTLINE

OUTLINE = unary_union([box(-back, -side, front, side) for front, back, side in BURGER_OUTLINE])


def convex_polygon(rng: np.random.Generator) -> np.ndarray:
    angles = np.sort(rng.uniform(0.0, 2.0 * np.pi, 5))
    middle, radius = rng.uniform(-0.6, 0.6, 2), rng.uniform(0.1, 0.4)
    return middle + radius * np.column_stack((np.cos(angles), np.sin(angles)))


@given(seed=st.integers(0, 10_000))
@settings(max_examples=60, deadline=None)
def test_the_least_gap_equals_shapelys(seed: int) -> None:
    rng = np.random.default_rng(seed)
    vertices = convex_polygon(rng)
    center, radius = rng.uniform(-0.6, 0.6, 2), rng.uniform(0.05, 0.2)
    poses = np.column_stack((rng.uniform(-0.3, 0.3, (4, 2)), rng.uniform(-3.0, 3.0, 4)))
    things = [Polygon(vertices), Point(center).buffer(radius, quad_segs=512)]
    expected = min(
        translate(rotate(OUTLINE, yaw, (0, 0), True), x, y).distance(thing)
        for x, y, yaw in poses
        for thing in things
    )
    solids = (
        Prism(vertices=vertices, height=1.0),
        Disc(center=center, radius=radius, height=1.0),
    )
    least = min_clearance(poses, solids)
    overlapping_edges_only = expected == 0.0  # two outlines may cross with no corner inside
    if not overlapping_edges_only:
        assert least == pytest.approx(expected, abs=1e-5) if expected < 0.5 else least is None


def test_far_from_everything_there_is_no_least_gap() -> None:
    far = (Disc(center=np.array([5.0, 5.0]), radius=0.2, height=1.0),)
    assert min_clearance(np.zeros((3, 3)), far) is None
    assert min_clearance(np.zeros((3, 3)), ()) is None


def test_a_robot_inside_a_thing_has_no_clearance() -> None:
    around = (Disc(center=np.zeros(2), radius=0.5, height=1.0),)
    assert min_clearance(np.zeros((1, 3)), around) == 0.0
