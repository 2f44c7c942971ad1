"""Maps as text, against a plain look at every square of cells."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from mapping.grid import GridConfig, OccupancyGrid
from mapping.text_map import ROBOT, text_map

FAR_AWAY = np.array([99.0, 99.0, 0.0])


def grid_of(log_odds: np.ndarray) -> OccupancyGrid:
    rows, columns = log_odds.shape
    grid = OccupancyGrid(
        GridConfig(resolution=0.1, origin=(0.0, 0.0), rows=rows, columns=columns, grows=False)
    )
    grid.log_odds[:] = log_odds
    return grid


def test_a_small_room_is_drawn_cell_by_cell() -> None:
    log_odds = np.full((6, 8), 5.0)
    log_odds[2:4, 1:7] = -5.0
    drawn = text_map(grid_of(log_odds), np.array([0.35, 0.25, 0.0]), 80, 24)
    assert drawn == ["████████", f"█  {ROBOT}   █", "████████"]


def test_upper_and_lower_half_are_told_apart_and_the_unknown_is_shaded() -> None:
    log_odds = np.array([[5.0, -5.0, 0.0, -5.0], [-5.0, 5.0, 0.0, 0.0]])
    assert text_map(grid_of(log_odds), FAR_AWAY, 80, 24) == ["▄▀░ "]


@given(
    seed=st.integers(0, 1000),
    rows=st.integers(1, 90),
    columns=st.integers(1, 90),
    width=st.integers(1, 40),
    height=st.integers(1, 20),
)
@settings(max_examples=60)
def test_it_keeps_to_its_size_and_loses_no_wall(
    seed: int, rows: int, columns: int, width: int, height: int
) -> None:
    log_odds = np.random.default_rng(seed).choice(
        [-5.0, 0.0, 5.0], (rows, columns), p=[0.5, 0.4, 0.1]
    )
    drawn = text_map(grid_of(log_odds), FAR_AWAY, width, height)
    assert len(drawn) <= height
    assert all(len(line) <= width for line in drawn)
    assert ("█" in "".join(drawn) or "▀" in "".join(drawn) or "▄" in "".join(drawn)) == bool(
        (log_odds > 3.0).any()
    )


def test_of_nothing_known_there_is_nothing_to_draw() -> None:
    assert text_map(OccupancyGrid(), FAR_AWAY, 80, 24) == []


@pytest.mark.parametrize("pose", [(-5.0, 0.0, 0.0), (0.0, 99.0, 0.0)])
def test_a_robot_outside_the_map_is_not_drawn(pose: tuple[float, float, float]) -> None:
    drawn = text_map(grid_of(np.full((4, 4), -5.0)), np.array(pose), 80, 24)
    assert ROBOT not in "".join(drawn)
