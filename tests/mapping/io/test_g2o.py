"""Pose graphs in and out of g2o files."""

from pathlib import Path
from tempfile import TemporaryDirectory

import gtsam
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from mapping.errors import TestbedError
from mapping.io.g2o import read_g2o, write_g2o
from mapping.pose_graph import PoseGraph

SQUARE = """\
# a square
VERTEX_SE2 0 0 0 0
VERTEX_SE2 1 1.0 0.1 1.5
VERTEX_SE2 7 1 1 3.0

PARAMS_SE2OFFSET 0 0 0 0
FIX 0
EDGE_SE2 0 1 1 0 1.57 10 1 2 20 3 30
EDGE_SE2 1 7 1 0 -4.0 10 0 0 10 0 10 # wrapped
"""


def graph(rng: np.random.Generator, vertices: int, edges: int) -> PoseGraph:
    """A graph of random poses and measurements whose ids are anything but 0, 1, 2."""
    ids = rng.choice(10**6, vertices, replace=False)
    roots = rng.normal(size=(edges, 3, 3))
    information = roots @ roots.transpose(0, 2, 1)
    return PoseGraph(
        ids=ids,
        poses=rng.uniform(-3.0, 3.0, (vertices, 3)),
        edges=rng.choice(ids, (edges, 2)),
        relative_poses=rng.uniform(-3.0, 3.0, (edges, 3)),
        information=(information + information.transpose(0, 2, 1)) / 2.0,
        fixed=(int(ids[0]),),
    )


@settings(max_examples=30)
@given(st.integers(0, 2**32), st.integers(1, 20), st.integers(0, 20))
def test_a_graph_comes_back_as_it_was(seed: int, vertices: int, edges: int) -> None:
    before = graph(np.random.default_rng(seed), vertices, edges)
    with TemporaryDirectory() as folder:
        write_g2o(Path(folder) / "a.g2o", before)
        after = read_g2o(Path(folder) / "a.g2o")
    for name in ("ids", "poses", "edges", "relative_poses", "information", "fixed"):
        assert np.array_equal(getattr(before, name), getattr(after, name)), name


def test_gtsam_reads_the_same_numbers_from_what_is_written(tmp_path: Path) -> None:
    written = graph(np.random.default_rng(3), 12, 20)
    write_g2o(tmp_path / "a.g2o", written)
    factors, values = gtsam.readG2o(str(tmp_path / "a.g2o"), False)
    for vertex, pose in zip(written.ids.tolist(), written.poses, strict=True):
        found = values.atPose2(vertex)
        assert [found.x(), found.y(), found.theta()] == pytest.approx(pose)
    assert factors.size() == len(written.edges)
    for i, edge in enumerate(written.edges.tolist()):
        factor = factors.at(i)
        found = factor.measured()
        assert list(factor.keys()) == edge
        assert [found.x(), found.y(), found.theta()] == pytest.approx(written.relative_poses[i])
        assert factor.noiseModel().information() == pytest.approx(written.information[i])


def test_a_file_by_hand_is_read_field_by_field(tmp_path: Path) -> None:
    (tmp_path / "a.g2o").write_text(SQUARE)
    square = read_g2o(tmp_path / "a.g2o")
    assert square.ids.tolist() == [0, 1, 7]
    assert square.poses[1].tolist() == [1.0, 0.1, 1.5]
    assert square.edges.tolist() == [[0, 1], [1, 7]]
    assert square.information[0].tolist() == [[10, 1, 2], [1, 20, 3], [2, 3, 30]]
    assert square.relative_poses[1] == pytest.approx([1.0, 0.0, 2.0 * np.pi - 4.0])
    assert square.fixed == (0,)


@pytest.mark.parametrize(
    ("line", "told"),
    [
        ("VERTEX_SE3:QUAT 3 0 0 0 0 0 0 1", "a graph in space"),
        ("VERTEX_XY 3 0 0", "a landmark"),
        ("EDGE2 0 1 1 0 0 1 0 1 1 0 0", "TORO"),
        ("NONSENSE 1", "must be VERTEX_SE2, EDGE_SE2 or FIX"),
        ("VERTEX_SE2 3 0 0", "4 words; must be 5"),
        ("VERTEX_SE2 three 0 0 0", "three"),
        ("EDGE_SE2 0 1 1 0 0 1 0 0 1 0", "11 words; must be 12"),
    ],
)
def test_a_line_that_is_not_understood_is_told(tmp_path: Path, line: str, told: str) -> None:
    (tmp_path / "a.g2o").write_text(SQUARE + line + "\n")
    with pytest.raises(TestbedError, match=rf"a\.g2o: line 10: .*{told}") as error:
        read_g2o(tmp_path / "a.g2o")
    assert "\n" not in str(error.value)


@pytest.mark.parametrize(
    ("line", "told"),
    [
        ("EDGE_SE2 0 2 1 0 0 1 0 0 1 0 1", "no vertex 2"),
        ("FIX 5", "no vertex 5"),
        ("VERTEX_SE2 7 0 0 0", "two vertices have one id"),
        ("VERTEX_SE2 3 0 nan 0", "poses: not finite"),
        ("EDGE_SE2 0 7 1 0 0 1 0 0 -1 0 1", r"information of edge \(0, 7\)"),
    ],
)
def test_a_file_that_is_no_graph_is_told(tmp_path: Path, line: str, told: str) -> None:
    (tmp_path / "a.g2o").write_text(SQUARE + line + "\n")
    with pytest.raises(TestbedError, match=rf"a\.g2o: pose graph: .*{told}"):
        read_g2o(tmp_path / "a.g2o")


def test_a_missing_file_is_told(tmp_path: Path) -> None:
    with pytest.raises(TestbedError, match=r"gone\.g2o: cannot be read"):
        read_g2o(tmp_path / "gone.g2o")


def test_arrays_that_do_not_fit_together_are_refused() -> None:
    with pytest.raises(TestbedError, match="shapes"):
        PoseGraph(ids=np.arange(2), poses=np.zeros((3, 3)))
