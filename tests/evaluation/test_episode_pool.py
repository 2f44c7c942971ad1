"""Episodes in processes of their own: in order, without harm to each other, folders written."""

import multiprocessing
from dataclasses import replace
from pathlib import Path
from threading import Thread
from time import sleep
from unittest.mock import patch

import pytest

from evaluation import episode_pool
from evaluation.episode import EpisodeConfig
from evaluation.episode_pool import Failure, Outcome, run_episodes
from evaluation.sweeps.run_record import read_run
from mapping.errors import TestbedError

TINY = """
name: tiny
start: [0.5, 0.5, 0.0]
walls: [{points: [[0, 0], [2, 0], [2, 1.5], [0, 1.5]], closed: true}]
"""


@pytest.fixture
def config(tmp_path: Path) -> EpisodeConfig:
    world = tmp_path / "tiny.yaml"
    world.write_text(TINY)
    return EpisodeConfig(world=str(world), mapper="ogm", time_limit=1.0)


def test_a_run_that_fails_harms_no_other_and_tells_why(
    config: EpisodeConfig, tmp_path: Path
) -> None:
    missing = EpisodeConfig(world="no_such_world", mapper="ogm", time_limit=1.0)
    told: dict[int, Outcome] = {}
    jobs = [(config, tmp_path / "a"), (missing, tmp_path / "b"), (config, tmp_path / "c")]
    outcomes = run_episodes(jobs, processes=2, on_done=told.__setitem__)
    assert [told[i] for i in range(3)] == outcomes
    first, failed, last = outcomes
    assert isinstance(first, dict)
    assert isinstance(last, dict)
    assert first["stop_reason"] == last["stop_reason"] == "time_limit"
    assert isinstance(failed, Failure)
    assert "no_such_world" in failed.reason
    assert "\n" not in failed.reason
    assert (tmp_path / "a" / "map.png").is_file()
    assert not (tmp_path / "b" / "result.json").exists()


def test_a_failed_run_is_read_back_with_its_reason_and_no_earlier_result(
    tmp_path: Path,
) -> None:
    folder = tmp_path / "run"
    folder.mkdir()
    (folder / "result.json").write_text("{}")
    run_episodes([(EpisodeConfig(world="no_such_world"), folder)])
    record = read_run(folder)
    assert record is not None
    assert record.failure is not None
    assert "no_such_world" in record.failure
    assert record.result == {}


def test_a_process_that_dies_is_a_failure(config: EpisodeConfig, tmp_path: Path) -> None:
    endless = replace(config, navigator="reactive", time_limit=1e6)
    killer = Thread(target=kill_the_first_child)
    killer.start()
    (outcome,) = run_episodes([(endless, tmp_path / "a")])
    killer.join()
    assert outcome == Failure(reason="the process died (SIGKILL)")
    assert (tmp_path / "a" / "failure.txt").read_text() == "the process died (SIGKILL)\n"


def kill_the_first_child() -> None:
    while not multiprocessing.active_children():
        sleep(0.05)
    multiprocessing.active_children()[0].kill()


def test_ctrl_c_ends_what_runs_and_keeps_what_ended(config: EpisodeConfig, tmp_path: Path) -> None:
    def interrupt(index: int, outcome: Outcome) -> None:
        raise KeyboardInterrupt

    jobs = [(config, tmp_path / name) for name in "abc"]
    with pytest.raises(KeyboardInterrupt):
        run_episodes(jobs, on_done=interrupt)
    assert (tmp_path / "a" / "result.json").is_file()
    assert not (tmp_path / "c").exists()


def test_a_run_that_is_ended_while_it_is_written_leaves_nothing(
    config: EpisodeConfig, tmp_path: Path
) -> None:
    folder = tmp_path / "a"
    ended = patch("evaluation.episode_folder.write_map", side_effect=SystemExit(1))
    with ended, pytest.raises(SystemExit):
        episode_pool._outcome_of(config, folder)
    assert not folder.exists()
    folder.mkdir()
    (folder / "notes.txt").write_text("mine")
    with ended, pytest.raises(SystemExit):
        episode_pool._outcome_of(config, folder)
    assert (folder / "notes.txt").exists()


def test_an_error_in_a_run_is_a_failure_that_keeps_the_map(
    config: EpisodeConfig, tmp_path: Path
) -> None:
    folder = tmp_path / "a"
    with patch("mapping.ogm.Ogm.finish", side_effect=ZeroDivisionError("a defect")):
        outcome = episode_pool._outcome_of(config, folder)
    assert isinstance(outcome, Failure)
    assert outcome.reason == "ZeroDivisionError: a defect"
    assert "Traceback" in outcome.details
    assert (folder / "map.png").is_file()


def test_no_processes_are_refused() -> None:
    with pytest.raises(TestbedError, match="jobs: 0"):
        run_episodes([], processes=0)
