"""The scenario verb as CI uses it: a table, junit.xml, and a status that tells."""

import json
from pathlib import Path
from unittest.mock import patch
from xml.etree import ElementTree

import pytest

from envs.plan_yaml import write_plan
from evaluation.kernels.warm_up import TINY_ROOM
from scripts.__main__ import run
from tests.evaluation.scenarios.scenario_files import write_scenario

QUICK = (
    ("world: lim_room", "world: tiny.yaml"),
    ("time_limit: 60", "resolution: 0.05\ntime_limit: 40"),
    ("corner: [0, 0, 1, 1]", "corner: [0.2, 0.2, 1, 1]"),
)


def scenario_run(folder: Path, *changes: tuple[str, str]) -> int:
    write_plan(TINY_ROOM, folder / "tiny.yaml")
    path = write_scenario(folder, *QUICK, *changes)
    return run(["scenario", "run", str(path), "--out", str(folder / "out"), "--seeds", "1"])


def test_a_scenario_that_passes_has_status_0(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert scenario_run(tmp_path, ("t95_s: {min: 1,", "t95_s: {min: 0,")) == 0
    told = capsys.readouterr()
    assert "1 of 1 passed" in told.out
    assert "mine " in told.out
    assert all(line.startswith("compiling") for line in told.err.splitlines()), "quiet in a pipe"
    result = json.loads((tmp_path / "out" / "mine" / "seed0" / "result.json").read_text())
    assert result["map_reloads"] is True
    assert result["coverage_in.corner"] >= 0.99
    (suite,) = ElementTree.parse(tmp_path / "out" / "junit.xml").getroot()
    assert (suite.get("tests"), suite.get("failures")) == ("1", "0")


def test_a_scenario_that_gets_worse_fails_with_the_measured_and_the_required_value(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert scenario_run(tmp_path, ("coverage: {min: 0.9}", "coverage: {min: 1.5}")) == 1
    told = capsys.readouterr().out
    result = json.loads((tmp_path / "out" / "mine" / "seed0" / "result.json").read_text())
    words = f"coverage {result['coverage']:.6g}, must be at least 1.5"
    assert words in told
    assert "0 of 1 passed" in told
    root = ElementTree.parse(tmp_path / "out" / "junit.xml").getroot()
    (failure,) = root.iter("failure")
    assert words in failure.get("message", "")


def test_the_list_names_every_built_in_scenario(capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["scenario", "list"]) == 0
    listed = [line.split()[0] for line in capsys.readouterr().out.splitlines()]
    assert {"empty_room", "lim_hallway", "dropouts", "apartment"} <= set(listed)


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (["run", "lim_rom"], "did you mean lim_room?"),
        (["run", "empty_room", "--seeds", "0"], "seeds: 0; must be 1 to 100000"),
        (["run", "empty_room", "--jobs", "0"], "--jobs: 0; must be 1 or more"),
        (["run", "empty_room", "--mapper", "none_such"], "mapper: 'none_such'; must be one of"),
        (["play"], "'play' is unknown; must be one of list, run"),
    ],
)
def test_bad_input_is_one_line_with_status_2_and_nothing_is_run(
    words: list[str], told: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "out"
    assert run(["scenario", *words, *(["--out", str(out)] if words[0] == "run" else [])]) == 2
    captured = capsys.readouterr()
    assert told in captured.err
    assert len(captured.err.splitlines()) == 1
    assert not out.exists()


def test_a_malformed_file_is_told_with_its_line(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = write_scenario(tmp_path, ("t95_s:", "t95:"))
    assert run(["scenario", "run", str(path)]) == 2
    assert f"{path}: line 11: criteria: t95: unknown key" in capsys.readouterr().err


def test_ctrl_c_leaves_junit_xml_of_what_has_ended(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    with patch("evaluation.scenarios.run.run_episodes", side_effect=KeyboardInterrupt):
        assert scenario_run(tmp_path) == 130
    assert "interrupted: 0 of 0 passed" in capsys.readouterr().out
    assert len(ElementTree.parse(tmp_path / "out" / "junit.xml").getroot()) == 0
