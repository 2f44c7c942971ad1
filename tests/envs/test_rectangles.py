import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from envs.rectangles import rectangles

masks = arrays(np.bool_, st.tuples(st.integers(1, 12), st.integers(1, 12)))


def slow_rectangles(mask):
    """The same greedy cover, cell by cell on sets."""
    left = {(int(r), int(c)) for r, c in np.argwhere(mask)}
    found = []
    while left:
        row, column = min(left)
        wide = grown(left, row, column, rows_first=False)
        tall = grown(left, row, column, rows_first=True)
        best = tall if area(row, column, *tall) > area(row, column, *wide) else wide
        left -= cells(row, column, *best)
        found.append([row, best[0], column, best[1]])
    return found


def grown(left, row, column, *, rows_first):
    """Grow a rectangle from one cell, first one way as far as it goes, then the other."""
    last = [row + 1, column + 1]
    for axis in (0, 1) if rows_first else (1, 0):
        while True:
            longer = [*last]
            longer[axis] += 1
            if not cells(row, column, *longer) <= left:
                break
            last = longer
    return last


def cells(row, column, last_row, last_column):
    return {(r, c) for r in range(row, last_row) for c in range(column, last_column)}


def area(row, column, last_row, last_column):
    return (last_row - row) * (last_column - column)


@given(mask=masks)
@settings(max_examples=60, deadline=None)
def test_rectangles_equal_the_plain_reference(mask):
    assert rectangles(mask).tolist() == slow_rectangles(mask)


@given(mask=masks)
@settings(max_examples=60, deadline=None)
def test_every_true_cell_is_covered_once_and_no_other(mask):
    covered = np.zeros(mask.shape, dtype=int)
    for first_row, last_row, first_column, last_column in rectangles(mask):
        covered[first_row:last_row, first_column:last_column] += 1
    np.testing.assert_array_equal(covered, mask.astype(int))


def test_the_walls_of_a_room_become_four_rectangles():
    room = np.ones((40, 60), dtype=bool)
    room[2:-2, 2:-2] = False
    assert len(rectangles(room)) == 4
