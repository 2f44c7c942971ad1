import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from mapping.compare import score_map
from mapping.coverage import CoverageMeter
from mapping.grid import GridConfig, OccupancyGrid
from mapping.truth import TruthMap


def random_truth(rng: np.random.Generator) -> TruthMap:
    occupied = rng.random((150, 130)) < 0.2
    visible = ~occupied & (rng.random(occupied.shape) < 0.8)
    visible[64:128, :64] = False
    return TruthMap(
        resolution=0.05,
        origin=(-1.0, 0.5),
        occupied=occupied,
        reachable=visible,
        visible_free=visible,
        visible_surface=occupied,
    )


@given(seed=st.integers(0, 999), shift=st.tuples(st.integers(-40, 40), st.integers(-40, 40)))
@settings(max_examples=25, deadline=None)
def test_the_meter_tells_what_the_score_tells(seed: int, shift: tuple[int, int]) -> None:
    rng = np.random.default_rng(seed)
    truth = random_truth(rng)
    origin = (-1.0 + 0.05 * shift[0], 0.5 + 0.05 * shift[1])
    grid = OccupancyGrid(GridConfig(resolution=0.05, origin=origin, rows=140, columns=160))
    grid.log_odds[:] = rng.normal(-3.0, 2.0, grid.shape)
    assert CoverageMeter(truth).measure(grid) == pytest.approx(score_map(grid, truth).coverage)


@given(seed=st.integers(0, 999))
@settings(max_examples=20, deadline=None)
def test_counting_only_what_changed_tells_the_same(seed: int) -> None:
    rng = np.random.default_rng(seed)
    truth = random_truth(rng)
    grid = OccupancyGrid(GridConfig(resolution=0.05, origin=(-1.0, 0.5), rows=150, columns=130))
    meter = CoverageMeter(truth)
    for _ in range(5):
        row, column = rng.integers(0, 150), rng.integers(0, 130)
        grid.log_odds[row : row + 40, column : column + 40] -= 2.0
        left, bottom = grid.origin + [column * 0.05, row * 0.05]
        window = (float(left), float(left) + 2.0, float(bottom), float(bottom) + 2.0)
        assert meter.measure(grid, window) == CoverageMeter(truth).measure(grid)


def test_a_window_far_away_changes_nothing() -> None:
    truth = random_truth(np.random.default_rng(0))
    grid = OccupancyGrid(GridConfig(resolution=0.05, rows=10, columns=10))
    assert CoverageMeter(truth).measure(grid, (90.0, 91.0, 90.0, 91.0)) == 0.0


def test_a_map_drawn_anew_is_counted_whole_whatever_the_window() -> None:
    truth = random_truth(np.random.default_rng(0))
    grid = OccupancyGrid(GridConfig(resolution=0.05, origin=(-1.0, 0.5), rows=150, columns=130))
    meter = CoverageMeter(truth)
    far = (90.0, 91.0, 90.0, 91.0)
    assert meter.measure(grid, far) == 0.0
    grid.log_odds[:] = -5.0
    assert meter.measure(grid, far) == 0.0
    grid.redraws += 1
    assert meter.measure(grid, far) == 1.0
