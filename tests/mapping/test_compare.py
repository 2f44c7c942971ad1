import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from numpy.typing import NDArray

from mapping.compare import MapScores, score_map
from mapping.grid import FREE, OCCUPIED, UNKNOWN, GridConfig, OccupancyGrid
from mapping.io.map_server import MapFile
from mapping.truth import TruthMap
from tests.mapping.arena import arena_truth

States = NDArray[np.int8]
STATES = arrays(np.int8, (9, 8), elements=st.sampled_from([UNKNOWN, FREE, OCCUPIED]))
MASK = arrays(np.bool_, (9, 8))
EDGE = 0.02


def truth_from(occupied: NDArray[np.bool_], visible: NDArray[np.bool_]) -> TruthMap:
    """A truth of any two masks; surfaces are wall beside what is visible."""
    visible = visible & ~occupied
    beside = np.zeros_like(occupied)
    for shift, axis in ((1, 0), (-1, 0), (1, 1), (-1, 1)):
        moved = np.roll(visible, shift, axis)
        moved[(slice(None),) * axis + (0 if shift == 1 else -1,)] = False
        beside |= moved
    return TruthMap(
        resolution=EDGE,
        origin=(0.3, -0.2),
        occupied=occupied,
        reachable=visible,
        visible_free=visible,
        visible_surface=beside & occupied,
    )


def as_map(states: States, *, rows: int = 0, columns: int = 0) -> MapFile:
    """A map on the truth's lattice, moved by whole cells."""
    origin = (0.3 + columns * EDGE, -0.2 + rows * EDGE)
    return MapFile(resolution=EDGE, origin=origin, states=states)


def brute_scores(states: States, truth: TruthMap) -> dict[str, float | None]:
    """The scores by loops over cells, as the design words them."""
    drawn = [tuple(cell) for cell in np.argwhere(states == OCCUPIED)]
    walls = [tuple(cell) for cell in np.argwhere(truth.visible_surface)]
    nearest = {
        name: [min(EDGE * np.hypot(a[0] - b[0], a[1] - b[1]) for b in others) for a in cells]
        for name, cells, others in (("drawn", drawn, walls), ("walls", walls, drawn))
        if others
    }
    both = nearest.get("drawn", []) + nearest.get("walls", []) if drawn and walls else []
    scores: dict[str, float | None] = {
        "adnn_m": float(np.mean(both)) if both else None,
        "h95_m": float(np.percentile(both, 95)) if both else None,
    }
    for name, within in (("f1_5cm", 0.05), ("f1_10cm", 0.10)):
        p = np.mean([d <= within + 1e-9 for d in nearest["drawn"]]) if both else 0.0
        r = np.mean([d <= within + 1e-9 for d in nearest["walls"]]) if both else 0.0
        scores[name] = (2 * p * r / (p + r) if p + r else 0.0) if walls else None
    free, visible = states == FREE, truth.visible_free
    either = np.sum(free | visible)
    scores["free_iou"] = np.sum(free & visible) / either if either else None
    scores["coverage"] = np.sum(free & visible) / np.sum(visible) if visible.any() else None
    deep = [
        (r, c)
        for r, c in np.argwhere(truth.occupied)
        if truth.occupied[max(r - 1, 0) : r + 2, max(c - 1, 0) : c + 2].all()
    ]
    wrong = sum(free[cell] for cell in deep)
    scores["false_free"] = wrong / np.sum(free) if free.any() else None
    return scores


@given(states=STATES, occupied=MASK, visible=MASK)
@settings(max_examples=80, deadline=None)
def test_every_score_equals_brute_force(
    states: States, occupied: NDArray[np.bool_], visible: NDArray[np.bool_]
) -> None:
    truth = truth_from(occupied, visible)
    scores = score_map(as_map(states), truth)
    for name, expected in brute_scores(states, truth).items():
        got = getattr(scores, name)
        assert got == pytest.approx(expected), name


def perfect(truth: TruthMap) -> States:
    states = np.full(truth.shape, UNKNOWN, dtype=np.int8)
    states[truth.visible_free] = FREE
    states[truth.visible_surface] = OCCUPIED
    return states


