from pathlib import Path

import numpy as np
import pytest
from matplotlib.figure import Figure
from numpy.typing import NDArray
from PIL import Image

from mapping.errors import TestbedError
from mapping.grid import GridConfig, OccupancyGrid
from mapping.thesis_plot import draw_thesis_map, save_thesis_map, thesis_cells

BLACK, WHITE, BLUE, RED = (0, 0, 0), (255, 255, 255), (158, 202, 225), (215, 25, 28)


def small_map() -> OccupancyGrid:
    """Free ground of 2 x 1 m, a wall at its right end, unknown around."""
    grid = OccupancyGrid(GridConfig(origin=(-2.0, -2.0), rows=400, columns=500, grows=False))
    grid.log_odds[150:250, 100:300] = -5.0
    grid.log_odds[150:250, 300] = 5.0
    return grid


def drawn(start: tuple[float, float, float], obstacles_only: bool) -> Figure:
    figure = Figure()
    draw_thesis_map(
        figure.subplots(), small_map(), start_pose_map=start, obstacles_only=obstacles_only
    )
    return figure


def pixel(figure: Figure, x: float, y: float) -> tuple[int, ...]:
    """The colour drawn at a place in the axes' units."""
    image = figure.axes[0].images[0]
    left, right, bottom, top = image.get_extent()
    colours: NDArray[np.uint8] = np.asarray(image.get_array())
    row = int((y - bottom) / (top - bottom) * colours.shape[0])
    column = int((x - left) / (right - left) * colours.shape[1])
    return tuple(int(value) for value in colours[row, column])


def test_the_start_is_at_cell_1000_1000_and_its_heading_is_up() -> None:
    start = (3.0, -1.0, np.pi / 2)
    assert thesis_cells([[3.0, -1.0]], start, 0.01) == pytest.approx(np.array([[1000.0, 1000.0]]))
    ahead, left = (3.0, 1.0), (2.5, -1.0)
    assert thesis_cells([ahead], start, 0.01) == pytest.approx(np.array([[1000.0, 1200.0]]))
    assert thesis_cells([left], start, 0.01) == pytest.approx(np.array([[950.0, 1000.0]]))
    # thesis 4.3.4: x' = -y, y' = x for a start at the origin
    assert thesis_cells([[1.5, 0.5]], np.zeros(3), 0.01) == pytest.approx(np.array([[950, 1150]]))


@pytest.mark.parametrize("start", [(0.0, 0.0, 0.0), (0.5, 0.2, 2.0)])
def test_three_colours_lie_where_the_states_are(start: tuple[float, float, float]) -> None:
    figure = drawn(start, obstacles_only=False)
    for place, colour in (((1.005, 0.3), BLACK), ((0.9, 0.3), WHITE), ((1.2, 0.3), BLUE)):
        x, y = thesis_cells([place], start, 0.01)[0]
        assert pixel(figure, x, y) == colour


def test_obstacles_alone_leave_the_rest_white_and_crop_to_them() -> None:
    figure = drawn((0.0, 0.0, 0.0), obstacles_only=True)
    ax = figure.axes[0]
    assert ax.get_xlim() == pytest.approx((919, 1080), abs=2)
    assert ax.get_ylim() == pytest.approx((1070, 1131), abs=2)
    assert pixel(figure, 1000.5, 1100.5) == BLACK
    assert pixel(figure, 1000.5, 1120.5) == WHITE
    assert (ax.get_xlabel(), ax.get_ylabel()) == ("x' [cells of 1 cm]", "y' [cells of 1 cm]")
    assert ax.get_aspect() == 1.0


def test_a_thin_wall_of_a_large_map_is_not_lost() -> None:
    grid = OccupancyGrid(GridConfig(origin=(0.0, 0.0), rows=4000, columns=300, grows=False))
    grid.log_odds[:, 111] = 5.0
    figure = Figure()
    draw_thesis_map(figure.subplots(), grid, obstacles_only=True)
    image = np.asarray(figure.axes[0].images[0].get_array())
    assert max(image.shape) <= 1200
    assert np.all(image == 0, axis=-1).any(axis=0).mean() > 0.97, "but for the margin"


def test_the_picture_is_saved_with_the_path_and_the_same_bytes(tmp_path: Path) -> None:
    path = np.array([[-0.5, 0.0, 0.0], [0.8, 0.2, 0.0]])
    for name in ("a.png", "b.png"):
        save_thesis_map(tmp_path / name, small_map(), path=path, obstacles_only=False, title="t")
    pixels = np.asarray(Image.open(tmp_path / "a.png").convert("RGB")).reshape(-1, 3)
    seen = {tuple(int(v) for v in colour) for colour in np.unique(pixels, axis=0)}
    assert {BLACK, WHITE, BLUE, RED} <= seen
    assert (tmp_path / "a.png").read_bytes() == (tmp_path / "b.png").read_bytes()


def test_a_map_of_nothing_can_be_drawn_and_a_folder_that_is_not_there_is_told(
    tmp_path: Path,
) -> None:
    save_thesis_map(tmp_path / "a.png", OccupancyGrid(), path=np.empty((0, 3)))
    assert (tmp_path / "a.png").exists()
    with pytest.raises(TestbedError, match="cannot be written"):
        save_thesis_map(tmp_path / "none" / "a.png", small_map())
