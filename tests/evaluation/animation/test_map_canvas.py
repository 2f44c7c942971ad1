import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from evaluation.animation.map_canvas import LEAST_WIDTH, MOST_HEIGHT, MOST_WIDTH, MapCanvas
from mapping.grid import FREE, OCCUPIED, UNKNOWN
from mapping.io.map_server import MapFile


def map_of(states: np.ndarray, origin: tuple[float, float] = (0.0, 0.0)) -> MapFile:
    return MapFile(resolution=0.01, origin=origin, states=states)


def all_free(rows: int, columns: int) -> np.ndarray:
    return np.full((rows, columns), FREE, dtype=np.int8)


@settings(max_examples=30, deadline=None)
@given(
    rows=st.integers(1, 300),
    columns=st.integers(1, 300),
    row=st.integers(0, 299),
    column=st.integers(0, 299),
    origin=st.tuples(st.integers(-500, 500), st.integers(-500, 500)),
)
def test_the_pixel_of_a_place_shows_the_cell_that_holds_it(
    rows: int, columns: int, row: int, column: int, origin: tuple[int, int]
) -> None:
    row, column = row % rows, column % columns
    states = all_free(rows, columns)
    states[row, column] = OCCUPIED
    drawn = map_of(states, (0.01 * origin[0], 0.01 * origin[1]))
    canvas = MapCanvas(drawn)
    place = np.array([[origin[0] + column + 0.5, origin[1] + row + 0.5]]) * 0.01
    right, below = np.floor(canvas.pixels(place)[0]).astype(int)
    shown = canvas.states(drawn)
    assert shown[below, right] == OCCUPIED
    zoom = round(canvas.pixels_per_metre * 0.01)
    assert np.count_nonzero(shown == OCCUPIED) == zoom**2


@pytest.mark.parametrize("shape", [(1, 1), (90, 90), (700, 2500), (2600, 8000), (5000, 300)])
def test_the_picture_is_never_too_large_nor_too_narrow_for_its_caption(
    shape: tuple[int, int],
) -> None:
    height, width = MapCanvas(map_of(all_free(*shape))).states(map_of(all_free(*shape))).shape
    assert height <= MOST_HEIGHT
    assert LEAST_WIDTH <= width <= MOST_WIDTH


def test_a_wall_of_one_cell_stays_closed_when_cells_are_drawn_as_one() -> None:
    states = all_free(2600, 8000)
    states[:, 4711] = OCCUPIED
    shown = MapCanvas(map_of(states)).states(map_of(states))
    inside = (shown != UNKNOWN).any(axis=1)
    assert np.all((shown[inside] == OCCUPIED).any(axis=1))


def test_an_earlier_map_lies_where_the_last_one_has_it_and_what_is_outside_is_left_out() -> None:
    last = map_of(all_free(400, 500), (1.0, 2.0))
    canvas = MapCanvas(last)
    early = all_free(1000, 1000)
    early[:] = OCCUPIED
    early[300:340, 200:260] = FREE  # from (2.0, 3.0) to (2.6, 3.4)
    shown = canvas.states(map_of(early, (0.0, 0.0)))
    assert shown.shape == canvas.states(last).shape
    (left, bottom), (right, top) = np.round(canvas.pixels(np.array([[2.0, 3.0], [2.6, 3.4]])))
    free = np.argwhere(shown == FREE)
    assert free.min(axis=0).tolist() == [top, left]
    assert (free.max(axis=0) + 1).tolist() == [bottom, right]
