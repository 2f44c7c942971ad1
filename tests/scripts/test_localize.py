"""The localize verb as its users meet it: found, not found, and bad input."""

import json
from pathlib import Path

import pytest

from evaluation.localization.warm_up import tiny_map
from mapping.io.map_server import write_map
from scripts.__main__ import run
from tests.scripts.test_bad_input import refused

PLAN = """\
name: tiny_room
start: [0.5, 0.5, 0]
walls:
  - points: [[0, 0], [4, 0], [4, 3], [0, 3]]
    closed: true
cylinders:
  - {center: [2, 1.2], radius: 0.3}
"""


@pytest.fixture
def words(tmp_path: Path) -> list[str]:
    """A map and the world it is of."""
    (tmp_path / "tiny_room.yaml").write_text(PLAN)
    write_map(tmp_path / "map.yaml", tiny_map())
    world = str(tmp_path / "tiny_room.yaml")
    return ["localize", "--map", str(tmp_path / "map.yaml"), "--world", world]


@pytest.mark.parametrize("start", [["histogram"], ["ekf", "--start", "known"]])
def test_it_says_when_the_robot_was_located(
    start: list[str], words: list[str], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "run"
    words += ["--filter", *start, "--time-limit", "7", "--seed", "1", "--out", str(out)]
    assert run(words) == 0
    captured = capsys.readouterr()
    assert f"tiny_room, {start[0]}: located after" in captured.out
    assert all(line.startswith("compiling") for line in captured.err.splitlines())
    assert json.loads((out / "result.json").read_text())["localized_at_s"] < 2.0


def test_a_run_too_short_to_be_sure_fails(words: list[str], tmp_path: Path) -> None:
    words += ["--filter", "histogram", "--time-limit", "3", "--out", str(tmp_path / "run")]
    assert run(words) == 1


def test_bad_input_is_told_in_one_line(
    words: list[str], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "run"
    words += ["--out", str(out)]
    assert "known" in refused([*words, "--filter", "ekf"], capsys)
    assert "kalman" in refused([*words, "--filter", "kalman"], capsys)
    assert "kidnap" in refused([*words, "--kidnap", "90", "--time-limit", "60"], capsys)
    missing = ["localize", "--map", str(tmp_path / "no.yaml"), "--world", "lim_room"]
    assert "no.yaml" in refused([*missing, "--out", str(out)], capsys)
    words[words.index("--world") + 1] = "lim_rom"
    assert "lim_room" in refused(words, capsys)
    assert not out.exists()
