import math

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from mapping.ray_trace import trace_beams

OCCUPIED, FREE = np.float32(4.7015), np.float32(5.11)


def slow_trace(
    log_odds: NDArray[np.float32],
    start: tuple[float, float],
    beams: list[tuple[float, float, bool]],
) -> None:
    """The thesis's update as it is told: dictionaries of cells, one case for each kind of cell."""
    for angle, length, hit in beams:
        dx, dy = math.cos(angle), math.sin(angle)
        steep = abs(dy) > abs(dx)
        a0, b0 = (start[1], start[0]) if steep else (start[0], start[1])
        a1, b1 = (
            (a0 + length * dy, b0 + length * dx) if steep else (a0 + length * dx, b0 + length * dy)
        )
        first, last, end = math.floor(a0), math.floor(a1), math.floor(b1)
        line = []
        for a in range(first, last, 1 if last > first else -1):
            b = b0 + (a + 0.5 - a0) * (end + 0.5 - b0) / (last + 0.5 - a0)
            line.append((a, math.floor(b)))
        change = {cell: -FREE for cell in line}
        if hit:
            change.update(dict.fromkeys(line[-2:], -OCCUPIED))
        change[(last, end)] = OCCUPIED if hit else -FREE
        for (a, b), amount in change.items():
            row, column = (a, b) if steep else (b, a)
            if 0 <= row < log_odds.shape[0] and 0 <= column < log_odds.shape[1]:
                log_odds[row, column] += amount


def fast_trace(
    log_odds: NDArray[np.float32],
    start: tuple[float, float],
    beams: list[tuple[float, float, bool]],
) -> None:
    angles = [angle for angle, _, _ in beams]
    trace_beams(
        log_odds,
        np.array(start),
        np.column_stack((np.cos(angles), np.sin(angles))),
        np.array([length for _, length, _ in beams]),
        np.array([hit for _, _, hit in beams]),
        OCCUPIED,
        FREE,
    )


BEAMS = st.lists(
    st.tuples(st.floats(-7.0, 7.0), st.floats(0.0, 30.0), st.booleans()), min_size=1, max_size=12
)


@given(beams=BEAMS, x=st.floats(-5.0, 25.0), y=st.floats(-5.0, 35.0))
@settings(max_examples=200, deadline=None)
def test_random_beams_equal_the_slow_reference_cell_by_cell(
    beams: list[tuple[float, float, bool]], x: float, y: float
) -> None:
    fast, slow = np.zeros((30, 20), dtype=np.float32), np.zeros((30, 20), dtype=np.float32)
    fast_trace(fast, (x, y), beams)
    slow_trace(slow, (x, y), beams)
    # The two add up the same numbers, but may round a line's last digit differently, and with it
    # pick the neighbour of a cell; that must stay as rare as it is.
    assert np.count_nonzero(~np.isclose(fast, slow, atol=1e-3)) <= 1


def test_a_whole_scan_equals_the_slow_reference() -> None:
    rng = np.random.default_rng(1)
    beams = [
        (float(np.radians(i)), float(rng.uniform(12.0, 350.0)), bool(rng.random() < 0.7))
        for i in range(360)
    ]
    fast, slow = np.zeros((600, 700), dtype=np.float32), np.zeros((600, 700), dtype=np.float32)
    fast_trace(fast, (350.3, 249.8), beams)
    slow_trace(slow, (350.3, 249.8), beams)
    assert np.allclose(fast, slow, atol=1e-2)


def test_a_hit_straight_ahead_gets_the_thesis_figures() -> None:
    cells = np.zeros((3, 12), dtype=np.float32)
    fast_trace(cells, (0.5, 1.5), [(0.0, 8.0, True)])
    expected = [-FREE] * 6 + [-OCCUPIED] * 2 + [OCCUPIED] + [0.0] * 3
    assert np.allclose(cells[1], expected)
    assert not cells[[0, 2]].any()


def test_a_beam_without_return_frees_its_last_cell_too() -> None:
    cells = np.zeros((12, 3), dtype=np.float32)
    fast_trace(cells, (1.5, 0.5), [(np.pi / 2, 8.0, False)])
    assert np.allclose(cells[:, 1], [-FREE] * 9 + [0.0] * 3)


def test_the_robots_own_cell_is_traversed_by_every_beam() -> None:
    cells = np.zeros((41, 41), dtype=np.float32)
    fast_trace(cells, (20.5, 20.5), [(float(np.radians(i)), 15.0, True) for i in range(360)])
    assert np.isclose(cells[20, 20], -360 * FREE, rtol=1e-5)


def test_nothing_is_written_outside_the_grid() -> None:
    frame = np.zeros((30, 30), dtype=np.float32)
    inner = frame[10:20, 10:20]
    fast_trace(inner, (5.0, 5.0), [(float(np.radians(i)), 300.0, True) for i in range(360)])
    inner[:] = 0.0
    assert not frame.any()
