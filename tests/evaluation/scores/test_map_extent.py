"""The length of a map: of a corridor that was stretched, turned, smeared or left unfinished."""

import numpy as np
import pytest
from numpy.typing import NDArray

from envs.floor_plan import FloorPlan, Wall
from envs.truth import truth_of_plan
from evaluation.scores.map_extent import map_length_error
from mapping.grid import GridConfig, OccupancyGrid
from mapping.truth import TruthMap

LENGTH, RESOLUTION = 12.0, 0.02
CELL = RESOLUTION / LENGTH
"""What one cell more or less is of the length."""


def truth_of(points: tuple[tuple[float, float], ...]) -> TruthMap:
    plan = FloorPlan(
        name="corridor", start=(0.5, 0.5, 0.0), walls=(Wall(points=points, closed=True),)
    )
    return truth_of_plan(plan, resolution=RESOLUTION)


TRUTH = truth_of(((-0.05, -0.45), (12.05, -0.45), (12.05, 1.55), (-0.05, 1.55)))


def walls_of(truth: TruthMap) -> NDArray[np.float64]:
    """Points ``(n, 2)`` [m] on every visible wall."""
    cells = np.argwhere(truth.visible_surface)[:, ::-1]
    return np.asarray((cells + 0.5) * truth.resolution + truth.origin, dtype=np.float64)


def grid_of(points: NDArray[np.float64], *, smear: float = 0.0) -> OccupancyGrid:
    """A map with walls at points, drawn five times with an error."""
    grid = OccupancyGrid(GridConfig(resolution=RESOLUTION))
    grid.cover(-3.0, 16.0, -3.0, 16.0)
    rng = np.random.default_rng(0)
    for _ in range(5):
        cells = grid.world_to_cell(points + rng.normal(0.0, smear, points.shape))
        grid.log_odds[cells[:, 0], cells[:, 1]] = 9.0
    return grid


def turned(points: NDArray[np.float64], degrees: float) -> NDArray[np.float64]:
    cos, sin = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
    return points @ np.array([[cos, sin], [-sin, cos]])


def test_a_true_map_has_no_error() -> None:
    assert map_length_error(grid_of(walls_of(TRUTH)), TRUTH) == 0.0


@pytest.mark.parametrize("stretch", [0.96, 0.99, 1.01, 1.03])
@pytest.mark.parametrize("smear", [0.0, 0.03])
def test_a_stretched_map_is_off_by_the_stretch(stretch: float, smear: float) -> None:
    grid = grid_of(walls_of(TRUTH) * [stretch, 1.0], smear=smear)
    error = map_length_error(grid, TRUTH)
    assert error == pytest.approx(abs(stretch - 1.0), abs=1.5 * CELL)


def test_a_corridor_along_y_is_measured_along_y() -> None:
    truth = truth_of(((-0.45, -0.05), (1.55, -0.05), (1.55, 12.05), (-0.45, 12.05)))
    error = map_length_error(grid_of(walls_of(truth) * [1.5, 1.02]), truth)
    assert error == pytest.approx(0.02, abs=1.5 * CELL)


def test_a_map_that_lies_elsewhere_or_is_turned_a_little_is_as_long() -> None:
    for points in (walls_of(TRUTH) + [0.2, -0.1], turned(walls_of(TRUTH), 2.0)):
        assert map_length_error(grid_of(points, smear=0.02), TRUTH) <= 2.0 * CELL


def test_a_map_without_one_end_has_no_length() -> None:
    points = walls_of(TRUTH)
    assert map_length_error(grid_of(points[points[:, 0] < 11.5]), TRUTH) is None
    assert map_length_error(grid_of(points * [1.2, 1.0]), TRUTH) is None, "too far off to be sure"


def test_an_empty_map_has_no_length() -> None:
    assert map_length_error(OccupancyGrid(), TRUTH) is None
