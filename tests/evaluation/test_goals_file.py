import csv
from dataclasses import replace
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest

from evaluation.episode import EpisodeConfig, run_episode
from evaluation.episode_folder import write_run
from evaluation.goals_file import write_goals
from evaluation.kernels.warm_up import TINY_ROOM
from nav.navigator import ChosenGoal

CONFIG = EpisodeConfig(world="tiny_room", mapper="ogm", seed=3, time_limit=60.0)


def rows_of(file: Path) -> list[dict[str, str]]:
    with file.open(newline="") as lines:
        return list(csv.DictReader(lines))


def test_an_exploration_keeps_what_it_set_out_for_and_for_which_frontier(tmp_path: Path) -> None:
    episode = run_episode(CONFIG, plan=TINY_ROOM)
    assert episode.stop_reason == "complete"
    write_run(episode, tmp_path)
    rows = rows_of(tmp_path / "goals.csv")
    assert len(rows) == len(episode.goals) >= 1
    for row, goal in zip(rows, episode.goals, strict=True):
        told = [float(row[key]) for key in ("time_s", "x", "y", "frontier_x", "frontier_y")]
        kept = [goal.time, goal.x, goal.y, goal.frontier_x, goal.frontier_y]
        assert told == pytest.approx(kept, abs=0.0006)
        assert 0.0 < goal.x < 4.0
        assert 0.0 < goal.y < 3.0
    for before, after in pairwise(episode.goals):
        assert before.time < after.time
        gap = np.hypot(after.frontier_x - before.frontier_x, after.frontier_y - before.frontier_y)
        assert gap > 0.0, "a frontier chosen again and again is one goal"


def test_a_tour_keeps_its_waypoints_in_order(tmp_path: Path) -> None:
    config = replace(CONFIG, navigator="waypoints", waypoints="1.2,0.6 1.2,2.2")
    write_run(run_episode(config, plan=TINY_ROOM), tmp_path)
    rows = rows_of(tmp_path / "goals.csv")
    assert [(row["x"], row["y"]) for row in rows] == [("1.200", "0.600"), ("1.200", "2.200")]
    assert float(rows[0]["time_s"]) < float(rows[1]["time_s"])
    assert {row["frontier_x"] + row["frontier_y"] for row in rows} == {""}


def test_of_no_goals_the_header_stands_alone(tmp_path: Path) -> None:
    episode = run_episode(replace(CONFIG, navigator="reactive", time_limit=2.0), plan=TINY_ROOM)
    assert episode.goals == ()
    write_goals(tmp_path / "goals.csv", episode.goals)
    assert (tmp_path / "goals.csv").read_text() == "time_s,x,y,frontier_x,frontier_y\n"


def test_a_goal_may_have_a_frontier_or_none() -> None:
    place = np.array([1.0, 2.0])
    assert ChosenGoal.at(3.0, place) == ChosenGoal(time=3.0, x=1.0, y=2.0)
    with_frontier = ChosenGoal.at(3.0, place, np.array([4.0, 5.0]))
    assert (with_frontier.frontier_x, with_frontier.frontier_y) == (4.0, 5.0)
