"""The rules that others use, each against its definition on frontiers made by hand."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mapping.errors import TestbedError
from nav.decision import GAIN_RATE, RULES, TOUR, DecisionConfig, choose
from nav.explorer import FrontierExplorer
from nav.frontier import Frontier
from nav.greedy_rules import GREEDY_RULES, explore_lite, gain_per_cost, nearest
from nav.loyalty import MOST
from nav.navigators import make_navigator
from nav.planner import CostField
from nav.viewpoint import Viewpoint
from tests.nav.grids import costmap_of, grid_from_log_odds

EDGE = 0.05
FIELD = CostField.around(
    costmap_of(grid_from_log_odds(np.full((200, 200), -5.0), EDGE)), (5.0, 5.0)
)
"""Ten metres by ten of open floor."""
POSE = np.array([5.025, 5.025, 0.0])


def frontier_of(cells: list[tuple[int, int]]) -> Frontier:
    rows = np.array(cells, dtype=np.int64)
    middle = FIELD.costmap.cell_to_world(rows[len(rows) // 2])
    return Frontier(cells=rows, middle=middle, size=len(rows) * EDGE)


def line_of(column: int, count: int) -> Frontier:
    """A frontier of so many cells, upright and level with the robot in the middle."""
    return frontier_of([(100 - count // 2 + k, column) for k in range(count)])


def viewpoint(frontier: Frontier, gain: float, cost: float) -> Viewpoint:
    return Viewpoint(place=frontier.middle - (0.5, 0.0), frontier=frontier, gain=gain, cost=cost)


def random_viewpoints(seed: int, count: int) -> list[Viewpoint]:
    rng = np.random.default_rng(seed)
    viewpoints = []
    for _ in range(count):
        row, column, size = rng.integers((0, 0, 3), (150, 200, 40))
        frontier = frontier_of([(int(row) + k, int(column)) for k in range(int(size))])
        viewpoints.append(viewpoint(frontier, rng.uniform(0.1, 6.0), rng.uniform(0.2, 20.0)))
    return viewpoints


def published_cost(frontier: Frontier) -> float:
    """As ``FrontierSearch::frontierCost`` has it (explore_lite, hrnr/m-explore@18526a7).

    Its ``min_distance`` is in metres already and is multiplied by the resolution all the same; the
    weights are those of its explore.launch@46223c4.
    """
    potential_scale, gain_scale, resolution = 3.0, 1.0, EDGE
    min_distance = min(
        float(np.hypot((column + 0.5) * EDGE - POSE[0], (row + 0.5) * EDGE - POSE[1]))
        for row, column in frontier.cells
    )
    size = len(frontier.cells)
    return potential_scale * min_distance * resolution - gain_scale * size * resolution


@given(seed=st.integers(0, 10_000), count=st.integers(1, 12))
def test_each_rule_takes_the_best_by_its_definition(seed: int, count: int) -> None:
    viewpoints = random_viewpoints(seed, count)
    assert nearest(viewpoints, FIELD, POSE) is viewpoints[np.argmin([v.cost for v in viewpoints])]
    ratios = [v.gain / v.cost for v in viewpoints]
    assert gain_per_cost(viewpoints, FIELD, POSE) is viewpoints[np.argmax(ratios)]
    chosen = explore_lite(viewpoints, FIELD, POSE)
    assert chosen is not None
    least = min(published_cost(v.frontier) for v in viewpoints)
    assert published_cost(chosen.frontier) == pytest.approx(least, abs=1e-12)


def test_the_nearest_is_the_one_with_the_cheapest_way_not_the_one_next_door() -> None:
    next_door, down_the_hall = line_of(104, 10), line_of(140, 10)
    behind_a_wall = viewpoint(next_door, gain=9.0, cost=8.0)
    in_sight = viewpoint(down_the_hall, gain=0.1, cost=2.0)
    assert nearest([behind_a_wall, in_sight], FIELD, POSE) is in_sight


def test_explore_lite_goes_for_size_even_behind_a_wall() -> None:
    """A metre nearer is worth 3 cells: 20 of them 2 m away against more or fewer 1 m away."""
    far = viewpoint(line_of(140, 20), 0.1, 30.0)
    for cells, goes_far in ((16, True), (18, False)):
        near = viewpoint(line_of(120, cells), 5.0, 1.0)
        assert explore_lite([near, far], FIELD, POSE) is (far if goes_far else near)


def test_explore_lite_measures_to_the_nearest_cell_of_a_frontier() -> None:
    """Its middle is 4 m off, its end 2 m; the other one of the same size is 3 m off."""
    long_way_out = frontier_of([(100, 140 + k) for k in range(80)])
    across = line_of(160, 80)
    assert np.hypot(*(long_way_out.middle - POSE[:2])) > 3.9
    viewpoints = [viewpoint(across, 1.0, 1.0), viewpoint(long_way_out, 1.0, 9.0)]
    assert explore_lite(viewpoints, FIELD, POSE) is viewpoints[1]


def test_of_one_frontiers_viewpoints_explore_lite_takes_the_one_with_the_cheapest_way() -> None:
    frontier = line_of(140, 20)
    dear, cheap = viewpoint(frontier, 3.0, 4.0), viewpoint(frontier, 1.0, 2.5)
    assert explore_lite([dear, cheap], FIELD, POSE) is cheap


def test_gain_per_cost_weighs_one_against_the_other() -> None:
    crumb, room = viewpoint(line_of(104, 3), 0.2, 0.5), viewpoint(line_of(160, 30), 4.0, 6.0)
    assert gain_per_cost([crumb, room], FIELD, POSE) is room
    crumb = viewpoint(line_of(104, 3), 0.2, 0.2)
    assert gain_per_cost([crumb, room], FIELD, POSE) is crumb


def test_a_viewpoint_where_the_robot_stands_is_worth_no_infinite_ratio() -> None:
    here, there = viewpoint(line_of(100, 3), 0.03, 0.0), viewpoint(line_of(120, 30), 4.0, 1.0)
    assert gain_per_cost([here, there], FIELD, POSE) is there
    assert gain_per_cost([here], FIELD, POSE) is here


@pytest.mark.parametrize("rule", RULES)
def test_of_nothing_every_rule_chooses_none(rule: str) -> None:
    assert choose([], FIELD, POSE, None, DecisionConfig(rule=rule)) is None


@pytest.mark.parametrize("rule", GREEDY_RULES)
def test_a_decision_by_a_rule_is_that_rules_choice_until_it_went_to_and_fro_too_often(
    rule: str,
) -> None:
    viewpoints = random_viewpoints(5, 12)
    config = DecisionConfig(rule=rule, loyalty=1000.0)
    expected = GREEDY_RULES[rule](viewpoints, FIELD, POSE)
    for current in viewpoints:
        assert choose(viewpoints, FIELD, POSE, current, config, 0.5 * MOST) is expected
        kept = choose(viewpoints, FIELD, POSE, current, config, MOST)
        assert kept is not None
        assert kept.is_near(current)
    gone = viewpoint(line_of(195, 3), 1.0, 5.0)
    assert choose(viewpoints, FIELD, POSE, gone, config, MOST) is expected


def test_the_rules_differ() -> None:
    """Or a comparison would tell nothing."""
    near_crumb = viewpoint(line_of(106, 3), 0.1, 0.3)
    dense = viewpoint(line_of(120, 10), 3.9, 1.0)
    largest = viewpoint(line_of(140, 60), 3.0, 8.0)
    viewpoints = [near_crumb, dense, largest]
    chosen = {name: rule(viewpoints, FIELD, POSE) for name, rule in GREEDY_RULES.items()}
    assert chosen == {"nearest": near_crumb, "explore_lite": largest, "gain_cost": dense}


def test_an_unknown_rule_is_refused_with_the_known_ones() -> None:
    with pytest.raises(
        TestbedError,
        match="'best'; must be one of gain_rate, tour, nearest, explore_lite, gain_cost",
    ):
        DecisionConfig(rule="best")


def test_every_rule_is_a_navigator_by_its_name() -> None:
    for rule in (TOUR, *GREEDY_RULES):
        navigator = make_navigator(rule)
        assert isinstance(navigator, FrontierExplorer)
        assert navigator.config.decision.rule == rule
    default = make_navigator("frontier")
    assert isinstance(default, FrontierExplorer)
    assert default.config.decision.rule == GAIN_RATE
