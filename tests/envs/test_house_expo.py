import json
import math

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

from envs.floor_space import floor_space
from envs.house_expo import HOUSE_WALL_THICKNESS, read_house_expo
from mapping.errors import TestbedError

L_RING = [[0, 0], [6.0, 0], [6.0, 2.5], [2.5, 2.5], [2.5, 7.0], [0, 7.0]]
TWO_LOBES = [[0, 0], [3, 0], [3, 3], [7, 3], [7, 7], [3, 7], [3, 3], [0, 3]]
THERE_AND_BACK = [[0, 0], [2, 0], [2, 1.5], [2, 0], [5, 0], [5, 4], [0, 4]]


def house(folder, verts, **fields):
    path = folder / "house.json"
    bbox = {"min": [0, 0], "max": [7, 7]}
    path.write_text(
        json.dumps(
            {"id": "abc", "room_num": 3, "bbox": bbox, "verts": verts, "room_category": {}} | fields
        )
    )
    return path


@pytest.mark.parametrize("ring", [L_RING, [*L_RING, L_RING[0]]])
def test_the_free_space_is_the_ring_less_half_the_wall(ring, tmp_path):
    plan = read_house_expo(house(tmp_path, ring))
    inside = shapely.Polygon(ring).buffer(-0.5 * HOUSE_WALL_THICKNESS, join_style="mitre")
    space = floor_space(plan, resolution=0.01)
    assert plan.name == "abc"
    assert space.enclosed
    # A raster's area errs by half a cell along its border at most.
    assert space.area == pytest.approx(inside.area, abs=0.005 * inside.length)


def test_the_start_is_in_the_widest_place_facing_the_longest_way(tmp_path):
    x, y, yaw = read_house_expo(house(tmp_path, L_RING)).start
    ring = shapely.Polygon(L_RING)
    widest = shapely.maximum_inscribed_circle(ring, tolerance=0.001).length
    assert shapely.Point(x, y).distance(ring.exterior) == pytest.approx(widest, abs=0.04)
    ways = [
        ring.exterior.intersection(
            shapely.LineString([(x, y), (x + 20 * math.cos(a), y + 20 * math.sin(a))])
        ).distance(shapely.Point(x, y))
        for a in np.append(yaw, np.radians(range(360)))
    ]
    assert ways[0] >= max(ways) - 0.1  # four cells of the raster it was chosen on


@pytest.mark.parametrize("ring", [TWO_LOBES, THERE_AND_BACK])
def test_a_ring_that_touches_itself_loads(ring, tmp_path):
    plan = read_house_expo(house(tmp_path, ring))
    assert floor_space(plan, resolution=0.02).enclosed


@given(
    verts=st.lists(
        st.tuples(st.integers(0, 40), st.integers(0, 40)).map(lambda v: [v[0] / 4, v[1] / 4]),
        max_size=12,
    )
)
@settings(max_examples=60, deadline=None)
def test_any_ring_loads_or_is_refused_on_one_line(verts, tmp_path_factory):
    try:
        read_house_expo(house(tmp_path_factory.mktemp("house"), verts))
    except TestbedError as error:
        told = str(error)
        if "verts" not in told or "\n" in told:
            raise


@pytest.mark.parametrize(
    ("verts", "named"),
    [
        ("text", "verts: str; must be a list"),
        ([[0, 0], [1, 0], [1]], r"verts[2]: [1]"),
        ([[0, 0], [1, 0], [1, "a"]], r"verts[2]: [1, 'a']"),
        ([[0, 0], [4, 0], [math.nan, 4]], "nan"),
        ([[0, 0], [4, 0], [10**400, 4]], "coordinates must be finite"),
        ([], "verts: points: 0 that differ"),
        ([[0, 0], [4, 0], [8, 0]], "on one line"),
        ([[0, 0], [0.2, 0], [0.2, 0.2], [0, 0.2]], "start: none found"),
    ],
)
def test_a_ring_that_is_none_is_named(verts, named, tmp_path):
    path = house(tmp_path, verts)
    with pytest.raises(TestbedError) as raised:
        read_house_expo(path)
    assert str(raised.value).startswith(f"{path}: verts")
    assert named in str(raised.value)
    assert len(str(raised.value)) < 400


@pytest.mark.parametrize(
    ("text", "named"), [("{", "line 1: not JSON"), ("[]", "verts: missing"), ("{}", "verts: miss")]
)
def test_a_file_that_is_no_house_is_named(text, named, tmp_path):
    path = tmp_path / "house.json"
    path.write_text(text)
    with pytest.raises(TestbedError, match=named):
        read_house_expo(path)
    with pytest.raises(TestbedError, match="no such file"):
        read_house_expo(tmp_path / "none.json")
