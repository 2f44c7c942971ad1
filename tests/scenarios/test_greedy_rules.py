"""Each rule to compare with explores a room to its end as well: they differ in time alone."""

import pytest

from evaluation.episode import EpisodeConfig, run_episode
from evaluation.result import result_of
from nav.greedy_rules import GREEDY_RULES
from nav.navigator import COMPLETE


@pytest.mark.parametrize("navigator", GREEDY_RULES)
def test_a_rule_to_compare_with_explores_the_whole_room_and_touches_nothing(
    navigator: str,
) -> None:
    config = EpisodeConfig(
        world="lim_room", mapper="ogm", navigator=navigator, odometry="truth", seed=2
    )
    result = result_of(run_episode(config), map_file_kb=None)
    assert result["stop_reason"] == COMPLETE
    assert result["contacts"] == 0
    assert result["coverage"] >= 0.97, "as the scenario lim_room asks of the default"
    assert result["home_distance_m"] <= 0.3
