import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from envs.plan_raster import rasterize
from envs.text_maze import plan_from_text, read_text_maze
from mapping.errors import TestbedError

MAZE = """\
name: bend
cell: 0.8

#####
#^..#
###.#
#####
"""


def test_the_text_is_the_plan_seen_from_above():
    plan = plan_from_text(MAZE)
    assert plan.name == "bend"
    assert plan.start == pytest.approx((1.2, 2.0, 0.5 * math.pi))
    assert plan.bounds == pytest.approx((0.0, 4.0, 0.0, 3.2))
    solid = rasterize(plan, resolution=0.8, origin=(0.0, 0.0), shape=(4, 5))
    assert ["".join(".#"[int(cell)] for cell in row) for row in solid[::-1]] == [
        *("#####", "#...#", "###.#", "#####")
    ]


@pytest.mark.parametrize(
    ("sign", "yaw"),
    [("S", 0.0), (">", 0.0), ("^", math.pi / 2), ("<", math.pi), ("v", -math.pi / 2)],
)
def test_the_start_sign_gives_the_heading(sign, yaw):
    assert plan_from_text(f"###\n#{sign}#\n###").start == pytest.approx((0.75, 0.75, yaw))


@given(blocks=arrays(np.bool_, st.tuples(st.integers(1, 8), st.integers(1, 8))))
@settings(max_examples=40, deadline=None)
def test_every_block_is_solid_and_nothing_else(blocks):
    rows = [
        "#" * (blocks.shape[1] + 2),
        *("#" + "".join(".#"[int(b)] for b in row) + "#" for row in blocks),
    ]
    text = "\n".join([*rows, "#" + "S".ljust(blocks.shape[1], ".") + "#", rows[0]])
    plan = plan_from_text(text)
    lines = text.splitlines()
    solid = rasterize(plan, resolution=0.5, origin=(0.0, 0.0), shape=(len(lines), len(lines[0])))
    wanted = [[sign == "#" for sign in line] for line in reversed(lines)]
    np.testing.assert_array_equal(solid, wanted)


def test_a_maze_without_a_start_starts_within_its_walls():
    plan = plan_from_text("    #####\n    #...#\n    #...#\n    #...#\n    #####\n")
    assert plan.start[:2] == pytest.approx((6.5 * 0.5, 2.5 * 0.5), abs=0.05)


def test_the_walls_of_a_room_are_four_long_boxes():
    text = "\n".join(["#" * 30, *["#" + "." * 28 + "#"] * 20, "#" * 30])
    assert len(plan_from_text(text).boxes) == 4


@pytest.mark.parametrize(
    ("text", "named"),
    [
        ("###\n#x#\n###", "line 2, column 2: 'x'; must be one of '#'"),
        ("cell: 1\n####\n#SS#\n####", "line 3, column 3: 'S' is a second start"),
        ("cell: none\n###", "line 1: cell: 'none'; must be a finite number above 0"),
        ("cell: 0\n###", "line 1: cell: '0'"),
        ("cell: nan\n###", "line 1: cell: 'nan'"),
        ("cell: 1\ncell: 2\n###", "line 2: cell is given twice"),
        ("colour: red\n###", "line 1: unknown key 'colour'; must be one of cell, height"),
        ("height: 0.1\n###\n#S#\n###", "height: 0.1 m"),
        ("cell: 0.1\n###\n#S#\n###", "start: (0.15, 0.15) is 0.050 m from boxes["),
        ("", "zero area"),
        ("...\n.S.\n...", "zero area"),
        ("###\n###", "start: none found"),
    ],
)
def test_a_fault_is_told_with_its_line(text, named, tmp_path):
    path = tmp_path / "maze.txt"
    path.write_text(text)
    with pytest.raises(TestbedError) as raised:
        read_text_maze(path)
    assert str(raised.value).startswith(f"{path}: ")
    assert named in str(raised.value)


def test_the_file_names_the_maze_when_the_text_does_not(tmp_path):
    path = tmp_path / "my_maze.txt"
    path.write_text("###\n#S#\n###\n")
    assert read_text_maze(path).name == "my_maze"
    with pytest.raises(TestbedError, match="no such file"):
        read_text_maze(tmp_path / "none.txt")
    with pytest.raises(TestbedError, match="cannot be read"):
        read_text_maze(tmp_path)
