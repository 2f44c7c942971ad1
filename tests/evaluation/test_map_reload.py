"""Maps that are written, read back by a reader that knows only what map_server's wiki says."""

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from evaluation.map_reload import map_reloads
from mapping.grid import GridConfig, OccupancyGrid
from mapping.io.map_server import write_map


def grid_of(seed: int, *, shape: tuple[int, int] = (30, 20), known: float = 0.6) -> OccupancyGrid:
    rng = np.random.default_rng(seed)
    grid = OccupancyGrid(
        GridConfig(resolution=0.05, origin=(-1.3, 2.7), rows=shape[0], columns=shape[1])
    )
    log_odds = rng.choice([-9.0, 9.0], size=shape)
    grid.log_odds = np.where(rng.random(shape) < known, log_odds, 0.0).astype(np.float32)
    return grid


@given(
    seed=st.integers(0, 1000),
    shape=st.tuples(st.integers(1, 40), st.integers(1, 40)),
    known=st.sampled_from([0.0, 0.02, 1.0]),
    margin=st.integers(0, 12),
)
def test_every_map_that_is_written_reloads(
    seed: int,
    shape: tuple[int, int],
    known: float,
    margin: int,
    tmp_path_factory: pytest.TempPathFactory,
) -> None:
    grid = grid_of(seed, shape=shape, known=known)
    path = write_map(tmp_path_factory.mktemp("map") / "map.yaml", grid, margin_cells=margin)
    assert map_reloads(path, grid)


@pytest.mark.parametrize("state", [-9.0, 9.0, 0.0])
def test_one_cell_that_differs_is_found(state: float, tmp_path: Path) -> None:
    grid = grid_of(0)
    path = write_map(tmp_path / "map.yaml", grid)
    row, column = np.argwhere(grid.log_odds != state)[7]
    grid.log_odds[row, column] = state
    assert not map_reloads(path, grid)


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("negate: 0", "negate: 1"),
        ("free_thresh: 0.196", "free_thresh: 0.25"),
        ("- -1.8", "- -1.75"),
        ("- -1.8", "- -1.83"),
        ("resolution: 0.05", "resolution: 0.051"),
        ("image: map.pgm", "image: none.pgm"),
        ("resolution: 0.05", "resolution: [fine]"),
        ("resolution", "resolutoin"),
        ("- -1.8", "- [-1.8"),
    ],
)
def test_a_yaml_that_says_something_else_is_found(old: str, new: str, tmp_path: Path) -> None:
    grid = grid_of(0, known=1.0)
    path = write_map(tmp_path / "map.yaml", grid)
    assert map_reloads(path, grid)
    text = path.read_text()
    assert old in text
    path.write_text(text.replace(old, new))
    assert not map_reloads(path, grid)


def test_an_image_upside_down_is_found(tmp_path: Path) -> None:
    grid = grid_of(0)
    path = write_map(tmp_path / "map.yaml", grid)
    grid.log_odds = np.flipud(grid.log_odds)
    assert not map_reloads(path, grid)
