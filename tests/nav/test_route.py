import numpy as np
import pytest

from mapping.errors import TestbedError
from nav.navigators import make_navigator
from nav.route import checked_route, parse_route


def test_pairs_of_numbers_become_points() -> None:
    assert parse_route("1.5,0  -3,-0.5\n2e0,1").tolist() == [[1.5, 0.0], [-3.0, -0.5], [2.0, 1.0]]


@pytest.mark.parametrize("text", ["1.5", "1,2,3", "a,b", "1, 2", "1,2 3"])
def test_what_is_no_pair_is_refused_and_told(text: str) -> None:
    with pytest.raises(TestbedError, match=r"waypoints: '.*'; must be x,y in metres"):
        parse_route(text)


@pytest.mark.parametrize("points", [[(np.nan, 0.0)], [(0.0, np.inf)], [(0.0, 2e4)]])
def test_points_that_nobody_can_reach_are_refused(points: list[tuple[float, float]]) -> None:
    with pytest.raises(TestbedError, match="waypoints: must be finite"):
        checked_route(points)


def test_a_route_without_points_is_refused() -> None:
    with pytest.raises(TestbedError, match="waypoints: none"):
        parse_route("  ")


def test_waypoints_belong_to_their_navigator() -> None:
    with pytest.raises(TestbedError, match="waypoints: none; navigator 'waypoints' needs one"):
        make_navigator("waypoints")
    with pytest.raises(TestbedError, match="must not be with navigator 'frontier'"):
        make_navigator("frontier", [(1.0, 2.0)])
