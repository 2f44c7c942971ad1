from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from matplotlib.figure import Figure
from PIL import Image

from mapping.errors import TestbedError
from mapping.graph_plot import draw_graph, save_graph_picture
from mapping.pose_graph import PoseGraph

TRIANGLE = PoseGraph(
    ids=np.array([7, 3, 5]),
    poses=np.array([[0.0, 0.0, 0.0], [2.0, 0.0, 1.0], [2.0, 1.0, 2.0]]),
    edges=np.array([[7, 3], [3, 5], [5, 7]]),
    relative_poses=np.zeros((3, 3)),
    information=np.tile(np.eye(3), (3, 1, 1)),
)


def test_every_edge_lies_between_its_vertices_in_metres() -> None:
    ax = Figure().subplots()
    draw_graph(ax, TRIANGLE)
    other, along = (collection.get_segments() for collection in ax.collections)
    assert np.array_equal(other, [[[2.0, 1.0], [0.0, 0.0]]])
    assert np.array_equal(along, [[[0.0, 0.0], [2.0, 0.0]], [[2.0, 0.0], [2.0, 1.0]]])
    assert (ax.get_xlabel(), ax.get_ylabel()) == ("x [m]", "y [m]")
    assert ax.get_aspect() == 1.0
    assert np.array_equal(ax.lines[0].get_xydata(), [[0.0, 0.0]]), "the first vertex is held"


def test_the_same_graphs_give_the_same_bytes(tmp_path: Path) -> None:
    moved = replace(TRIANGLE, poses=TRIANGLE.poses + 0.5, fixed=(5,))
    for name in ("a.png", "b.png"):
        save_graph_picture(tmp_path / name, TRIANGLE, moved, ("before", "after"))
    assert (tmp_path / "a.png").read_bytes() == (tmp_path / "b.png").read_bytes()
    assert Image.open(tmp_path / "a.png").size == (1440, 792)


def test_a_graph_without_edges_can_be_drawn(tmp_path: Path) -> None:
    alone = PoseGraph(ids=np.array([4]), poses=np.zeros((1, 3)))
    save_graph_picture(tmp_path / "a.png", alone, alone)
    assert (tmp_path / "a.png").exists()


def test_a_folder_that_is_not_there_is_told(tmp_path: Path) -> None:
    with pytest.raises(TestbedError, match="cannot be written"):
        save_graph_picture(tmp_path / "none" / "a.png", TRIANGLE, TRIANGLE)