def test_a_perfect_map_has_perfect_scores() -> None:
    truth = arena_truth()
    states = perfect(truth)
    map_ = MapFile(resolution=truth.resolution, origin=truth.origin, states=states)
    assert score_map(map_, truth) == MapScores(
        coverage=1.0,
        f1_5cm=1.0,
        f1_10cm=1.0,
        adnn_m=0.0,
        h95_m=0.0,
        free_iou=1.0,
        false_free=0.0,
        wall_thickness_ratio=1.0,
    )


def straight_wall() -> TruthMap:
    """A wall of two cells below free floor."""
    occupied = np.zeros((40, 100), dtype=np.bool_)
    occupied[10:12] = True
    visible = np.zeros_like(occupied)
    visible[12:30] = True
    return truth_from(occupied, visible)


@pytest.mark.parametrize("cells", [0, 1, 2, 3, 6])
def test_a_map_moved_across_a_wall_is_off_by_as_much(cells: int) -> None:
    truth = straight_wall()
    scores = score_map(as_map(perfect(truth), rows=cells), truth)
    assert scores.adnn_m == pytest.approx(cells * EDGE, abs=1e-9)
    assert scores.h95_m == pytest.approx(cells * EDGE, abs=1e-9)
    assert scores.f1_5cm == (1.0 if cells * EDGE <= 0.05 else 0.0)
    assert scores.f1_10cm == (1.0 if cells * EDGE <= 0.10 else 0.0)
    assert scores.free_iou == pytest.approx((18 - cells) / (18 + cells))


def test_thickness_counts_how_many_cells_thick_a_wall_is_drawn() -> None:
    truth = straight_wall()
    states = perfect(truth)
    states[9:11] = OCCUPIED
    assert score_map(as_map(states), truth).wall_thickness_ratio == pytest.approx(3.0)


def test_thickness_is_told_in_cells_of_the_map_whatever_the_truths_are() -> None:
    truth = straight_wall()
    fine = np.repeat(np.repeat(perfect(truth), 2, axis=0), 2, axis=1)
    map_ = MapFile(resolution=EDGE / 2, origin=truth.origin, states=fine)
    assert score_map(map_, truth).wall_thickness_ratio == pytest.approx(2.0)


def test_a_map_twice_as_fine_has_the_same_areas() -> None:
    truth = straight_wall()
    fine = np.repeat(np.repeat(perfect(truth), 2, axis=0), 2, axis=1)
    scores = score_map(MapFile(resolution=EDGE / 2, origin=truth.origin, states=fine), truth)
    assert scores.free_iou == pytest.approx(1.0)
    assert scores.coverage == pytest.approx(1.0)


def test_a_map_of_a_larger_grid_is_scored_the_same() -> None:
    truth = straight_wall()
    padded = np.pad(perfect(truth), ((7, 2), (5, 30)), constant_values=UNKNOWN)
    assert score_map(as_map(padded, rows=-7, columns=-5), truth) == score_map(
        as_map(perfect(truth)), truth
    )


def test_free_space_outside_the_truth_counts_against_the_map() -> None:
    truth = straight_wall()
    states = np.pad(perfect(truth), ((0, 1), (0, 0)), constant_values=FREE)
    assert score_map(as_map(states), truth).free_iou == pytest.approx(18 / 19)


def test_floor_drawn_deep_inside_a_wall_is_false_and_its_first_layer_is_not() -> None:
    occupied = np.zeros((20, 20), dtype=np.bool_)
    occupied[:10] = True
    truth = truth_from(occupied, ~occupied)
    states = np.full((20, 20), UNKNOWN, dtype=np.int8)
    states[8:12] = FREE
    assert score_map(as_map(states), truth).false_free == pytest.approx(1 / 4)


def test_scores_that_cannot_exist_are_none() -> None:
    truth = straight_wall()
    nothing = score_map(OccupancyGrid(GridConfig(resolution=EDGE, rows=5, columns=5)), truth)
    assert nothing.f1_5cm == 0.0
    assert nothing.coverage == 0.0
    assert nothing.adnn_m is None
    assert nothing.h95_m is None
    assert nothing.false_free is None
    assert nothing.wall_thickness_ratio is None
