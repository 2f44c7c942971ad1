from pathlib import Path

import numpy as np
import pytest
from matplotlib.figure import Figure
from PIL import Image

from mapping.errors import TestbedError
from mapping.grid import FREE, OCCUPIED, UNKNOWN, OccupancyGrid
from mapping.io.map_server import MapFile
from mapping.path_plot import GOAL_COLOUR, LEFT_OVER_COLOUR
from mapping.plot import draw_map, save_map_picture
from tests.mapping.arena import arena_truth


def small_map(rows: int = 40, columns: int = 60) -> MapFile:
    states = np.full((rows, columns), UNKNOWN, dtype=np.int8)
    states[5:-5, 5:-5] = FREE
    states[5, 5:-5] = OCCUPIED
    return MapFile(resolution=0.1, origin=(-3.0, -2.0), states=states)


def test_the_picture_has_the_three_states_and_the_path(tmp_path: Path) -> None:
    path = np.array([[-1.0, 0.0], [1.0, 0.5]])
    save_map_picture(tmp_path / "a.png", small_map(), path=path, truth=arena_truth(0.05), title="t")
    pixels = np.asarray(Image.open(tmp_path / "a.png").convert("RGB")).reshape(-1, 3)
    seen = {tuple(int(v) for v in colour) for colour in np.unique(pixels, axis=0)}
    black, white, blue, red = (0, 0, 0), (255, 255, 255), (158, 202, 225), (215, 25, 28)
    assert {black, white, blue, red} <= seen


def test_goals_and_frontiers_left_over_are_marked_and_explained(tmp_path: Path) -> None:
    path = np.array([[-1.0, 0.0], [1.0, 0.5]])
    places = {"goals": [[0.0, 0.0], [1.0, -0.5]], "left_over": [[-1.5, 1.0]]}
    for name, drawn in (("without.png", {}), ("with.png", places)):
        save_map_picture(tmp_path / name, small_map(), path=path, **drawn)
    marks = [tuple(bytes.fromhex(colour[1:])) for colour in (GOAL_COLOUR, LEFT_OVER_COLOUR)]
    for name, are_there in (("without.png", False), ("with.png", True)):
        pixels = np.asarray(Image.open(tmp_path / name).convert("RGB"))
        for mark in marks:
            assert np.all(pixels == mark, axis=-1).any() == are_there


def test_a_narrow_map_is_drawn_larger(tmp_path: Path) -> None:
    for name, rows in (("square.png", 200), ("narrow.png", 50)):
        save_map_picture(tmp_path / name, small_map(rows=rows, columns=200))
    square, narrow = (Image.open(tmp_path / name).size for name in ("square.png", "narrow.png"))
    assert narrow[0] > 1.3 * square[0]


def test_axes_are_in_metres_with_equal_aspect() -> None:
    ax = Figure().subplots()
    draw_map(ax, small_map())
    assert (ax.get_xlabel(), ax.get_ylabel()) == ("x [m]", "y [m]")
    assert ax.get_aspect() == 1.0
    # the known part and 0.3 m around
    assert ax.get_xlim() == pytest.approx((-2.8, 2.8))
    assert ax.get_ylim() == pytest.approx((-1.8, 1.8))


def test_a_thin_wall_of_a_large_map_is_not_lost() -> None:
    states = np.full((5000, 3000), FREE, dtype=np.int8)
    states[:, 1111] = OCCUPIED
    ax = Figure().subplots()
    draw_map(ax, MapFile(resolution=0.01, origin=(0.0, 0.0), states=states))
    image = np.asarray(ax.images[0].get_array())
    assert max(image.shape) <= 1200
    wall = np.all(image == 0, axis=-1)
    assert wall.any(axis=1).mean() > 0.97  # but for the margin


def test_the_same_map_gives_the_same_bytes(tmp_path: Path) -> None:
    for name in ("a.png", "b.png"):
        save_map_picture(tmp_path / name, small_map())
    assert (tmp_path / "a.png").read_bytes() == (tmp_path / "b.png").read_bytes()


def test_scale_makes_the_picture_larger(tmp_path: Path) -> None:
    save_map_picture(tmp_path / "a.png", small_map())
    save_map_picture(tmp_path / "b.png", small_map(), scale=2.0)
    one, two = Image.open(tmp_path / "a.png").size, Image.open(tmp_path / "b.png").size
    assert two == pytest.approx((2 * one[0], 2 * one[1]), abs=2)


def test_a_map_of_nothing_can_be_drawn(tmp_path: Path) -> None:
    save_map_picture(tmp_path / "a.png", OccupancyGrid(), path=np.empty((0, 2)))
    assert (tmp_path / "a.png").exists()


def test_a_folder_that_is_not_there_is_told(tmp_path: Path) -> None:
    with pytest.raises(TestbedError, match="cannot be written"):
        save_map_picture(tmp_path / "none" / "a.png", small_map())
