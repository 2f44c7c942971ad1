import math
from itertools import combinations

import numpy as np
import pytest
from matplotlib.figure import Figure

from mapping.path_plot import (
    GOAL_SIZE,
    MOST_ARROWS,
    MOST_NUMBERS,
    draw_goals,
    draw_path,
)

SCALE = 50.0
"""Points of the page per metre."""


def numbers_drawn(goals: np.ndarray) -> dict[int, tuple[float, float]]:
    ax = Figure().subplots()
    draw_goals(ax, goals, SCALE)
    return {int(text.get_text()): text.xy for text in ax.texts}


def test_goals_are_numbered_from_1_on_where_they_are() -> None:
    numbers = numbers_drawn(np.array([[0.0, 0.0], [2.0, 1.0], [-1.0, 3.0]]))
    assert numbers == {1: (0.0, 0.0), 2: (2.0, 1.0), 3: (-1.0, 3.0)}


def test_numbers_do_not_cover_each_other_and_are_not_too_many() -> None:
    goals = np.random.default_rng(0).uniform(0.0, 20.0, (400, 2))
    numbers = numbers_drawn(goals)
    assert 20 < len(numbers) <= MOST_NUMBERS
    assert 1 in numbers
    for one, other in combinations(numbers.values(), 2):
        assert math.dist(one, other) * SCALE >= GOAL_SIZE
    for number, place in numbers.items():
        assert place == pytest.approx(tuple(goals[number - 1]))


@pytest.mark.parametrize("length", [0.0, 5.0, 500.0])
def test_arrows_point_the_way_the_robot_went(length: float) -> None:
    path = np.column_stack((np.linspace(0.0, length, 300), np.zeros(300)))
    ax = Figure().subplots()
    draw_path(ax, path, SCALE)
    arrows = ax.texts
    assert len(arrows) <= MOST_ARROWS
    assert (len(arrows) > 0) == (length > 0.0)
    for arrow in arrows:
        assert 0.0 <= arrow.xyann[0] < arrow.xy[0] <= length


def test_a_robot_that_never_moved_has_its_ring() -> None:
    ax = Figure().subplots()
    draw_path(ax, np.zeros((1, 2)), SCALE)
    assert len(ax.lines) == 2
    assert len(ax.texts) == 0
