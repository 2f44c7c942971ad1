"""How often the map was updated, and gap filling in an episode and a replay of it."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from evaluation.episode import EpisodeConfig, run_episode
from evaluation.kernels.warm_up import TINY_ROOM, sparse_log
from evaluation.recording import Recording
from evaluation.replay import ReplayConfig, run_replay
from evaluation.result import result_of, update_rates
from mapping.errors import TestbedError
from mapping.gap_filling import fill_gaps
from mapping.grid import OCCUPIED

SHORT = EpisodeConfig(world="tiny_room", mapper="occgridmapp", seed=2, time_limit=12.0)


def test_rates_are_those_of_the_longest_and_the_middle_gap() -> None:
    stamps = np.array([0.0, 0.2, 0.4, 1.4, 1.6])
    rates = update_rates(stamps)
    assert rates["map_update_rate_min_hz"] == pytest.approx(1.0)
    assert rates["map_update_rate_median_hz"] == pytest.approx(5.0)


@pytest.mark.parametrize("stamps", [[], [3.0], [1.0, 1.0], [2.0, 1.0]])
def test_without_two_updates_in_order_there_is_no_rate(stamps: list[float]) -> None:
    assert set(update_rates(np.array(stamps)).values()) == {None}


def test_scans_dropped_in_turns_show_in_the_least_rate_only() -> None:
    result = result_of(run_episode(SHORT, plan=TINY_ROOM), None)
    assert result["scans_dropped"] > 0
    assert result["map_update_rate_median_hz"] == pytest.approx(5.0)
    assert result["map_update_rate_min_hz"] < 4.0
    keeping_up = run_episode(replace(SHORT, mapper="ogm"), plan=TINY_ROOM)
    assert len(keeping_up.map_update_stamps) == keeping_up.map_updates
    assert result_of(keeping_up, None)["map_update_rate_min_hz"] == pytest.approx(5.0)


@pytest.mark.parametrize("rule", ["thesis", "better"])
def test_gaps_are_filled_in_the_map_that_is_kept_and_not_in_the_one_driven_by(rule: str) -> None:
    plain = run_episode(SHORT, plan=TINY_ROOM)
    filled = run_episode(replace(SHORT, gap_filling=rule), plan=TINY_ROOM)  # type: ignore[arg-type]
    assert np.array_equal(plain.track.pose_world, filled.track.pose_world), "driven alike"
    expected = fill_gaps(plain.grid.states(), plain.grid.resolution, rule)  # type: ignore[arg-type]
    assert expected.any()
    assert np.array_equal(
        filled.grid.states() == OCCUPIED, (plain.grid.states() == OCCUPIED) | expected
    )


def test_a_replay_fills_gaps_too() -> None:
    recording = Recording(log=sparse_log())
    config = ReplayConfig(log=Path("sparse.log"), mapper="ogm")
    plain, filled = (
        run_replay(each, recording) for each in (config, replace(config, gap_filling="thesis"))
    )
    more = (filled.grid.states() == OCCUPIED) & (plain.grid.states() != OCCUPIED)
    assert np.array_equal(more, fill_gaps(plain.grid.states(), plain.grid.resolution, "thesis"))
    assert len(plain.map_update_stamps) == plain.map_updates


@pytest.mark.parametrize(
    "kind", [EpisodeConfig, lambda **told: ReplayConfig(log=Path("a"), **told)]
)
def test_a_rule_that_there_is_not_is_refused(kind: type[EpisodeConfig]) -> None:
    with pytest.raises(TestbedError, match="gap_filling: 'more'; must be one of none, thesis"):
        kind(gap_filling="more")  # type: ignore[arg-type]
