import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from numpy.typing import NDArray

from mapping.errors import TestbedError
from mapping.truth import TruthMap, truth_map

Mask = NDArray[np.bool_]


def gap_between_squares(row: int, column: int, other: tuple[int, int]) -> float:
    """Distance in cells from a cell's centre to the nearest edge of another cell, by hand."""
    across = [max(abs(a - b) - 0.5, 0.0) for a, b in zip((row, column), other, strict=True)]
    return float(np.hypot(*across))


def brute_reachable(occupied: Mask, start: tuple[int, int], radius: float) -> Mask:
    walls = [(int(r), int(c)) for r, c in np.argwhere(occupied)]
    fits = np.array(
        [
            [
                not occupied[r, c] and all(gap_between_squares(r, c, w) >= radius for w in walls)
                for c in range(occupied.shape[1])
            ]
            for r in range(occupied.shape[0])
        ]
    )
    reached, queue = np.zeros_like(fits), [start] if fits[start] else []
    while queue:
        r, c = queue.pop()
        if 0 <= r < fits.shape[0] and 0 <= c < fits.shape[1] and fits[r, c] and not reached[r, c]:
            reached[r, c] = True
            queue += [(r + 1, c), (r - 1, c), (r, c + 1), (r, c - 1)]
    return reached


def sees(occupied: Mask, a: tuple[int, int], b: tuple[int, int]) -> bool:
    """Whether the line between two centres crosses no wall, by dense sampling."""
    share = np.linspace(0.0, 1.0, 200)[:, np.newaxis]
    line = np.round(np.array(a) + share * (np.array(b) - np.array(a))).astype(int)
    return not occupied[line[:, 0], line[:, 1]].any()


def room(rows: int = 40, columns: int = 40) -> Mask:
    occupied = np.zeros((rows, columns), dtype=np.bool_)
    occupied[[0, -1]] = occupied[:, [0, -1]] = True
    return occupied


def truth_of(occupied: Mask, start: tuple[int, int] | None, **kwargs: float) -> TruthMap:
    """A raster of 10 cm cells, the start given as (row, column)."""
    position = None if start is None else (start[1] * 0.1 + 0.05, start[0] * 0.1 + 0.05)
    values = {"robot_radius": 0.15, "sensor_range": 3.5, **kwargs}
    return truth_map(occupied, resolution=0.1, origin=(0.0, 0.0), start=position, **values)


@given(
    occupied=arrays(np.bool_, (14, 14), elements=st.sampled_from([False] * 9 + [True])),
    radius=st.floats(0.0, 0.25),  # as far as the cleared square lets the start fit
)
@settings(max_examples=40, deadline=None)
def test_reachable_cells_equal_brute_force(occupied: Mask, radius: float) -> None:
    occupied[5:10, 5:10] = False
    start = (7, 7)
    truth = truth_of(occupied, start, robot_radius=radius)
    assert np.array_equal(truth.reachable, brute_reachable(occupied, start, radius / 0.1))


@given(occupied=arrays(np.bool_, (18, 18), elements=st.sampled_from([False] * 7 + [True])))
@settings(max_examples=25, deadline=None)
def test_visible_cells_equal_brute_force_but_for_grazing_beams(occupied: Mask) -> None:
    occupied[7:11, 7:11] = False
    truth = truth_of(occupied, (8, 8), sensor_range=0.8)
    seers = [(int(r), int(c)) for r, c in np.argwhere(truth.reachable)]
    brute = truth.reachable.copy()
    for r, c in np.argwhere(~occupied & ~truth.reachable):
        near = [s for s in seers if np.hypot(s[0] - r, s[1] - c) <= 8.0]
        brute[r, c] = any(sees(occupied, s, (int(r), int(c))) for s in near)
    # A beam that crosses a cell sees it; the line between centres is a little stricter, and may
    # slip between the beams of a fan: cells at the rim of a shadow may differ, few of them.
    assert np.count_nonzero(truth.visible_free != brute) <= 0.05 * occupied.size
    assert not np.any(truth.visible_free & occupied)


def test_a_robot_that_just_fits_through_a_door_goes_through_it() -> None:
    occupied = room()
    occupied[:, 20] = True
    occupied[10:14, 20] = False  # 0.40 m
    assert truth_of(occupied, (20, 5), robot_radius=0.15).reachable[20, 30]
    assert not truth_of(occupied, (20, 5), robot_radius=0.21).reachable[20, 30]


def test_a_room_behind_a_slit_is_seen_as_far_as_the_slit_lets_one_see() -> None:
    occupied = room()
    occupied[:, 20] = True
    occupied[20, 20] = False
    truth = truth_of(occupied, (20, 5))
    assert not truth.reachable[:, 21:].any()
    assert truth.visible_free[20, 38]
    assert not truth.visible_free[2, 22]


def test_a_closed_room_and_its_walls_are_not_part_of_the_truth() -> None:
    occupied = room()
    occupied[:, 20] = True
    truth = truth_of(occupied, (20, 5))
    assert not truth.visible_free[:, 21:].any()
    assert not truth.visible_surface[:, 21:].any()
    assert np.all(truth.visible_surface[1:-1, 20])


def test_without_a_start_every_place_counts() -> None:
    occupied = room()
    occupied[:, 20] = True
    truth = truth_of(occupied, None)
    assert truth.reachable[20, 5]
    assert truth.reachable[20, 30]
    assert np.array_equal(truth.visible_free, ~occupied)


def test_sight_ends_at_the_sensors_range() -> None:
    occupied = np.zeros((9, 60), dtype=np.bool_)
    occupied[:, 5] = True
    occupied[[0, -1], 5:] = True
    occupied[3:6, 20:] = True
    occupied[2:7, 20] = True  # the robot cannot pass, its sight can
    truth = truth_of(occupied, (4, 10), robot_radius=0.25, sensor_range=1.0)
    columns = np.flatnonzero(truth.visible_free.any(axis=0))
    farthest = np.flatnonzero(truth.reachable.any(axis=0)).max() + 10
    assert columns.max() <= farthest


def test_unknown_cells_stop_the_robot_and_are_no_wall() -> None:
    occupied, unknown = room(), np.zeros((40, 40), dtype=np.bool_)
    unknown[:, 20:22] = True
    truth = truth_map(
        occupied, resolution=0.1, origin=(0.0, 0.0), start=(0.5, 2.0), unknown=unknown
    )
    assert not truth.visible_free[:, 20:].any()
    assert not truth.visible_surface[1:-1, 20].any()


@pytest.mark.parametrize(
    ("start", "reason"),
    [
        ((0.05, 0.05), "inside a wall"),
        ((9.0, 1.0), "inside the map"),
        ((0.15, 1.0), "too close"),
        ((np.nan, 1.0), "finite"),
    ],
)
def test_a_start_that_cannot_be_is_told(start: tuple[float, float], reason: str) -> None:
    with pytest.raises(TestbedError, match=reason):
        truth_map(room(), resolution=0.1, origin=(0.0, 0.0), start=start)
