import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mapping.grid import UNKNOWN
from nav.planner import CostField
from nav.unknown_ground import FARTHEST_BEYOND, MARGIN, UNKNOWN_COST, with_unknown_ground
from tests.nav.grids import costmap_of, grid_from_text, random_grid


@given(
    seed=st.integers(0, 1000),
    place=st.tuples(st.floats(-8.0, 12.0), st.floats(-8.0, 12.0)),
)
def test_what_is_known_stays_as_it_is_and_where_it_is(
    seed: int, place: tuple[float, float]
) -> None:
    costmap = costmap_of(random_grid(seed))
    wider = with_unknown_ground(costmap, np.array([place]))
    rows, columns = np.nonzero(costmap.states != UNKNOWN)
    cells = wider.world_to_cell(costmap.cell_to_world(np.column_stack((rows, columns))))
    assert np.array_equal(wider.states[cells[:, 0], cells[:, 1]], costmap.states[rows, columns])
    assert np.array_equal(wider.cost[cells[:, 0], cells[:, 1]], costmap.cost[rows, columns])
    assert (
        np.isfinite(wider.cost[wider.states == UNKNOWN]).any()
        or not (wider.states == UNKNOWN).any()
    )
    row, column = wider.world_to_cell(place)
    assert 0 <= row < wider.states.shape[0]
    assert 0 <= column < wider.states.shape[1]


def test_the_unknown_is_crossed_but_not_what_is_near_a_wall_in_it() -> None:
    costmap = costmap_of(grid_from_text("\n".join(["." * 20 + "?" * 20] * 20)))
    wider = with_unknown_ground(costmap, np.array([[1.5, 0.5]]))
    assert wider.cost[10 + 0, 30] == pytest.approx(UNKNOWN_COST)
    beside = costmap_of(grid_from_text("\n".join(["." * 20 + "#" + "?" * 19] * 20)))
    walled = with_unknown_ground(beside, np.array([[1.5, 0.5]]))
    assert walled.cost[10, 21] == np.inf
    assert UNKNOWN_COST < walled.cost[10, 25] < np.inf


def test_a_known_way_up_to_twice_as_long_is_preferred() -> None:
    """A U of known floor: across the unknown it is 3 m, around it 3 m and twice the depth."""

    def goes_round(depth: int) -> bool:
        arm = "." * 10 + "?" * 60 + "." * 10
        bottom = "." * 80
        grid = grid_from_text("\n".join([bottom] * 10 + [arm] * depth))
        ground = with_unknown_ground(costmap_of(grid), np.array([[3.75, 0.25]]))
        path = CostField.around(ground, (0.25, 0.25)).path_to((3.75, 0.25))
        return float(np.hypot(*np.diff(path, axis=0).T).sum()) > 3.6  # straight on it is 3.5 m

    assert goes_round(20)  # 1.5 m more, against 3 m of unknown that cost 6
    assert not goes_round(80)


def test_a_place_very_far_away_does_not_make_the_map_huge() -> None:
    costmap = costmap_of(grid_from_text("\n".join(["." * 20] * 20)))
    wider = with_unknown_ground(costmap, np.array([[1e4, -1e4]]))
    most = 1.0 + FARTHEST_BEYOND + MARGIN
    assert max(wider.states.shape) * wider.resolution <= most + wider.resolution
